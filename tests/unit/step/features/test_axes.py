"""Faces become axis lines, and lines shared by two components become joint frames, as documented."""

import time
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, Pose, Vector3
from stepbot.robot.joint_table import Basis
from stepbot.step.assembly import Assembly, AxisFace, Body, BodyKind, Component
from stepbot.step.features import axes
from stepbot.step.features.axes import AxisFaces, Selector

MM = 1e-3
MICRON = 1e-6


def _face(
    point: Vector3,
    direction: Vector3 = (0, 0, 1),
    radius: float = 4.0,
    low: float = 0.0,
    high: float = 10.0,
    cone: bool = False,
) -> AxisFace:
    """A face with lengths in mm."""
    d = np.array(direction) / np.linalg.norm(direction)
    x, y, z = (MM * c for c in point)
    return AxisFace((x, y, z), tuple(d.tolist()), radius * MM, low * MM, high * MM, bore=True, cone=cone)


def _assembly(*parts: tuple[Pose, Sequence[AxisFace]]) -> Assembly:
    nothing = TriMesh.of(np.zeros((0, 3)), np.zeros((0, 3)))
    components = [Component(0, -1, "", ".", "robot", "robot", 1)]
    bodies = []
    for i, (X_WC, faces) in enumerate(parts):
        name = "abcdefgh"[i]
        components.append(Component(i + 1, 0, name, name, name, name, 1, X_WC=X_WC, body=i, definition=i))
        bodies.append(
            Body(BodyKind.SOLID, nothing, np.zeros(0, dtype=np.int32), (), watertight=True, axis_faces=tuple(faces))
        )
    return Assembly("a.step", "AP214", "", "mm", MM, tuple(components), tuple(bodies))


def _faces(*faces: AxisFace) -> AxisFaces:
    return axes.axis_faces(_assembly((Pose(), faces)), [1])


def _two(a: Sequence[AxisFace], b: Sequence[AxisFace], X_WB: Pose = IDENTITY) -> tuple[AxisFaces, AxisFaces]:
    assembly = _assembly((Pose(), a), (X_WB, b))
    return axes.axis_faces(assembly, [1]), axes.axis_faces(assembly, [2])


def _mm(values: Sequence[float]) -> list[float]:
    return [round(1e3 * value, 9) for value in values]


def test_faces_of_one_axis_are_one_line() -> None:
    """Bore, shaft and chamfer on one axis are one line; its point is the middle of them all."""
    found = axes.lines(
        _faces(
            _face((5, 0, 0), radius=4, low=0, high=10),
            _face((5, 0, 30), (0, 0, -1), radius=2.5, low=-10, high=10),
            _face((5, 0, -7), radius=4.5, low=0, high=1, cone=True),
            _face((25, 0, 0), radius=1),
        )
    )
    assert len(found) == 2
    line = found[0]
    assert _mm(line.radii) == [4.5, 4, 2.5]
    assert line.direction == (0, 0, 1)
    assert _mm(line.point) == [5, 0, 16.5]
    assert _mm((line.low, line.high)) == [-23.5, 23.5]
    assert line.weight == 4.5 * MM
    assert _mm(found[1].point) == [25, 0, 5]


@pytest.mark.parametrize(
    ("apart", "angle", "together"),
    [(9 * MICRON, 0, True), (11 * MICRON, 0, False), (0, 0.9e-3, True), (0, 1.1e-3, False), (5e-5, 0.9e-3, False)],
)
def test_tolerances(apart: float, angle: float, together: bool) -> None:
    """Faces share a line within 0.01 mm and 1 mrad."""
    d = (np.sin(angle), 0.0, np.cos(angle))
    faces = _faces(_face((0, 0, 0)), _face((0, 1e3 * apart, 0), d))
    assert (len(axes.lines(faces)) == 1) is together


def test_distance_counts_where_the_faces_are() -> None:
    """Lines at a milliradian that intersect at the origin are two lines if their faces are a metre away."""
    d = (np.sin(0.5e-3), 0.0, np.cos(0.5e-3))
    near = _faces(_face((0, 0, 0), low=0, high=10), _face((0, 0, 0), d, low=0, high=10))
    far = _faces(_face((0, 0, 0), low=1000, high=1010), _face((0, 0, 0), d, low=1000, high=1010))
    assert len(axes.lines(near)) == 1
    assert len(axes.lines(far)) == 2


