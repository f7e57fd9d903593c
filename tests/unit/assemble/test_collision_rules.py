"""Which collision rule applies to a link or a component, and the shapes of ``auto`` and ``decompose``."""

from math import cos, pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from stepbot.assemble import build_robot
from stepbot.assemble.fitted_collisions import ScoredCollisions
from stepbot.geometry.solids.slivers import face_normals
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Box, Cylinder, Geometry, Link, MeshRef, Robot, Sphere
from stepbot.step.assembly import BodyKind
from tests.conftest import ReadDiagnostics
from tests.unit.assemble.workshop import Workshop, at, build, built, sidecar

CYLINDER = "[{type: cylinder, radius: 5 mm, length: 10 mm}]"
FIXED = "    joints: {weld: {type: fixed, parent: base, child: cube, origin: {xyz: [0, 0, 0]}}}\n"
REST = "    links: {base: {rest: true}}\n"


def _auto(more: str = "") -> str:
    return f"    defaults: {{density: 1000, collision: auto}}\n{more or REST}"


def _geometries(robot: Robot) -> list[Geometry]:
    return [shape.geometry for shape in robot.root.collisions]


def _bracket(shop: Workshop) -> None:
    shop.box("foot", (50, 40, 5), at(25, 0, 2.5))
    shop.box("wall", (5, 40, 35), at(2.5, 0, 17.5))


def test_auto_is_exact_on_a_cylinder(tmp_path: Path) -> None:
    """A part with a coarse mesh becomes a cylinder with the radius and length of its B-rep, volume ratio 1."""
    shop = Workshop()
    shop.rod("shaft", radius=7.3, length=31.0, X_PC=at(10, 20, 30, (0.3, 0.2, 0.1)), sides=24)
    (cylinder,) = _geometries(built(shop, tmp_path, _auto()))
    assert isinstance(cylinder, Cylinder)
    assert cylinder.radius == 0.0073
    assert pi * cylinder.radius**2 * cylinder.length == pytest.approx(pi * 0.0073**2 * 0.031, rel=1e-9)


@pytest.mark.parametrize("rule", ["wheel", "{merge: wheel}"])
def test_a_wheel_touches_the_floor_in_one_point(rule: str, tmp_path: Path) -> None:
    """A sphere in its middle with the radius of its rim, where the sphere around it would be larger."""
    shop = Workshop()
    shop.rod("wheel", radius=20.0, length=30.0, sides=64)
    links = f"    links: {{base: {{rest: true, collision: {rule}}}}}\n    defaults: {{density: 1000}}\n"
    (sphere,) = _geometries(built(shop, tmp_path, links))
    assert isinstance(sphere, Sphere)
    assert sphere.radius == pytest.approx(0.02, rel=1e-6)


def test_a_link_is_one_solid(tmp_path: Path) -> None:
    """Two stacked boxes of a link become one box; with ``hull``, as without a rule, each has its own shape."""
    shop = Workshop()
    shop.box("lower", (20, 20, 10), at(0, 0, 5))
    shop.box("upper", (20, 20, 10), at(0, 0, 15))
    robot = built(shop, tmp_path, _auto())
    (box,) = _geometries(robot)
    assert isinstance(box, Box)
    assert sorted(box.size) == pytest.approx([0.02, 0.02, 0.02], abs=3e-9)
    assert robot.root.collisions[0].X_LG.p == pytest.approx((0, 0, 0.01), abs=3e-9)
    assert len(_geometries(built(shop, tmp_path, "    defaults: {density: 1000}\n" + REST))) == 2


@pytest.mark.parametrize("own_rule", [False, True])
def test_surfaces_inside_get_no_shape(tmp_path: Path, own_rule: bool) -> None:
    """Of two surface bodies, the one inside the block has no shape, unless it has a rule of its own."""
    shop = Workshop()
    shop.box("outside", (10, 10, 10), at(40, 0, 0), kind=BodyKind.SURFACE)
    shop.box("inside", (10, 10, 10), at(5, 0, 0), kind=BodyKind.SURFACE)
    shop.box("block", (20, 20, 20))
    parts = "    parts: {inside: {collision: hull}}\n" if own_rule else ""
    geometries = _geometries(built(shop, tmp_path, _auto(parts + REST)))
    box = next(one for one in geometries if isinstance(one, Box))
    assert box.size == pytest.approx((0.02, 0.02, 0.02), abs=3e-9)
    hulls = [MeshRef(f"{name}_hull") for name in (("inside", "outside") if own_rule else ("outside",))]
    assert sorted((one for one in geometries if one is not box), key=str) == hulls


