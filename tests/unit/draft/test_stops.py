"""Stops of joints by collision of lugs, against closed forms, and contacts that are no stop."""

from math import asin, degrees, pi

import numpy as np
import pytest
import trimesh
from msgspec.structs import replace

from stepbot.draft.draft import Confidence, Draft, DraftJoint, DraftLink, OriginForm, OriginSnippet
from stepbot.draft.stops import stops
from stepbot.draft.stops.stops import Question, Shape, Stops, find_stops, with_stops
from stepbot.draft.stops.sweeps import Triangles, across, radii_and_heights, reach, slide, turn
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly, Body, BodyKind, Component

WIDTH, RADIUS = 0.004, 0.03


def box(part: int, center: tuple[float, float, float], size: tuple[float, float, float]) -> Shape:
    """A box along the axes of the assembly."""
    mesh = trimesh.creation.box(extents=size)
    return Shape(part, np.asarray(mesh.vertices) + center, np.asarray(mesh.faces, dtype=np.int32))


def tube(part: int, inner: float, outer: float) -> Shape:
    """A tube about z."""
    mesh = trimesh.creation.annulus(r_min=inner, r_max=outer, height=0.02, sections=24)
    return Shape(part, np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int32))


def turning(still: tuple[Shape, ...], moving: tuple[Shape, ...]) -> Question:
    """A joint about z."""
    return Question(False, np.zeros(3), np.array([0.0, 0.0, 1.0]), still, moving)


def test_lugs_stop_a_turn_where_they_meet() -> None:
    """Two lugs, a quarter turn apart, stop where the inner corner of one meets the side of the other."""
    lug = (0.02, WIDTH, 0.01)
    moving = box(1, (RADIUS, 0.0, 0.0), lug)
    still = box(0, (0.0, RADIUS, 0.0), (WIDTH, 0.02, 0.01))
    (answer,) = find_stops((turning((still,), (moving,)),))
    lower, upper = answer.stops
    # Sides at half a width from the radial line meet where both are at the inner radius, 20 mm.
    half = asin(0.5 * WIDTH / np.hypot(0.02, 0.5 * WIDTH))
    assert upper.position == pytest.approx(0.5 * pi - 2.0 * half, abs=1e-3)
    assert lower.position == pytest.approx(-1.5 * pi + 2.0 * half, abs=1e-3)
    assert (upper.still, upper.moving) == (0, 1)


def test_equal_joints_are_stopped_by_their_own_parts() -> None:
    """Joints elsewhere with equal lugs have the same stops; one whose lug is nearer has others."""
    questions = []
    for number, (away, near) in enumerate(((0.0, 0.0), (0.3, 0.0), (0.7, 0.004))):
        middle = np.array([away, -away, 0.1])
        moving = box(3 * number + 1, (RADIUS, 0.0, 0.0), (0.02, WIDTH, 0.01))
        still = box(3 * number, (near, RADIUS, 0.0), (WIDTH, 0.02, 0.01))
        lugs = (replace(lug, vertices=lug.vertices + middle) for lug in (still, moving))
        questions.append(Question(False, middle, np.array([0.0, 0.0, 1.0]), *((lug,) for lug in lugs)))
    first, second, third = find_stops(questions)
    assert [(stop.still, stop.moving) for stop in second.stops] == [(3, 4)] * 2
    assert [stop.position for stop in second.stops] == [stop.position for stop in first.stops]
    assert [(stop.still, stop.moving) for stop in third.stops] == [(6, 7)] * 2
    assert abs(third.stops[1].position - first.stops[1].position) > 0.03
    assert find_stops(questions[1:2]) == (second,)


def test_shaft_in_its_bore_stops_nothing() -> None:
    """Round faces about the axis do not collide with themselves, for any mesh; nor do flush ends."""
    assert find_stops((turning((tube(0, 0.01, 0.02),), (tube(1, 0.005, 0.01),)),)) == (Stops(()),)


def test_slide_stops_at_both_ends() -> None:
    """A block between two cheeks, 10 mm and 30 mm away, stops there, to 1e-3 of its travel."""
    cheeks = (box(0, (-0.02, 0.0, 0.0), (0.01, 0.02, 0.02)), box(1, (0.04, 0.0, 0.0), (0.01, 0.02, 0.02)))
    block = box(2, (0.0, 0.0, 0.0), (0.01, 0.01, 0.01))
    floor = box(3, (0.0, 0.0, -0.01), (0.2, 0.02, 0.01))
    question = Question(True, np.zeros(3), np.array([1.0, 0.0, 0.0]), (*cheeks, floor), (block,))
    (answer,) = find_stops((question,))
    lower, upper = answer.stops
    assert (lower.position, lower.still) == (pytest.approx(-0.01, abs=1e-4), 0)
    assert (upper.position, upper.still) == (pytest.approx(0.03, abs=1e-4), 1)


def test_parts_that_meet_as_drawn_are_no_stop() -> None:
    """Lugs that overlap as drawn give no stop."""
    still, moving = box(0, (RADIUS, 0.0, 0.0), (0.02, 0.01, 0.01)), box(1, (RADIUS, 0.002, 0.001), (0.02, 0.01, 0.01))
    assert not any(abs(stop.position) < 0.5 for stop in find_stops((turning((still,), (moving,)),))[0].stops)


