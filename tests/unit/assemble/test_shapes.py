"""Visuals and collisions: colours, sharing, hulls, fitted primitives, and precedence."""

from math import pi, tan
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import force_setattr

from stepbot.assemble.collisions import _prism
from stepbot.geometry.mesh import TriMesh, signed_volume
from stepbot.geometry.solids.manifolds import convex_hull
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import Box, Capsule, Collision, Cylinder, MeshRef, Rgba, Robot, Sphere
from stepbot.robot.surfaces import Surface
from stepbot.sidecar.contact import MATERIALS, ContactMaterial
from stepbot.step.assembly import BodyKind
from tests.conftest import ReadDiagnostics
from tests.unit.assemble.workshop import BOX_FACES, CORNERS, Workshop, at, build, built

RED: Rgba = (1.0, 0.0, 0.0, 1.0)
GREEN: Rgba = (0.0, 1.0, 0.0, 1.0)
BLUE: Rgba = (0.0, 0.0, 1.0, 1.0)
GREY: Rgba = (0.8, 0.8, 0.8, 1.0)
ONE = "    defaults: {density: 1000}\n    links: {base: {rest: true}}\n"


def _mesh(robot: Robot, shape: Collision) -> TriMesh:
    assert isinstance(shape.geometry, MeshRef)
    return robot.mesh_by_name[shape.geometry.name].mesh


def _collision(robot: Robot) -> Collision:
    (collision,) = robot.root.collisions
    return collision


def test_occurrences_share_one_mesh(tmp_path: Path) -> None:
    """Mesh and hull of a part exist once, for any number of occurrences and links."""
    shop = Workshop()
    first = shop.box("bolt")
    shop.again(first, at(50, 0, 0, (0, 0, 1)))
    robot = built(shop, tmp_path, ONE)
    assert [asset.name for asset in robot.meshes] == ["bolt", "bolt_hull"]
    assert [v.name for v in robot.root.visuals] == ["base_visual_1", "base_visual_2"]
    assert [v.geometry for v in robot.root.visuals] == [MeshRef("bolt")] * 2
    np.testing.assert_allclose(robot.root.visuals[1].X_LG.p, (0.05, 0, 0), atol=1e-12)
    np.testing.assert_allclose(robot.root.visuals[1].X_LG.rpy, (0, 0, 1), atol=1e-12)
    assert [file.path for file in MeshFiles(robot).all] == ["meshes/bolt.obj", "meshes/bolt_hull.obj"]


def test_one_piece_per_colour(tmp_path: Path) -> None:
    """Faces of several colours become one mesh each, which together are the body; equal occurrences share them."""
    shop = Workshop()
    first = shop.box("case", face_colors=(RED, None, BLUE))
    shop.again(first, at(50, 0, 0), color=GREEN)
    robot = built(shop, tmp_path, ONE)
    names = ["case_color1", "case_color2", "case_color3"]
    assert [v.geometry for v in robot.root.visuals] == [MeshRef(name) for name in 2 * names]
    assert [v.rgba for v in robot.root.visuals] == [RED, GREY, BLUE, RED, GREEN, BLUE]
    assert sum(len(robot.mesh_by_name[name].mesh.faces) for name in names) == 12
    assert len(robot.meshes) == 4


def test_faces_that_end_up_equal_are_one_piece(tmp_path: Path) -> None:
    """Groups of faces that have the same colour in an occurrence are one mesh."""
    shop = Workshop()
    shop.box("case", face_colors=(GREEN, None), color=GREEN)
    assert [v.geometry for v in built(shop, tmp_path, ONE).root.visuals] == [MeshRef("case")]


@pytest.mark.parametrize(
    ("extra", "expected"),
    [
        ("", [RED, GREEN]),
        ('    parts: {case: {color: "#0000ff"}}\n', [BLUE]),
        ("    parts: {case: {material: blue}}\n", [BLUE]),
        ('    parts: {case: {material: blue, color: "#00ff00"}}\n', [GREEN]),
        ("    parts: {case: {material: plain}}\n", [RED, GREEN]),
    ],
)
def test_colour_precedence(extra: str, expected: list[Rgba], tmp_path: Path) -> None:
    """Colour precedence: rule, material, the STEP's faces, occurrence."""
    shop = Workshop()
    shop.box("case", face_colors=(RED, None), color=GREEN)
    materials = '    materials: {blue: {color: "#0000ff"}, plain: {density: 1}}\n'
    assert [v.rgba for v in built(shop, tmp_path, materials + extra + ONE).root.visuals] == expected