def test_decompose_has_hulls_only(tmp_path: Path) -> None:
    """``decompose`` cuts a bracket in two hulls, which are named after the link."""
    shop = Workshop()
    _bracket(shop)
    robot = built(
        shop, tmp_path, "    defaults: {density: 1000}\n    links: {base: {rest: true, collision: decompose}}\n"
    )
    assert _geometries(robot) == [MeshRef("base_piece1"), MeshRef("base_piece2")]
    extents = [np.ptp(robot.mesh_by_name[name].mesh.vertices, axis=0) for name in ("base_piece1", "base_piece2")]
    together = sum(float(extent.prod()) for extent in extents)
    assert together == pytest.approx(0.05 * 0.04 * 0.005 + 0.005 * 0.04 * 0.03, rel=1e-6)


def test_rules_take_precedence(tmp_path: Path) -> None:
    """A part's rule overrides its link's, which overrides the defaults; ``auto`` of a part is for it alone."""
    shop = Workshop()
    _bracket(shop)
    shop.rod("pin", radius=2.0, length=10.0, X_PC=at(30, 0, 10))
    links = "    links: {base: {rest: true, collision: hull}}\n"
    robot = built(shop, tmp_path, _auto("    parts: {pin: {collision: auto}}\n" + links))
    kinds = [type(geometry) for geometry in _geometries(robot)]
    assert kinds == [MeshRef, MeshRef, Cylinder]


def test_occurrences_share_pieces(tmp_path: Path) -> None:
    """A body with a rule of its own is cut once for all its occurrences."""
    shop = Workshop()
    first = shop.box("plate", (20, 10, 2))
    shop.again(first, at(50, 0, 0, (0, 0, 1)))
    robot = built(
        shop, tmp_path, "    defaults: {density: 1000}\n    parts: {'**/plate*': {collision: decompose}}\n" + REST
    )
    assert _geometries(robot) == [MeshRef("plate_hull")] * 2
    assert robot.root.collisions[1].X_LG.p == pytest.approx((0.05, 0, 0))


def test_joints_do_not_change_shapes(tmp_path: Path) -> None:
    """Another frame of the link moves its shapes and changes none."""
    shop = Workshop()
    _bracket(shop)
    here = built(shop, tmp_path, _auto())
    there = built(shop, tmp_path, _auto(REST + "    root: {frame: {xyz: [0.1, 0, 0], rpy: [0, 0, 0.3]}}\n"))
    assert _geometries(here) == _geometries(there)
    X = Pose.from_xyz_rpy((0.1, 0, 0), (0, 0, 0.3))
    for a, b in zip(here.root.collisions, there.root.collisions, strict=True):
        assert (X @ b.X_LG).p == pytest.approx(a.X_LG.p, abs=1e-11)


def test_budgets(tmp_path: Path) -> None:
    """``max_hulls`` and ``max_vertices`` bound the shapes; a solid that fills too little of them is SB609."""
    shop = Workshop()
    shop.box("base", (120, 20, 5), at(50, 0, 0))
    for i in range(6):
        shop.box(f"tooth {i}", (5, 20, 30), at(20 * i, 0, 17.5))
    found = ReadDiagnostics()
    many = "    links: {base: {rest: true, collision: decompose}}\n"
    robot = build(shop, tmp_path, "    defaults: {density: 1000}\n" + many, found)
    assert robot is not None
    assert len(_geometries(robot)) == 7
    few = "    links: {base: {rest: true, collision: {shape: auto, max_hulls: 3}}}\n"
    robot = build(shop, tmp_path, "    defaults: {density: 1000}\n" + few, found)
    assert robot is not None
    assert len(_geometries(robot)) == 3
    assert [(d.code, d.message) for d in found] == [
        ("SB609", "robot.step: `max_hulls` limits the collision geometry of one link")
    ]


def test_bounded_hull_of_a_component(tmp_path: Path) -> None:
    """``{shape: hull, max_vertices: 8}`` gives each component a hull of at most eight vertices around it."""
    shop = Workshop()
    shop.rod("pin", radius=5.0, length=10.0, sides=64)
    rule = "    links: {base: {rest: true, collision: {shape: hull, max_vertices: 8}}}\n"
    robot = built(shop, tmp_path, "    defaults: {density: 1000}\n" + rule)
    mesh = robot.mesh_by_name["pin_hull"].mesh
    assert len(mesh.vertices) == 8
    assert [*mesh.bounds[0], *mesh.bounds[1]] == pytest.approx([-0.005] * 3 + [0.005] * 3, abs=3e-9)


