"""Self-collision in the drawn pose, of solids whose overlap has a closed form."""

import numpy as np
import pytest
import trimesh
from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh, joined
from stepbot.geometry.predicates import encloses
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Box,
    Capsule,
    Collision,
    Cylinder,
    Geometry,
    Joint,
    JointKind,
    Link,
    LoopClosure,
    MeshAsset,
    MeshRef,
    Robot,
    Sphere,
)
from stepbot.verification.self_collision import shapes
from stepbot.verification.self_collision.search import overlaps
from stepbot.verification.self_collision.shapes import TOUCHING, only_collisions
from tests.robots import ROBOTS, primitives


def box(size: float = 1.0, at: tuple[float, float, float] = (0, 0, 0), *, inverted: bool = False) -> TriMesh:
    """A cube as a mesh."""
    mesh = trimesh.creation.box(extents=(size, size, size))
    return TriMesh.of(mesh.vertices + at, mesh.faces[:, ::-1] if inverted else mesh.faces)


HOLLOW = joined([box(1.0), box(0.8, inverted=True)])
"""A cube with a cubic void."""
ELL = joined([box(1.0), box(1.0, (2.0, 0, 0))])
"""Two cubes with a gap of 1 m: one mesh, not convex."""


def robot(a: Geometry | TriMesh, b: Geometry | TriMesh, distance: float, *, turned: float = 0.0) -> Robot:
    """Two links that are not adjacent, with a third between them; the second is at x = ``distance``."""
    meshes = tuple(MeshAsset(name, shape) for name, shape in (("a", a), ("b", b)) if isinstance(shape, TriMesh))

    def link(name: str, shape: Geometry | TriMesh) -> Link:
        geometry = MeshRef(name) if isinstance(shape, TriMesh) else shape
        return Link(name, collisions=(Collision(name, geometry),))

    X = Pose.from_xyz_rpy((distance, 0, 0), (0, 0, turned))
    joints = (Joint("one", JointKind.REVOLUTE, "a", "middle"), Joint("two", JointKind.REVOLUTE, "middle", "b", X))
    return Robot("pair", (link("a", a), Link("middle"), link("b", b)), joints, meshes=meshes)


