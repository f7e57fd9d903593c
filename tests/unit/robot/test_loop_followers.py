"""Joints of loops as mimics of driven joints, against closed forms of parallelograms."""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.geometry.spatial import Array
from stepbot.robot import closures
from stepbot.robot.closures import Loops
from stepbot.robot.loop_followers import ANGLE, loop_followers
from stepbot.robot.model import Actuator, ActuatorKind, Joint, JointKind, Limit, Robot
from tests.closed_mechanisms import closure
from tests.robots import ROBOTS
from tests.simulators.conftest import failures, look, write
from tests.workshop import Workshop, at

GROUND, CRANK = 0.3, 0.1
DRAWN = math.radians(70.0)
LIMIT = Limit(-0.5, 0.5)


def parallelogram(longer: float = 0.0) -> Robot:
    """Two cranks and a coupler; the coupler may be longer [m] than the ground, so that the cranks are not parallel."""
    coupler = GROUND + longer
    shop = Workshop()
    ground = shop.link("ground", [((GROUND, 0.02, 0.01), at(x=GROUND / 2, z=-0.05))])
    crank = shop.link("crank", [((CRANK, 0.01, 0.01), at(x=CRANK / 2))])
    bar = shop.link("bar", [((coupler, 0.01, 0.01), at(x=coupler / 2, z=0.02))])
    rocker = shop.link("rocker", [((CRANK, 0.01, 0.01), at(x=CRANK / 2))])
    tilt, swing = angles(DRAWN, coupler)
    joints = (
        Joint("turn", JointKind.REVOLUTE, "ground", "crank", at(rpy=(0, 0, DRAWN)), limit=LIMIT),
        Joint("knuckle", JointKind.CONTINUOUS, "crank", "bar", at(x=CRANK, rpy=(0, 0, tilt - DRAWN))),
        Joint("swing", JointKind.CONTINUOUS, "ground", "rocker", at(x=GROUND, rpy=(0, 0, swing))),
    )
    motor = Actuator("motor", "turn", ActuatorKind.POSITION, kp=1.0)
    robot = Robot(
        "parallelogram", (ground, crank, bar, rocker), joints, actuators=(motor,), meshes=shop.sorted_meshes()
    )
    tip = at(GROUND + CRANK * math.cos(swing), CRANK * math.sin(swing))
    return closure(robot, "pin", JointKind.REVOLUTE, "bar", "rocker", tip, (0.0, 0.0, 1.0))


def angles(crank: float, coupler: float) -> tuple[float, float]:
    """Angles [rad] of coupler and rocker from the ground line: the intersection of two circles, on the open branch."""
    x, y = GROUND - CRANK * math.cos(crank), -CRANK * math.sin(crank)
    diagonal = math.hypot(x, y)
    at_crank = math.acos((coupler**2 + diagonal**2 - CRANK**2) / (2.0 * coupler * diagonal))
    tilt = math.atan2(y, x) + at_crank
    tip = (CRANK * math.cos(crank) + coupler * math.cos(tilt), CRANK * math.sin(crank) + coupler * math.sin(tilt))
    return tilt, math.atan2(tip[1], tip[0] - GROUND)


def test_a_follower_passes_through_the_drawn_pose() -> None:
    """Where zero is elsewhere than the drawn pose, the line has an offset: here crank - 0.1 = rocker - 0.3."""
    robot, drawn = parallelogram(), {"turn": 0.1, "swing": 0.3}
    joints = tuple(
        replace(joint, X_PC=joint.X_PC @ at(rpy=(0, 0, -drawn[joint.name])), drawn_position=drawn[joint.name])
        if joint.name in drawn
        else joint
        for joint in robot.joints
    )
    found = {follower.joint: follower for follower in loop_followers(replace(robot, joints=joints))}
    assert found["swing"].mimic.multiplier == pytest.approx(1.0, abs=1e-6)
    assert found["swing"].mimic.offset == pytest.approx(0.2, abs=1e-6)
    assert found["knuckle"].mimic.offset == pytest.approx(0.1, abs=1e-6)


def test_the_joints_of_a_parallelogram_follow_exactly() -> None:
    """The coupler turns back by the crank's angle, the other crank turns with it."""
    found = {follower.joint: follower for follower in loop_followers(parallelogram())}
    assert list(found) == ["knuckle", "swing"]
    for name, multiplier in (("knuckle", -1.0), ("swing", 1.0)):
        mimic = found[name].mimic
        assert (mimic.joint, mimic.multiplier, mimic.offset) == ("turn", multiplier, 0.0)
        assert found[name].deviation < 1e-9