@pytest.mark.parametrize("rule", ["", "auto", "hull", "cylinder", "mesh", "{merge: hull}", CYLINDER])
def test_for_mjx_there_are_no_cylinders_and_no_hulls_of_many_faces(rule: str, tmp_path: Path) -> None:
    """Whatever a link asks for, a rod gets a prism of 20 faces around it; a box stays a box."""
    shop = Workshop()
    shop.rod("pin", radius=5.0, length=10.0, sides=64)
    shop.box("cube", X_PC=at(50, 0, 0))
    links = f"    links: {{base: {{rest: true{f', collision: {rule}' * bool(rule)}}}, cube: {{parts: [cube]}}}}\n"
    robot = built(shop, tmp_path, f"    defaults: {{density: 1000, collision: {{for: mjx}}}}\n{links}{FIXED}")
    (shape,), (box,) = robot.links[0].collisions, robot.links[1].collisions
    assert isinstance(box.geometry, Box)
    assert isinstance(shape.geometry, MeshRef)
    mesh = robot.mesh_by_name[shape.geometry.name].mesh
    normals = face_normals(mesh.vertices, mesh.faces)[0]
    assert len({tuple(np.round(normal, 4) + 0.0) for normal in normals.tolist()}) <= 20
    across = np.linalg.norm(mesh.vertices[:, :2], axis=1)
    assert across.min() > 0.00499
    assert across.max() < 0.005 / cos(pi / 18) * 1.05
    assert robot.versions.mjcf == 3.3


def test_for_mjx_a_link_has_one_shape_unless_its_budget_allows_more(tmp_path: Path) -> None:
    """Two far cubes of one link: MJX compiles a function for each pair of hulls."""
    shop = Workshop()
    shop.box("cube", X_PC=at(50, 0, 0))
    shop.box("left")
    shop.box("right", X_PC=at(0, 100, 0))
    for budget, count in (("", 1), (", collision: {shape: auto, max_hulls: 4}", 2)):
        links = f"    links: {{base: {{rest: true{budget}}}, cube: {{parts: [cube]}}}}\n"
        robot = built(shop, tmp_path, f"    defaults: {{density: 1000, collision: {{for: mjx}}}}\n{links}{FIXED}")
        assert len(robot.links[0].collisions) == count


def test_error_of_a_bounded_hull_is_reported(tmp_path: Path) -> None:
    """The report has the largest distance of a bounded hull from the solid, here of a box's edge from its cylinder.

    A hull and a mesh are counted as what they are.
    """
    shop = Workshop()
    shop.rod("pin", radius=5.0, length=10.0, sides=64)
    shop.box("cube", X_PC=at(50, 0, 0))
    links = "    links: {base: {rest: true}, cube: {parts: [cube], collision: mesh}}\n"
    text = f"    defaults: {{density: 1000, collision: {{shape: hull, max_vertices: 8}}}}\n{links}{FIXED}"
    made = build_robot(shop.assembly, sidecar(tmp_path, text), lambda: shop.measures, ReadDiagnostics())
    assert made is not None
    score, cube = made.collisions.result()
    assert [dict(one.shapes) for one in (score, cube)] == [{"hull": 1}, {"mesh": 1}]
    assert score.overshoot == pytest.approx(0.005 * (sqrt(2.0) - 1.0), abs=1e-4)
    assert score.iou == pytest.approx(pi / 4.0, abs=5e-3)


@pytest.mark.parametrize(("rule", "is_new"), [("auto", False), ("{shape: hull, max_vertices: 8}", True)])
def test_a_set_is_scored_once(rule: str, is_new: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A fitted set keeps the score of its fitting; a bounded hull, which is not fitted, is scored for the report."""
    shop = Workshop()
    shop.rod("pin", radius=5.0, length=10.0, sides=64)
    text = f"    defaults: {{density: 1000}}\n    links: {{base: {{rest: true, collision: {rule}}}}}\n"
    made = build_robot(shop.assembly, sidecar(tmp_path, text), lambda: shop.measures, ReadDiagnostics())
    assert made is not None
    asked: list[Link] = []
    unscored = ScoredCollisions._unscored
    monkeypatch.setattr(ScoredCollisions, "_unscored", lambda self, link: asked.append(link) or unscored(self, link))
    (score,) = made.collisions.result()
    assert score.iou > 0.6
    assert bool(asked) == is_new


def test_useless_budget(tmp_path: Path) -> None:
    """A budget that does not apply to its shape is SB608, at its line."""
    shop = Workshop()
    shop.box("cube")
    found = ReadDiagnostics()
    rule = "    links: {base: {rest: true, collision: {shape: box, max_vertices: 8}}}\n"
    assert build(shop, tmp_path, "    defaults: {density: 1000}\n" + rule, found) is not None
    (diagnostic,) = found
    assert diagnostic.code == "SB608"
    assert "`max_vertices` has no effect on `box`" in diagnostic.message


@pytest.mark.parametrize("rule", ["{shape: auto, max_hulls: 0}", "{max_vertices: 7}", "{shapes: auto}", "cubes"])
def test_invalid_rules_are_rejected(tmp_path: Path, rule: str) -> None:
    """Unknown types and keys and impossible budgets are errors of the sidecar."""
    with pytest.raises(AssertionError, match="SB1"):
        sidecar(tmp_path, f"    links: {{base: {{rest: true, collision: {rule}}}}}\n")