@pytest.mark.parametrize(
    ("drawn", "expected"),
    [
        ((0, 0, -1), (0, 0, 1)),
        ((0, -1, 0), (0, 1, 0)),
        ((-1, 0, 0), (1, 0, 0)),
        ((3, 4, -1e-5), (-3, -4, 1e-5)),
        ((3, -4, -1e-7), (-3, 4, 1e-7)),
        ((3, -4, 1e-7), (-3, 4, -1e-7)),
    ],
)
def test_sign_rule(drawn: Vector3, expected: Vector3) -> None:
    """Of (z, y, x) of the direction the first component above 1e-6 is positive, for any direction in the kernel."""
    (line,) = axes.lines(_faces(_face((0, 0, 0), drawn)))
    np.testing.assert_allclose(line.direction, np.array(expected) / np.linalg.norm(expected), atol=1e-15)


def test_frame_rule() -> None:
    """Joint frames have z along the line; x is the assembly's x made normal to it, or y if z is near x."""
    (line,) = axes.lines(_faces(_face((1, 2, 3), (0, 1, 0), low=-1, high=1)))
    frame = axes.line_frame(line)
    np.testing.assert_allclose(frame.R, [[1, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-15)
    np.testing.assert_allclose(frame.p, [1e-3, 2e-3, 3e-3], atol=1e-15)
    (line,) = axes.lines(_faces(_face((0, 0, 0), (1, 0, 0))))
    np.testing.assert_allclose(axes.line_frame(line).R, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-15)
    (line,) = axes.lines(_faces(_face((0, 0, 0), (0.6, 0, 0.8))))
    np.testing.assert_allclose(axes.line_frame(line).R, [[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]], atol=1e-15)


def test_mate_of_a_pin_in_a_hole() -> None:
    """A shaft in a bore is a mate; the origin is midway between the larger low end and the smaller high end."""
    pin = [_face((0, 0, 0), radius=3.9, low=-5, high=25)]
    hole = [_face((0, 0, 0), (0, 0, 1), radius=4.0, low=0, high=10)]
    a, b = _two(pin, hole, Pose.of(position=(0, 0, 12 * MM)))
    (mate,) = axes.mates(a, b)
    assert _mm(mate.point) == [0, 0, 17]  # the hole, from 12 to 22, is inside the pin
    assert mate.weight == pytest.approx(3.9 * MM, rel=1e-12)
    assert _mm(mate.radii) == [4, 3.9]
    assert mate.components == (1, 2)


def test_mate_of_two_plates_apart() -> None:
    """Without an overlap of extents the origin is in the middle of the gap."""
    a, b = _two([_face((0, 0, 0), low=0, high=4)], [_face((0, 0, 0), low=10, high=11)])
    assert _mm(axes.mates(a, b)[0].point) == [0, 0, 7]


def test_mate_is_the_same_from_both_sides() -> None:
    """Exchanging parent and child does not change the mate."""
    a, b = _two(
        [_face((0, 0, 0), radius=4, low=0, high=4), _face((9, 0, 0), radius=1)],
        [_face((0, 0, 3), (0, 0, -1), radius=4, low=-4, high=6), _face((9, 0, 0), radius=1.5)],
    )
    assert [m.point for m in axes.mates(a, b)] == [m.point for m in axes.mates(b, a)]


@pytest.mark.parametrize("size", [60.0, 6.0, 2.0, 1.0])
def test_a_joint_is_on_its_shaft_at_any_size(size: float) -> None:
    """It is found where the robot is so small that all of its holes are within a millimetre and a half."""
    r = size / 60.0
    post = [(0.3, 0.0, 2.0, True), (1.0, 0.0, 60.0, False), (3.0, 0.0, 40.0, False)]
    arm = [(0.305, 55.0, 60.0, True), (1.02, 40.0, 50.0, True), (3.2, 40.0, 50.0, False)]
    sides = [
        [replace(_face((0, 0, 0), radius=a * r, low=b * r, high=c * r), bore=bore) for a, b, c, bore in side]
        for side in (post, arm)
    ]
    assembly = _assembly((Pose(), sides[0]), (Pose(), sides[1]))
    box = TriMesh.of(np.diag([size * MM] * 3), np.array([[0, 1, 2]], dtype=np.int32))
    assembly = replace(assembly, bodies=tuple(replace(body, mesh=box) for body in assembly.bodies))
    (line,) = axes.mates(axes.axis_faces(assembly, [1]), axes.axis_faces(assembly, [2]))
    assert line.basis is Basis.FIT
    assert [face.radius * 1e3 / r for face in line.faces] == pytest.approx([1.0, 1.02])


def test_cones_do_not_mate() -> None:
    """A countersink is no mate: only cylinders are."""
    a, b = _two([_face((0, 0, 0), cone=True)], [_face((0, 0, 0))])
    assert axes.mates(a, b) == ()


def test_weight_is_that_of_the_faces_that_meet() -> None:
    """The weight is that of the faces in contact, not of a wide flange against a pin or of wide rims apart."""
    a, b = _two([_face((0, 0, 0), radius=20), _face((0, 0, 0), radius=2)], [_face((0, 0, 0), radius=3)])
    assert axes.mates(a, b)[0].weight == pytest.approx(3 * MM)
    pin, rim = replace(_face((0, 0, 0), radius=2), bore=False), replace(_face((0, 0, 0), radius=30), bore=False)
    a, b = _two([pin, rim], [_face((0, 0, 0), radius=2.1), rim])
    assert axes.mates(a, b)[0].weight == pytest.approx(2 * MM)


def _bolt_circle(center: float, bolt: float) -> list[AxisFace]:
    holes = [_face((10 * np.cos(t), 10 * np.sin(t), 0), radius=bolt) for t in np.arange(4) * np.pi / 2]
    return [_face((0, 0, 0), radius=center), *holes]


def test_the_bearing_beats_the_bolt_circle() -> None:
    """A line at least twice as heavy as the next is selected; otherwise all candidates are reported."""
    choice = axes.choose(axes.mates(*_two(_bolt_circle(4, 2), _bolt_circle(4, 2))))
    assert choice.line is not None
    assert _mm(choice.line.point) == [0, 0, 5]
    choice = axes.choose(axes.mates(*_two(_bolt_circle(4, 2.01), _bolt_circle(4, 2.01))))
    assert choice.line is None
    assert len(choice.rivals) == 5


def test_radius_narrows_down() -> None:
    """``radius`` matches within 0.01 mm, for a component's faces and for shared lines."""
    a, b = _two(_bolt_circle(4, 2.5), _bolt_circle(4, 2.5))
    assert axes.choose(axes.mates(a, b, radius=4.009 * MM)).line is not None
    assert axes.mates(a, b, radius=4.011 * MM) == ()
    assert len(axes.choose(axes.mates(a, b, radius=2.5 * MM)).rivals) == 4
    faces = _faces(_face((0, 0, 0), radius=4, low=0, high=10), _face((0, 0, 0), radius=6, low=10, high=20))
    (line,) = axes.lines(faces, radius=6 * MM)
    assert _mm(line.point) == [0, 0, 15]  # the extent is that of the selected face only
    assert _mm(axes.lines(faces)[0].point) == [0, 0, 10]


def test_near_takes_the_nearest_line() -> None:
    """``near`` selects the line nearest to a point of the assembly, of any weight; a tie is ambiguous."""
    found = axes.lines(_faces(*_bolt_circle(4, 2.5)))
    choice = axes.choose(found, near=(9 * MM, 1 * MM, 99 * MM))
    assert choice.line is not None
    assert _mm(choice.line.point) == [10, 0, 5]
    assert len(axes.choose(found, near=(7 * MM, 7 * MM, 0.0)).rivals) == 2


def test_a_slide_needs_only_the_direction() -> None:
    """For a prismatic joint parallel lines are equivalent; other directions compete by weight."""
    guides = [_face((0, 0, 0), radius=3), _face((20, 0, 0), radius=3)]
    assert axes.choose(axes.lines(_faces(*guides))).line is None
    choice = axes.choose(axes.lines(_faces(*guides)), direction_only=True)
    assert choice.line is not None
    assert choice.line.direction == (0, 0, 1)
    across = axes.lines(_faces(*guides, _face((0, 0, 0), (1, 0, 0), radius=2)))
    assert len(axes.choose(across, direction_only=True).rivals) == 2


def test_no_line_at_all() -> None:
    """Components without cylinders have no lines and no mates."""
    nothing = _faces()
    assert axes.lines(nothing) == ()
    assert axes.mates(nothing, _faces(_face((0, 0, 0)))) == ()
    assert axes.near_misses(nothing, nothing) == ()
    assert axes.choose(()) == axes.Choice(None)


def test_near_misses_say_how_far() -> None:
    """Lines up to 2 mm apart that do not mate are reported with their distance, the widest first."""
    a, b = _two(
        [_face((0, 0, 0), radius=4), _face((50, 0, 0), radius=1), _face((80, 0, 0), radius=9)],
        [_face((1.57, 0, 0), radius=5), _face((50, 0.06, 0), radius=1), _face((82.1, 0, 0), radius=9)],
    )
    assert axes.mates(a, b) == ()
    first, second = axes.near_misses(a, b)
    assert (first.distance, first.weight) == pytest.approx((1.57 * MM, 4 * MM))
    assert second.distance == pytest.approx(0.06 * MM)
    assert first.angle == 0


def test_a_line_that_mates_misses_none() -> None:
    """A line near one that mates is no near miss; one near another line is."""
    a, b = _two([_face((0, 0, 0)), _face((50, 0, 0))], [_face((0, 0, 0)), _face((1, 0, 0)), _face((51, 0, 0))])
    assert len(axes.mates(a, b)) == 1
    (miss,) = axes.near_misses(a, b)
    assert _mm(miss.line_b.point) == [51, 0, 5]


def test_a_tilted_line_is_a_near_miss() -> None:
    """Lines at an angle beyond the tolerance do not mate, and are reported with the angle."""
    a, b = _two([_face((0, 0, 0))], [_face((0, 0, 0), (0.005, 0, 1))])
    assert axes.mates(a, b) == ()
    assert axes.near_misses(a, b)[0].angle == pytest.approx(0.005, rel=1e-4)


def test_selectors_select_just_their_line() -> None:
    """A suggested selector selects the line that it is listed with."""
    faces = _faces(
        *_bolt_circle(4, 2.5), _face((0, 0, 0), (1, 0, 0), radius=2.5), _face((0, 40, 0), (0, 1, 1), radius=3.2)
    )
    found = axes.lines(faces)
    offered = axes.selectors(found)
    assert len(offered) == 7
    for line, selector in zip(found, offered, strict=True):
        choice = axes.choose(axes.lines(faces, selector.radius), selector.near)
        assert choice.line is not None
        assert choice.line.point == line.point, selector
    assert [str(s) for s in offered[:2]] == [", radius: 4 mm", ", radius: 3.2 mm"]


def test_selector_of_a_line_that_wins_is_empty() -> None:
    """The selector of a line that is selected anyway is empty."""
    assert axes.selectors(axes.lines(_faces(*_bolt_circle(6, 2))))[0] == Selector()


@given(
    st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: float(np.linalg.norm(v)) > 0.1),
    st.tuples(*[st.floats(-2, 2)] * 3),
    st.lists(st.tuples(st.floats(-0.1, 0.1), st.booleans()), min_size=1, max_size=6),
)
def test_any_line_in_space(direction: Vector3, point: Vector3, faces: list[tuple[float, bool]]) -> None:
    """Faces with any axis and orientation are one line with the right extent."""
    d = np.array(direction) / np.linalg.norm(direction)
    drawn = []
    for t, flipped in faces:
        x, y, z = (np.array(point) + t * d).tolist()
        u, v, w = (-d if flipped else d).tolist()
        drawn.append(AxisFace((x, y, z), (u, v, w), 0.004, -0.005, 0.005, bore=False))
    (line,) = axes.lines(_faces(*drawn))
    ts = [t for t, _ in faces]
    assert line.high - line.low == pytest.approx(max(ts) - min(ts) + 0.01, abs=1e-9)
    np.testing.assert_allclose(line.point, np.array(point) + 0.5 * (max(ts) + min(ts)) * d, atol=1e-9)


@pytest.mark.slow
def test_time_grows_less_than_quadratically() -> None:
    """Eight times the faces, on lines in a hundred directions, take far less than 64 times as long."""
    few, many = _random_shafts(1_250), _random_shafts(10_000)
    axes.lines(few)  # initialization is not counted

    def seconds(table: AxisFaces, count: int) -> float:
        start = time.process_time()
        assert len(axes.lines(table)) == count
        return time.process_time() - start

    assert seconds(many, 10_000) < 32 * max(min(seconds(few, 1_250) for _ in range(3)), 0.01)


def _random_shafts(count: int) -> AxisFaces:
    """Shafts of two faces each, on lines in a hundred directions."""
    random = np.random.default_rng(1)
    directions = random.normal(size=(100, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    faces = []
    for i in range(count):
        u, v, w = directions[i % 100].tolist()
        x, y, z = random.uniform(-1, 1, 3).tolist()
        faces += [AxisFace((x, y, z), (u, v, w), 0.002, a, a + 0.01, bore=False) for a in (0.0, 0.1)]
    return _faces(*faces)