@pytest.mark.parametrize(
    ("defaults", "expected"),
    [
        ("{density: 1}", GREY),
        ("{density: 1, material: blue}", BLUE),
        ('{density: 1, material: blue, color: "#ff0000"}', RED),
    ],
)
def test_default_colour(defaults: str, expected: Rgba, tmp_path: Path) -> None:
    """Without a colour a part has that of the defaults, of the default material, or grey."""
    shop = Workshop()
    shop.box("case")
    text = f"""
    materials: {{blue: {{color: "#0000ff"}}}}
    defaults: {defaults}
    links: {{base: {{rest: true}}}}
"""
    assert built(shop, tmp_path, text).root.visuals[0].rgba == expected


def test_visual_false(tmp_path: Path) -> None:
    """``visual`` of a component takes precedence over its link's; without a visual it has collision and mass."""
    shop = Workshop()
    shop.box("a")
    shop.box("b")
    robot = built(shop, tmp_path, "    parts: {a: {visual: false}}\n" + ONE)
    assert [v.geometry for v in robot.root.visuals] == [MeshRef("b")]
    assert len(robot.root.collisions) == len(robot.root.masses) == 2
    text = "    parts: {a: {visual: true}}\n" + ONE.replace("rest: true", "rest: true, visual: false")
    assert [v.geometry for v in built(shop, tmp_path, text).root.visuals] == [MeshRef("a")]


def test_names_of_meshes(tmp_path: Path) -> None:
    """Products with equal names, in any case, and parts of several bodies have unique mesh names."""
    shop = Workshop()
    shop.box("Größe 1")
    shop.box("grosse_1")
    pair = shop.group("pair v3")
    shop.box("SOLID", parent=pair)
    shop.box("SOLID", parent=pair)
    robot = built(shop, tmp_path, ONE)
    assert [v.geometry for v in robot.root.visuals] == [
        MeshRef("Grosse_1"),
        MeshRef("grosse_1_2"),
        MeshRef("pair"),
        MeshRef("pair_2"),
    ]
    assert [asset.name for asset in robot.meshes] == sorted(asset.name for asset in robot.meshes)