SOLIDS = {
    "meshes": (box(), box()),
    "box and mesh": (Box((1, 1, 1)), box()),
    "boxes": (Box((1, 1, 1)), Box((1, 1, 1))),
    "spheres": (Sphere(0.5), Sphere(0.5)),
    "cylinders": (Cylinder(0.5, 1.0), Cylinder(0.5, 1.0)),
    "capsule and sphere": (Capsule(0.5, 1.0), Sphere(0.5)),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_that_overlap_do_so_by_as_much(name: str) -> None:
    """Solids of 0.5 m at a distance of 0.9 m overlap by 0.1 m along x."""
    ((a, b, depth),) = overlaps(robot(*SOLIDS[name], 0.9))
    assert (a, b) == ("a", "b")
    assert depth == pytest.approx(0.1, abs=1e-6)


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("distance", [1.0, 1.0 + 1e-9, 1.0 - 0.5 * TOUCHING, 1.1])
def test_touching_is_no_overlap(name: str, distance: float) -> None:
    """Solids that touch, are apart, or overlap by less than a micrometre do not collide."""
    assert overlaps(robot(*SOLIDS[name], distance)) == ()


@pytest.mark.parametrize("distance", [1.0, 1.0 - 0.5 * TOUCHING, 1.1])
def test_surfaces_that_touch_do_not_overlap(distance: float) -> None:
    """Non-convex meshes are compared as surfaces: touching ones do not collide."""
    assert overlaps(robot(HOLLOW, HOLLOW, distance)) == ()


def test_surfaces_that_cross_overlap_without_a_depth() -> None:
    """Intersecting surfaces collide, without a depth."""
    assert overlaps(robot(HOLLOW, HOLLOW, 0.95)) == (("a", "b", None),)
    assert overlaps(robot(HOLLOW, HOLLOW, 1.0 - 2.0 * TOUCHING)) == (("a", "b", None),)
    assert overlaps(robot(HOLLOW, HOLLOW, 0.95, turned=0.3)) == (("a", "b", None),)


def test_a_hole_is_room() -> None:
    """A small cube in a void does not collide; in a full cube, or in the wall, it does."""
    assert overlaps(robot(HOLLOW, box(0.5), 0.0)) == ()
    assert overlaps(robot(HOLLOW, Sphere(0.3), 0.0)) == ()
    assert overlaps(robot(box(), box(0.5), 0.0)) != ()
    assert overlaps(robot(HOLLOW, box(0.05), 0.45)) != ()


def test_what_a_surface_encloses_overlaps() -> None:
    """A solid inside a closed surface collides, although the surfaces do not intersect."""
    assert overlaps(robot(ELL, box(0.5), 2.0)) == (("a", "b", None),)
    assert overlaps(robot(ELL, HOLLOW, 1.0 + 2.0)) == ()
    assert overlaps(robot(ELL, box(0.5), 1.0)) == ()


def test_faces_are_asked_only_about_what_fits_into_the_box(monkeypatch: pytest.MonkeyPatch) -> None:
    """A shape that leaves the box of a surface is not inside it, whatever the faces: there can be 100,000 of them."""
    asked: list[object] = []
    monkeypatch.setattr(shapes, "encloses", lambda *given: asked.append(given) or encloses(*given))
    built = shapes.shapes_of(robot(ELL, box(0.5), 0.0))
    pair = shapes.Pair(built["a"][0], built["b"][0])
    assert not pair.overlap(np.eye(3), np.array([2.8, 0.0, 0.0]))
    assert not asked
    assert pair.overlap(np.eye(3), np.array([2.0, 0.0, 0.0]))
    assert len(asked) == 1


def test_one_contact_of_surfaces_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether two surfaces overlap takes a single contact; the deepest of many is searched only for its place."""
    built = shapes.shapes_of(robot(HOLLOW, HOLLOW, 0.95))
    pair = shapes.Pair(built["a"][0], built["b"][0])
    asked: list[int] = []
    monkeypatch.setattr(pair, "_contact", lambda request: asked.append(request.num_max_contacts))
    pair.overlap(np.eye(3), np.array([0.95, 0.0, 0.0]))
    pair.deepest(np.eye(3), np.array([0.95, 0.0, 0.0]))
    assert asked == [1, 1000]


def test_the_drawn_pose_counts_and_not_q_zero() -> None:
    """The drawn pose is checked, not q = 0."""
    pair = robot(Box((1, 1, 1)), Box((1, 1, 1)), 0.0)
    slide = replace(pair.joints[1], kind=JointKind.PRISMATIC, axis=(1.0, 0.0, 0.0), drawn_position=2.0)
    assert overlaps(replace(pair, joints=(pair.joints[0], slide))) == ()
    assert overlaps(pair) != ()


def test_neighbours_are_left_out() -> None:
    """Links connected by a joint or a closure are not checked."""
    pair = robot(Box((1, 1, 1)), Box((1, 1, 1)), 0.5)
    closure = LoopClosure("pin", JointKind.REVOLUTE, "a", IDENTITY, "b", IDENTITY)
    assert overlaps(replace(pair, closures=(closure,))) == ()
    direct = (pair.joints[0], replace(pair.joints[1], parent="a"))
    assert overlaps(replace(pair, joints=direct)) == ()


def test_the_deepest_of_several_shapes_is_reported() -> None:
    """Of several shapes of two links, the deepest overlap is reported."""
    pair = robot(Box((1, 1, 1)), Box((1, 1, 1)), 0.9)
    more = (*pair.links[2].collisions, Collision("more", Box((1, 1, 1)), Pose.of(position=(-0.2, 0, 0))))
    links = (*pair.links[:2], replace(pair.links[2], collisions=more))
    ((_, _, depth),) = overlaps(replace(pair, links=links))
    assert depth == pytest.approx(0.3, abs=1e-9)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_named_robots_do_not_collide(name: str) -> None:
    """The named robots do not collide."""
    assert overlaps(ROBOTS[name]()) == ()


def test_only_what_overlaps_depend_on_is_sent_along() -> None:
    """Collision geometry and the motion of joints are sent to the worker: masses and visuals do not change the key."""
    robot = primitives()
    slim = only_collisions(robot)
    assert [link.collisions for link in slim.links] == [link.collisions for link in robot.links]
    assert all(not link.visuals and link.mass_properties.mass == 0.0 for link in slim.links)
    assert [mesh.name for mesh in slim.meshes] == ["base_1"]
    assert [(joint.name, joint.limit) for joint in slim.joints] == [(joint.name, joint.limit) for joint in robot.joints]


def test_gains_change_nothing_that_overlaps_depend_on() -> None:
    """An edit of gains takes the overlaps from the cache: the worker gets the same actuators."""
    of_gain = [
        only_collisions(replace(primitives(), actuators=(Actuator("a", "slide", ActuatorKind.POSITION, kp=kp),)))
        for kp in (1.0, 2.0)
    ]
    assert of_gain[0].actuators == of_gain[1].actuators
    assert [one.joint for one in of_gain[0].actuators] == ["slide"]  # it decides which joints of a loop are driven
