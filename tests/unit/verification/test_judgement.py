"""Edges of the judgement that nothing else passes over: default scales, loops in tables, words with one meaning."""

from math import inf, nan
from pathlib import Path

import pytest

from stepbot.engines.engine import Tolerance
from stepbot.engines.observation import Observation, ObservedClosure, ObservedJoint, ObservedLink, ObservedShape
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.joint_table import JointRow
from stepbot.verification.admission import robot_files
from stepbot.verification.compare import compare
from stepbot.verification.deviation import Deviations
from stepbot.verification.joint_rows import joint_rows
from stepbot.verification.normalized import normalized
from stepbot.verification.text import means_the_same


def test_a_relative_tolerance_allows_nothing_without_a_scale() -> None:
    """Numbers are measured by the expected one, distances by what the caller states, or else not at all."""
    deviations = Deviations(Tolerance(absolute=1e-9, relative=0.5, of_whole=0.5))
    deviations.near(-1.1, -1.0, "number", "m")
    deviations.near(0.1, 0.0, "number beside 0", "m")
    deviations.off(0.1, "distance", "m")
    deviations.off(0.1, "distance of a scale", "m", 1.0)
    deviations.off(0.1, "distance in a whole", "m", whole=1.0)
    assert [(one.where, one.allowed) for one in deviations.failures] == [("number beside 0", 1e-9), ("distance", 1e-9)]


@pytest.mark.parametrize(
    ("a", "b", "passes"), [(inf, inf, True), (inf, -inf, False), (nan, nan, False), (0, -0.0, True)]
)
def test_equal_infinities_are_equal(a: float, b: float, passes: bool) -> None:
    """Limits may be infinite; what is no number equals nothing."""
    deviations = Deviations(Tolerance(absolute=1e-9))
    deviations.near(a, b, "limit", "rad")
    assert bool(deviations.failures) is not passes


def test_a_closure_is_listed_where_its_frame_is() -> None:
    """Its origin and axis are in the frame of the base, though it is stated in that of its first link."""
    quarter = Pose.from_xyz_rpy((1.0, 0.0, 0.0), (0.0, 0.0, 1.5707963267948966))
    closure = ObservedClosure(
        "pin", "revolute", "a", "b", X_AF=Pose.from_xyz_rpy((2.0, 0.0, 0.5), (0.0, 0.0, 0.0)), axis=(1.0, 0.0, 0.0)
    )
    seen = Observation("engine", "1", "sdf", poses=({"a": quarter, "b": IDENTITY},), closures=(closure,))
    (row,) = joint_rows(seen)
    assert row == JointRow("pin", "revolute", "a", "b", (1.0, 2.0, 0.5), (0.0, 1.0, 0.0), is_closure=True)


@pytest.mark.parametrize(
    ("kind", "unit"), [("prismatic", "m"), ("revolute", "rad"), (None, "rad or m")], ids=["slide", "turn", "unknown"]
)
def test_the_initial_position_of_a_joint_has_its_unit(kind: str | None, unit: str) -> None:
    """A joint that the expectation does not list may be of either kind."""
    joints = () if kind is None else (ObservedJoint("j", kind, "a", "b"),)
    links = (ObservedLink("a"), ObservedLink("b"))
    seen = [Observation("engine", "1", "mjcf", links=links, joints=joints, initial={"j": q}) for q in (0.2, 0.5)]
    (worst,) = (
        one.deviations.worst for one in compare(*seen) if one.deviations.worst is not None and one.deviations.failures
    )
    assert worst.unit == unit
    assert worst.amount == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("other", "is_same"), [("0 0 1 0 0 0", True), ("0 0 0 0 0 1", True), ("0 0 0 0 0 2", False), ("0 0 1 0 0", False)]
)
def test_a_segment_has_no_direction(other: str, is_same: bool) -> None:
    """A capsule from one end to the other is the one from the other to the first."""
    word = "mujoco/worldbody/geom@fromto"
    assert means_the_same(word, "0 0 0 0 0 1", other, {}) is is_same


def test_shapes_without_names_are_paired_by_their_boxes() -> None:
    """Formats list them in any order; one without a box is nearest to any."""
    near, far = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), ((5.0, 0.0, 0.0), (6.0, 1.0, 1.0))
    red, blue = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
    one = [ObservedShape(rgba=red, bounds=near), ObservedShape(rgba=blue, bounds=far)]

    def shown(written_in: str, shapes: list[ObservedShape]) -> Observation:
        link = ObservedLink("a", has_visuals=True, visuals=tuple(shapes))
        return Observation("engine", "1", written_in, links=(link,))

    paired = normalized(shown("urdf", one), shown("mjcf", one[::-1]))
    assert not [one.quantity for one in compare(*paired) if one.deviations.failures]
    exchanged = [ObservedShape(rgba=blue, bounds=near), ObservedShape(rgba=red, bounds=far)]
    paired = normalized(shown("urdf", one), shown("mjcf", exchanged))
    assert [one for one in compare(*paired) if one.deviations.failures]


def test_the_files_of_one_robot_are_taken_for_their_folder(tmp_path: Path) -> None:
    """Two robots in a folder are not: which one is meant is unknown."""
    for name in ("arm.urdf", "arm.xml"):
        (tmp_path / name).write_text("<mujoco/>", encoding="utf-8")
    assert [path.name for path in robot_files(tmp_path)] == ["arm.urdf", "arm.xml"]
    (tmp_path / "hand.urdf").touch()
    assert robot_files(tmp_path) == (tmp_path,)