def test_same_stops_every_time() -> None:
    """The result is deterministic to the last bit."""
    moving = box(1, (RADIUS, 0.0, 0.0), (0.02, WIDTH, 0.01))
    still = box(0, (0.0, RADIUS, 0.0), (WIDTH, 0.02, 0.01))
    question = turning((still,), (moving,))
    assert find_stops((question,)) == find_stops((question,))


def test_pairs_beyond_the_bound_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pairs of parts beyond the limit are counted as not compared."""
    monkeypatch.setattr(stops, "_MOST", 100)
    moving = box(1, (RADIUS, 0.0, 0.0), (0.02, WIDTH, 0.01))
    still = box(0, (0.0, RADIUS, 0.0), (WIDTH, 0.02, 0.01))
    assert find_stops((turning((still,), (moving,)),)) == (Stops((), skipped=1),)


def test_the_nearest_of_several_stops_is_found_in_any_order() -> None:
    """Of four lugs around a turning one, the nearest stops it in either direction, whatever comes first."""
    lugs = [
        box(part, (RADIUS * np.cos(angle), RADIUS * np.sin(angle), 0.0), (WIDTH, WIDTH, 0.01))
        for part, angle in enumerate((2.0, 1.0, -2.5, -1.5))
    ]
    moving = box(4, (RADIUS, 0.0, 0.0), (0.02, WIDTH, 0.01))
    for still in (lugs, lugs[::-1]):
        (answer,) = find_stops((turning(tuple(still), (moving,)),))
        assert [stop.still for stop in answer.stops] == [3, 1]


def test_a_way_beyond_the_longest_that_matters_is_infinite() -> None:
    """A point that meets a triangle after 10 mm, or a quarter turn, meets none within less."""
    corners = np.array([[[-0.05, -0.05, 0.01], [0.05, -0.05, 0.01], [0.0, 0.05, 0.01]]])
    ahead = Triangles(corners, *across(corners))
    assert slide(np.zeros((1, 3)), ahead, 1.0, np.inf) == pytest.approx(0.01)
    assert slide(np.zeros((1, 3)), ahead, 1.0, 0.009) == np.inf
    corners = np.array([[[0.0, 0.01, -0.05], [0.0, 0.05, -0.05], [0.0, 0.03, 0.05]]])
    beside = Triangles(corners, *reach(corners))
    assert turn(np.array([[0.03, 0.0, 0.0]]), beside, 1.0, np.inf) == pytest.approx(0.5 * pi)
    assert turn(np.array([[0.03, 0.0, 0.0]]), beside, 1.0, 1.5) == np.inf


def test_a_turn_leaves_radius_and_height() -> None:
    """Distances from the axis, and positions along it."""
    np.testing.assert_allclose(radii_and_heights(np.array([[3.0, -4.0, 7.0], [0.0, 0.0, -2.0]])), [[5, 7], [0, -2]])


@pytest.mark.parametrize("size", [0.2, 1.0, 5.0])
@pytest.mark.parametrize(("ahead", "is_narrow"), [(0.2, True), (1.0, False)])
def test_a_joint_with_a_narrow_range_is_to_be_reviewed(size: float, ahead: float, *, is_narrow: bool) -> None:
    """A lever between two lugs, 0.2 rad away on either side, has a REVIEW with the range; with 1 rad it has none."""
    lever = box(1, (RADIUS, 0.0, 0.0), (0.02, WIDTH, 0.01))
    lugs = [
        box(0, (RADIUS * np.cos(angle), RADIUS * np.sin(angle), 0.0), (WIDTH, WIDTH, 0.01))
        for angle in (-ahead - 0.13, ahead + 0.13)
    ]
    meshes = [TriMesh.of(size * shape.vertices, shape.faces) for shape in (*lugs, lever)]
    names = ("lug 1", "lug 2", "motor bracket")
    components = [Component(0, -1, ".", ".", "", "", 1)]
    components += [Component(n, 0, name, name, name, "", 1, Pose(), n - 1, n) for n, name in enumerate(names, 1)]
    colors = np.zeros(0, dtype=np.int32)
    bodies = tuple(Body(BodyKind.SOLID, mesh, colors, (None,), True) for mesh in meshes)
    sure = Confidence(0.83, ("output of a motor",))
    joint = DraftJoint(
        *("bracket_joint", JointKind.REVOLUTE, OriginSnippet(OriginForm.XYZ), "z", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        *(sure, ("lug 1", "motor bracket")),
        parent="arm",
        child="bracket",
    )
    links = (
        DraftLink("arm", (), sure, rest=True, components=(1, 2)),
        DraftLink("bracket", names[2:], sure, components=(3,)),
    )
    assembly = Assembly("made.step", "AP242", "", "mm", 1e-3, tuple(components), bodies)
    (found,) = with_stops(Draft("robot", "arm", links, (joint,)), assembly).joints
    low, high = sorted(stop.position for stop in found.stops)
    assert (low, high) == (pytest.approx(-ahead, abs=0.05), pytest.approx(ahead, abs=0.05))
    assert found.is_reviewed == is_narrow
    assert found.review == (
        f"its stops leave it only {degrees(low):.3g} deg to {degrees(high):.3g} deg" if is_narrow else ""
    )