def test_hull_is_the_default(tmp_path: Path) -> None:
    """The hull of an L is convex, encloses it, has the closed form's volume, and exists once per definition."""
    shop = Workshop()
    first = shop.box("ell")
    shop.again(first, at(90, 0, 0))
    long, short = CORNERS * (0.03, 0.01, 0.01) + (0.01, 0, 0), CORNERS * (0.01, 0.03, 0.01) + (0, 0.01, 0)
    mesh = TriMesh.of(np.vstack([long, short]), np.vstack([BOX_FACES, BOX_FACES + 8]))
    force_setattr(shop.bodies[0], "mesh", mesh)
    robot = built(shop, tmp_path, ONE)
    assert [c.geometry for c in robot.root.collisions] == [MeshRef("ell_hull")] * 2
    hull = _mesh(robot, robot.root.collisions[0])
    a, b, c = (hull.vertices[hull.faces[:, i]] for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx((0.03 * 0.03 - 0.5 * 0.02 * 0.02) * 0.01, rel=1e-6)  # positive: faces point outwards
    normals = np.cross(b - a, c - a)
    heights = np.einsum("fi,vfi->vf", normals, hull.vertices[:, None] - a[None])
    assert (heights <= 1e-12).all()


@pytest.mark.parametrize(
    ("word", "kind"),
    [("box", Box), ("cylinder", Cylinder), ("sphere", Sphere), ("capsule", Capsule), ("mesh", MeshRef)],
)
def test_shapes_by_word(word: str, kind: type, tmp_path: Path) -> None:
    """``collision`` of a link sets the shape of each component, in the component's own axes."""
    shop = Workshop()
    shop.box("a", (10, 20, 30), at(5, 6, 7, (0.3, 0.2, 0.1)))
    robot = built(shop, tmp_path, ONE.replace("rest: true", f"rest: true, collision: {word}"))
    collision = _collision(robot)
    assert isinstance(collision.geometry, kind)
    np.testing.assert_allclose(collision.X_LG.p, (0.005, 0.006, 0.007), atol=1e-9)
    if isinstance(collision.geometry, Box):
        np.testing.assert_allclose(collision.geometry.size, (0.01, 0.02, 0.03), atol=1e-9)
        np.testing.assert_allclose(collision.X_LG.rpy, (0.3, 0.2, 0.1), atol=1e-9)
    if isinstance(collision.geometry, MeshRef):
        assert collision.geometry == robot.root.visuals[0].geometry


def test_a_rod_fits_its_cylinder(tmp_path: Path) -> None:
    """The cylinder of a slanting rod is along its axis line."""
    shop = Workshop()
    shop.rod("rod", 4, 50, at(0, 0, 0, (0.4, 0.5, 0)))
    collision = _collision(built(shop, tmp_path, ONE.replace("rest: true", "rest: true, collision: cylinder")))
    assert isinstance(collision.geometry, Cylinder)
    assert (collision.geometry.radius, collision.geometry.length) == pytest.approx((0.004, 0.05), rel=1e-6)
    np.testing.assert_allclose(np.abs(collision.X_LG.R[:, 2]), np.abs(at(0, 0, 0, (0.4, 0.5, 0)).R[:, 2]), atol=1e-9)


def test_a_component_beats_its_link(tmp_path: Path) -> None:
    """``collision`` in ``parts`` takes precedence over the link's, for merged shapes and lists as well."""
    shop = Workshop()
    shop.box("a")
    shop.box("b", X_PC=at(20, 0, 0))
    shop.box("c", X_PC=at(40, 0, 0))
    rules = "    parts: {a: {collision: none}, b: {collision: sphere}}\n"
    robot = built(shop, tmp_path, rules + ONE.replace("rest: true", "rest: true, collision: box"))
    assert [type(c.geometry) for c in robot.root.collisions] == [Sphere, Box]
    robot = built(shop, tmp_path, rules + ONE.replace("rest: true", "rest: true, collision: {merge: box}"))
    sphere, box = robot.root.collisions
    assert isinstance(box.geometry, Box)
    np.testing.assert_allclose(box.geometry.size, (0.01, 0.01, 0.01), atol=1e-9)
    assert [c.name for c in (sphere, box)] == ["base_collision_1", "base_collision_2"]


def test_merged_shapes(tmp_path: Path) -> None:
    """``{merge: ...}`` is one shape around all components of the link, in the link's frame."""
    shop = Workshop()
    shop.box("a")
    shop.box("b", X_PC=at(20, 0, 0))
    text = ONE.replace("rest: true", "rest: true, collision: {merge: WORD}")
    hull = built(shop, tmp_path, text.replace("WORD", "hull"))
    low, high = _mesh(hull, _collision(hull)).bounds
    np.testing.assert_allclose((low, high), [(-0.005, -0.005, -0.005), (0.025, 0.005, 0.005)], atol=1e-9)
    assert len(_mesh(hull, _collision(hull)).faces) == 12
    mesh = built(shop, tmp_path, text.replace("WORD", "mesh"))
    assert len(_mesh(mesh, _collision(mesh)).faces) == 24
    box = _collision(built(shop, tmp_path, text.replace("WORD", "box")))
    assert isinstance(box.geometry, Box)
    np.testing.assert_allclose(box.X_LG.p, (0.01, 0, 0), atol=1e-9)
    assert built(shop, tmp_path, text.replace("WORD", "none")).root.collisions == ()


def test_given_primitives(tmp_path: Path) -> None:
    """A list of shapes replaces the components' own, in the link's frame."""
    shop = Workshop()
    shop.box("a")
    text = """
    defaults: {density: 1}
    links:
      base:
        rest: true
        collision:
          - {type: box, size: [10 mm, 20 mm, 30 mm], origin: {xyz: [1 mm, 0, 0], rpy: [0, 0, 90 deg]}}
          - {type: cylinder, radius: 1 mm, length: 2 mm}
          - {type: sphere, radius: 3 mm}
          - {type: capsule, radius: 4 mm, length: 5 mm}
"""
    collisions = built(shop, tmp_path, text).root.collisions
    assert [c.geometry for c in collisions] == [
        Box((0.01, 0.02, 0.03)),
        Cylinder(0.001, 0.002),
        Sphere(0.003),
        Capsule(0.004, 0.005),
    ]
    np.testing.assert_allclose(collisions[0].X_LG.rpy, (0, 0, np.pi / 2), atol=1e-12)


def test_flat_bodies_have_no_hull(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A flat label has a visual, no collision, and one warning."""
    shop = Workshop()
    shop.box("plate")
    shop.box("label", (30, 20, 0), kind=BodyKind.SURFACE)
    robot = build(shop, tmp_path, ONE, diagnostics)
    assert robot is not None
    assert len(robot.root.visuals) == 2
    assert len(robot.root.collisions) == 1
    assert diagnostics.codes() == ["SB506", "SB308"]
    built_quietly = build(shop, tmp_path, "    parts: {label: {collision: none}}\n" + ONE, diagnostics)
    assert built_quietly is not None
    assert diagnostics.codes() == ["SB506", "SB308", "SB506"]


def test_hull_of_too_few_points() -> None:
    """Three points, or coplanar points, have no hull."""
    assert convex_hull(np.eye(3)) is None
    assert convex_hull(CORNERS * (1, 1, 0)) is None
    assert convex_hull(CORNERS) is not None


def test_same_input_same_robot(tmp_path: Path) -> None:
    """Building twice gives equal names, order and bytes."""
    shop = Workshop()
    shop.rod("a", density=1)
    shop.box("b", face_colors=(RED, BLUE), density=2)
    one, two = built(shop, tmp_path, ONE), built(shop, tmp_path, ONE)
    assert one.links == two.links
    assert [(m.name, m.mesh.vertices.tobytes(), m.mesh.faces.tobytes()) for m in one.meshes] == [
        (m.name, m.mesh.vertices.tobytes(), m.mesh.faces.tobytes()) for m in two.meshes
    ]


def test_contact_of_shape_part_link_and_defaults(tmp_path: Path) -> None:
    """A shape's contact overrides a part's, which overrides the link's, which overrides that of the defaults."""
    shop = Workshop()
    shop.box("body")
    shop.box("tyre", X_PC=at(0, 0, 50))
    text = """
    defaults: {density: 1000, contact: {friction: 0.1, restitution: 0.2}}
    parts: {tyre: {contact: rubber-on-floor}}
    links: {base: {rest: true, LINK}}
    """
    plain = built(shop, tmp_path, text.replace(", LINK", ""))
    assert [one.surface for one in plain.root.collisions] == [Surface(0.1, restitution=0.2), Surface(0.7)]
    own = "contact: {material: rubber-on-floor, friction: 0.3}, collision: auto"
    whole = built(shop, tmp_path, text.replace("LINK", own))
    assert [one.surface.friction for one in whole.root.collisions] == [0.7, 0.3]  # the tyre has shapes of its own
    found, shapes = ReadDiagnostics(), "{type: sphere, radius: 1, contact: {rolling: 1 mm}}, {type: sphere, radius: 2}"
    listed = build(shop, tmp_path, text.replace("LINK", f"collision: [{shapes}]"), found)
    assert listed is not None
    assert [one.surface for one in listed.root.collisions] == [Surface(rolling=0.001), Surface(0.1, restitution=0.2)]
    (unused,) = (one for one in found if one.code == "SB608")
    assert unused.message == "link 'base': `contact` of its parts has no effect, because the link lists its shapes"


def test_materials_have_sources_and_are_documented() -> None:
    """Each pair of materials has a source and a coefficient, which the page on sidecars has."""
    page = (Path(__file__).parents[3] / "docs" / "sidecar.md").read_text(encoding="utf-8")
    for material in ContactMaterial:
        sliding, source = MATERIALS[material]
        assert source
        assert f"`{material.value}` ({sliding:g})" in page


@pytest.mark.parametrize("faces", [5, 8, 34])
def test_the_prism_around_a_cylinder(faces: int) -> None:
    """Its n sides touch the cylinder: n r^2 tan(pi / n) across, and as long; n + 2 faces with the ends."""
    prism, sides = _prism(Cylinder(0.02, 0.07), faces), faces - 2
    assert signed_volume(prism.vertices, prism.faces) == pytest.approx(
        sides * 0.02**2 * tan(pi / sides) * 0.07, rel=1e-12
    )
    assert prism.vertices[:, 2].min() == pytest.approx(-0.035, abs=1e-15)
    assert prism.vertices[:, 2].max() == pytest.approx(0.035, abs=1e-15)
