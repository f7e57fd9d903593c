"""Equal parts: of one definition, or of one shape, drawn turned, moved or mirrored."""

from itertools import product
from math import pi
from time import process_time

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.equal import EqualParts
from stepbot.draft.parts.scene import Scene, own_axes
from stepbot.geometry.spatial import Pose
from stepbot.geometry.volume import VolumeProperties
from tests.assembled import BARE, Node, assembled, inferred, joints, part, reexported
from tests.solids import Solid, box, cylinder
from tests.unit.draft.test_motors import ARM, PLATE, motors, servo, two_servos

MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])
ODD = (0.3, -0.8, 1.1)
UP = np.array([0.0, 0.0, 1.0])


def bracket() -> Solid:
    """A block with no plane of symmetry, and bores in it [mm]."""
    return box(40, 30, 10) - cylinder(3, 10).at(12, 5, -5) - cylinder(2, 10).at(-10, -8, -5) - box(9, 8, 4).at(8, 11, 3)


def flange() -> Solid:
    """A square block with a spigot and four holes, as a stepper has: two of its moments of inertia are equal [mm]."""
    block = box(42, 42, 40) + cylinder(11, 2).at(0, 0, 20)
    for x, y in ((15.5, 15.5), (15.5, -15.5), (-15.5, 15.5), (-15.5, -15.5)):
        block -= cylinder(1.5, 5).at(x, y, 15)
    return block


def equal(*nodes: Node) -> EqualParts:
    """The parts of some nodes by kinds; their numbers are those of the nodes, from 1."""
    return EqualParts(Scene(assembled(*nodes)), {})


@pytest.mark.parametrize(
    "solid", [bracket(), flange(), box(30, 20, 10), cylinder(5, 20)], ids=["bracket", "flange", "box", "rod"]
)
@pytest.mark.parametrize("rpy", [(0.0, 0.0, 0.0), (0.0, 0.4, 0.0), ODD])
def test_own_axes_are_a_frame_that_turns_with_the_body(solid: Solid, rpy: tuple[float, float, float]) -> None:
    """Along its faces, however it is drawn; a rod has one axis, and any two across it."""
    X = Pose.from_xyz_rpy((1.0, 2.0, 3.0), rpy)
    before, axes = (own_axes(assembled(part("a", one)).bodies[0]) for one in (solid, solid.moved(X.matrix)))
    assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert np.abs((X.R @ before).T @ axes).max() == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize(
    "solid", [bracket(), flange(), box(30, 20, 10), cylinder(5, 20)], ids=["bracket", "flange", "box", "rod"]
)
@pytest.mark.parametrize("mirror", [np.eye(4), MIRROR], ids=["turned", "mirrored"])
def test_a_copy_drawn_elsewhere_is_equal(solid: Solid, mirror: np.ndarray) -> None:
    """One that is drawn turned, moved and mirrored is of one kind with the first, another one is not."""
    copy = reexported(part("copy", solid, 70, -20, 300, ODD), to=mirror)
    found = equal(part("one", solid), *copy, part("other", box(31, 20, 10)))
    assert found.kind(1) == found.kind(2) != found.kind(3)


@pytest.mark.parametrize("mirror", [np.eye(4), MIRROR], ids=["turned", "mirrored"])
def test_an_axis_is_carried_to_a_copy(mirror: np.ndarray) -> None:
    """The bore of a bracket is carried to that of its copy, and to no other place."""
    copy = reexported(part("copy", bracket(), 70, -20, 300, ODD), to=mirror)
    found = equal(part("one", bracket(), 1, 2, 3), *copy)
    X = mirror @ part("", bracket(), 70, -20, 300, ODD).X.matrix
    (axis,) = found.carried(1, 2, Axis(np.array([13, 7, 3]) * 1e-3, np.array([0.0, 0.0, 1.0])))
    assert axis.same(Axis(X[:3, :3] @ [12e-3, 5e-3, 0.0] + X[:3, 3], X[:3, 2]), 1e-9)


def test_a_square_block_is_carried_in_each_way_it_fits() -> None:
    """A stepper fits onto its copy in four ways, and its mirror image in four: its shaft is at one place in all."""
    copy = reexported(part("copy", flange(), 70, -20, 300, ODD))
    found = equal(part("one", flange()), *copy)
    shaft = found.carried(1, 2, Axis(np.zeros(3), np.array([0.0, 0.0, 1.0])))
    corner = found.carried(1, 2, Axis(np.array([15.5e-3, 15.5e-3, 0.0]), np.array([0.0, 0.0, 1.0])))
    assert len(shaft) == 8
    assert all(axis.same(shaft[0], 1e-9) for axis in shaft)
    assert sum(not corner[0].same(axis) for axis in corner) == 6