def test_the_deviation_of_an_imperfect_parallelogram_is_reported() -> None:
    """With a coupler 0.2 mm too long, the deviation from the line is that of the closed form; 10 mm are too much."""
    coupler = GROUND + 2e-4
    followers = {follower.joint: follower for follower in loop_followers(parallelogram(2e-4))}
    q = np.linspace(LIMIT.lower, LIMIT.upper, 2001)
    swing = np.array([angles(DRAWN + x, coupler)[1] - angles(DRAWN, coupler)[1] for x in q])
    mimic = followers["swing"].mimic
    expected = float(np.abs(mimic.multiplier * q + mimic.offset - swing).max())
    assert 1e-6 < expected < ANGLE
    assert followers["swing"].deviation == pytest.approx(expected, rel=0.02)
    assert loop_followers(parallelogram(0.01)) == ()


@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "delta", "stewart"])
def test_joints_that_follow_along_a_curve_are_none(name: str) -> None:
    """Joints of other mechanisms are not linear functions of one driven joint."""
    assert loop_followers(ROBOTS[name]()) == ()


def test_actuated_joints_and_trees_have_no_followers() -> None:
    """A joint with an actuator of its own does not follow; a tree has no loops."""
    robot = parallelogram()
    second = Actuator("second", "swing", ActuatorKind.MOTOR)
    assert [one.joint for one in loop_followers(replace(robot, actuators=(*robot.actuators, second)))] == ["knuckle"]
    assert loop_followers(ROBOTS["two_link_arm"]()) == ()


def with_spindle(robot: Robot) -> Robot:
    """The parallelogram with a tool that turns on the coupler."""
    tool = Workshop().link("tool", [((0.1, 0.01, 0.01), at())])
    turn = Joint("spin", JointKind.REVOLUTE, "bar", "tool", at(x=0.1), limit=LIMIT)
    return replace(robot, links=(*robot.links, tool), joints=(*robot.joints, turn))


def test_followers_of_a_mechanism_with_two_drives() -> None:
    """A tool that turns on the coupler is driven as well: the lines of the others hold while it moves."""
    whole = with_spindle(parallelogram())
    assert {one.joint: one.mimic.multiplier for one in loop_followers(whole)} == {"knuckle": -1.0, "swing": 1.0}


def on_turntable(robot: Robot) -> Robot:
    """The parallelogram on a turntable, the root, whose joint moves both sides of the loop."""
    table = Workshop().link("table", [((0.1, 0.1, 0.01), at(z=-0.1))])
    turn = Joint("table_turn", JointKind.REVOLUTE, "table", "ground", at(), limit=LIMIT)
    return replace(robot, links=(table, *robot.links), joints=(turn, *robot.joints))


@pytest.mark.parametrize("whole", [with_spindle, on_turntable])
def test_joints_outside_of_the_loops_are_not_moved(
    whole: Callable[[Robot], Robot], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only the crank is moved, near the drawn pose and over its range; the paths of all are computed once."""
    walked: list[list[str]] = []
    whole_range = []

    def walk(loops: Loops, start: Array, free: Sequence[int], target: Mapping[str, float]) -> list[Array]:
        walked.append(list(target))
        return closures.walk(loops, start, free, target)

    def loop_ways(robot: Robot) -> tuple[tuple[dict[str, float], ...], ...]:
        whole_range.append(robot.name)
        return closures.loop_ways(robot)

    monkeypatch.setattr("stepbot.robot.loop_followers.walk", walk)
    monkeypatch.setattr("stepbot.robot.loop_followers.loop_ways", loop_ways)
    assert [one.joint for one in loop_followers(whole(parallelogram()))] == ["knuckle", "swing"]
    assert walked == [["turn"]] * 4
    assert whole_range == ["parallelogram"]


@pytest.mark.parametrize("longer", [0.0, 2e-4])
@pytest.mark.parametrize("engine", ["yourdfpy", "pinocchio", "pybullet", "mujoco"])
def test_engines_read_the_urdf_of_a_parallelogram(engine: str, longer: float, tmp_path: Path) -> None:
    """The followers are mimics in the URDF, and engines find the robot in it."""
    folder = write(parallelogram(longer), tmp_path)
    top = etree.parse(folder.written["urdf"].path).getroot()
    mimics = {joint.get("name"): joint.find("mimic").get("joint") for joint in top.findall("joint[mimic]")}
    assert mimics == {"knuckle": "turn", "swing": "turn"}
    asked = folder.request("urdf")
    assert failures(folder.expected("urdf", asked), look(engine, asked)) == set()


def test_the_deviation_is_in_the_note() -> None:
    """SB763:follower names each joint with its line and its deviation."""
    diagnostics = Diagnostics()
    render(parallelogram(), "urdf", diagnostics)
    (note,) = [one for one in diagnostics if one.code == "SB763:follower"]
    assert "'swing' = 1 x 'turn', within 1e-09 rad" in note.message