def test_motors_drawn_in_place_each_are_motors_by_use() -> None:
    """Three unnamed motors that are products of their own are found as occurrences of one are; two may be limbs."""
    nodes = [*two_servos(), servo("c", 0, 0), part("plate c", PLATE, 0, 0, -32.5), part("arm c", ARM, 50, 0, 5)]
    expected = [("revolute", f"arm {side}", "base") for side in "abc"]
    for some in (nodes, reexported(*nodes), reexported(*nodes, to=MIRROR)):
        assert [motor.is_named for motor in motors(some, BARE)] == [False] * 3
        assert joints(inferred(*some, sources=BARE)) == expected
    assert motors(reexported(*two_servos()), BARE) == []


def test_a_mirror_image_is_no_second_motor() -> None:
    """The links of a left limb are those of the right one, mirrored: as many as there are limbs are no motors."""
    rigid = {
        equal(part("one", bracket()), *copy).turned_kind(2)[1]
        for copy in (
            reexported(part("copy", bracket(), 70, rpy=ODD)),
            reexported(part("copy", bracket(), 70, rpy=ODD), to=MIRROR),
        )
    }
    assert rigid == {False, True}


def test_touching_motors_with_numbers_are_no_pieces_of_one() -> None:
    """Two servos on each other, products with a number each, are two motors; a servo and its lid are one."""
    servos = reexported(part("servo 1", bracket()), part("servo 2", bracket(), 0, 0, 10, (pi, 0, 0)))
    assert len(motors(servos)) == 2


@pytest.mark.slow
@pytest.mark.parametrize(("shapes", "kinds"), [(1, 2000), (20, 20)])
def test_kinds_of_thousands_of_parts_take_little_time(shapes: int, kinds: int) -> None:
    """Of two thousand products those of 20 shapes are known as equal; more of one shape are screws or chain links."""
    one = assembled(part("one", flange()))
    body, first = one.bodies[0], one.components[1]
    assert body.exact is not None
    of = body.exact.unit_density
    exact = [
        VolumeProperties.of(of.mass * k, np.array(of.com), np.array(of.inertia) * k)
        for k in (1.0 + 0.01 * (n % shapes) for n in range(2000))
    ]
    parts = tuple(replace(first, index=n + 1, body=n, definition=n) for n in range(2000))
    bodies = tuple(replace(body, exact=e) for e in exact)
    cut: dict[str, None] = {}
    found = EqualParts(Scene(replace(one, components=(one.components[0], *parts), bodies=bodies)), cut)
    start = process_time()
    assert len({found.kind(c.index) for c in parts}) == kinds
    assert bool(cut) == (shapes == 1)
    assert process_time() - start < 10.0


@pytest.mark.parametrize("solid", [bracket(), cylinder(4, 60), box(60, 20, 4)], ids=["bracket", "rod", "sheet"])
def test_a_part_is_as_large_as_it_is_however_it_is_turned(solid: Solid) -> None:
    """Size, box and span of a part are the same if it is turned in the assembly and if it is drawn turned."""
    upright, placed = Scene(assembled(part("one", solid))), part("one", solid, 70, -20, 300, ODD)
    X = placed.X.matrix
    size = np.linalg.norm(upright.extent(1))
    low, high = upright.span(1, X[:3, :3].T @ UP)
    for nodes in ([placed], reexported(placed)):
        scene = Scene(assembled(*nodes))
        assert sorted(scene.extent(1)) == pytest.approx(sorted(upright.extent(1)), abs=1e-6)
        assert Survey(scene.assembly, ALL_SOURCES).parts[1].size == pytest.approx(size, abs=1e-6)
        assert scene.span(1, UP) == pytest.approx((low + X[2, 3], high + X[2, 3]), abs=1e-6)
        assert scene.boxes[1][:, 2] == pytest.approx(scene.span(1, UP), abs=1e-6)
    corners = np.array(list(product((-30, 30), (-10, 10), (-2, 2)))) * 1e-3 @ X[:3, :3].T + X[:3, 3]
    if solid.moments.mass == 4800:
        assert scene.boxes[1] == pytest.approx(np.array([corners.min(axis=0), corners.max(axis=0)]), abs=1e-6)
