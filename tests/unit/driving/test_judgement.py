"""Verdicts on the numbers of drive tests, and the remedies of failed ones."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.driving.judgement import Status, judge
from stepbot.driving.limits import demands
from stepbot.driving.remedies import Facts, facts_of
from stepbot.driving.results import Grip, Loss, Measure, Plot, Result, Spin
from stepbot.engines.simulation import Cube
from stepbot.geometry.spatial import IDENTITY
from stepbot.robot.model import JointDynamics
from tests.unit.driving.workbench import clamp, gripper, stage_of


def test_the_remedy_of_an_open_loop_is_one_that_the_sidecar_allows() -> None:
    """Closures have the largest stiffness by default; a shorter time step makes them stiffer."""
    diagnostics = Diagnostics()
    result = Result("hold", (Measure("loop opening", 0.9, "pin"),), Plot("t", "mm", {}))
    (verdict,) = judge("mujoco", "arm.xml", [result], demands({}), diagnostics)
    assert verdict.status is Status.FAILED
    (one,) = diagnostics
    assert one.code == "SB830"
    assert "`simulation: {timestep:" in one.help[0]


def test_the_remedy_of_computed_gains_is_not_to_compute_them() -> None:
    """A joint with `gains: auto` needs the inertia of its motor's rotor, or, where that is stated, other figures."""
    result = Result("step", (Measure("overshoot", 24.0, "jaw"),), Plot("t", "%", {}))
    helps = []
    for facts in (Facts(), Facts(computed=frozenset({"jaw"}), light=frozenset({"jaw"})), Facts(frozenset({"jaw"}))):
        diagnostics = Diagnostics()
        tuple(judge("mujoco", "arm.xml", [result], demands({}), diagnostics, facts))
        helps.append(next(iter(diagnostics)).help[0])
    assert ["`gains: auto`" in one for one in helps] == [True, False, False]
    assert ["armature" in one for one in helps] == [False, True, False]


@pytest.mark.parametrize(
    ("spin", "engine", "why", "remedy"),
    [
        (Spin("left", 0.011, 8e-5, 0.001), "mujoco", "turned 1 % of what was asked for: its kv of 8e", "gains: auto"),
        (Spin("left", 0.4, 0.02, 1.0), "mujoco", "turned 40 % of what was asked for, at its effort limit", "raise the"),
        (Spin("left", 0.4, 0.0, None), "pybullet", "wheel of 'left' turned 40 % of what was asked for", "brakes on"),
        (
            Spin("left", 0.4, 0.02, 1.0, ("base", "tail")),
            "mujoco",
            "; 'base' and 'tail' touch the floor as well",
            "raise the",
        ),
        (
            Spin("left", 0.99, 0.02, 0.3, ("base",)),
            "mujoco",
            "the floor; 'base' touches the floor as well",
            "only wheels",
        ),
        (Spin("left", 0.99, 0.02, 0.3), "mujoco", "the wheels turned as asked for, and slipped", "only wheels and"),
    ],
)
def test_a_base_that_stays_behind_says_what_its_wheels_did(spin: Spin, engine: str, why: str, remedy: str) -> None:
    """A weak motor, one at its limit, and wheels that slip have different remedies; other numbers keep their own."""
    diagnostics = Diagnostics()
    measures = (Measure("distance error", 60.0), Measure("tilt", 60.0))
    list(
        judge(engine, "base.xml", [Result("roll", measures, Plot("t", "mm", {}), spin=spin)], demands({}), diagnostics)
    )
    way, tilted = diagnostics
    assert why in way.notes[0]
    assert remedy in way.help[0]
    assert len(tilted.notes) == 1


@pytest.mark.mujoco
def test_links_that_overlap_at_the_start_are_the_likely_cause(tmp_path: Path) -> None:
    """The first failure in MuJoCo names them, with their depth, and how to exclude their contacts."""
    robot = gripper(20.0)
    assert not stage_of(robot, "mujoco", tmp_path).survey.overlaps
    joints = tuple(replace(joint, X_PC=IDENTITY) for joint in robot.joints)
    overlaps = stage_of(replace(robot, joints=joints), "mujoco", tmp_path).survey.overlaps
    assert overlaps == {("left", "right"): pytest.approx(0.01, abs=1e-6)}
    measures = (Measure("angle error", 60.0, "left"), Measure("angle drift", 60.0, "left"))
    result = Result("hold", measures, Plot("t", "mm", {}))
    for engine, named in (("mujoco", [True, False]), ("pybullet", [False, False])):
        diagnostics = Diagnostics()
        list(judge(engine, "r.xml", [result], demands({}), diagnostics, Facts(overlaps=overlaps)))
        assert ["'left' and 'right' by 10 mm" in one.notes[0] for one in diagnostics] == named
        assert ["`excluded_contacts: [[left, right]]`" in one.help[0] for one in diagnostics] == named


SLIPPED = Grip("close", frozenset({"jaw", "hand"}), Cube(0.011, 0.2), (0.003, 0.13), 23.0, 0.04, Loss.SLIPPED, 0.49)


def judged(grip: Grip, facts: Facts, engine: str = "mujoco") -> Diagnostic:
    """The diagnostic on one gripper."""
    diagnostics = Diagnostics()
    measures = (Measure("slip", grip.slip, grip.joint), Measure("penetration", 0.2, grip.joint))
    (verdict,) = judge(
        engine, "arm.xml", [Result("grip", measures, Plot("t", "mm", {}), (grip,))], demands({}), diagnostics, facts
    )
    assert verdict.status is Status.FAILED
    (one,) = diagnostics
    assert bool(verdict.why) == (grip.loss is not None)
    assert verdict.why in one.message
    return one


@pytest.mark.parametrize(
    ("loss", "message"),
    [
        (Loss.SLIPPED, "the cube of 11 mm slipped out of the grip of 'close' and fell, 0.49 s after it got its weight"),
        (Loss.FREE, "the cube of 11 mm fell freely as it got its weight: 'close' did not hold it"),
        (Loss.PUSHED, "the cube of 11 mm was pushed out of the grip of 'close' before it got its weight"),
        (None, "slip of 'close, cube of 11 mm' is 23 mm, limit 2 mm"),
    ],
)
def test_a_lost_cube_is_no_slip(loss: Loss | None, message: str) -> None:
    """A cube that fell has no slip to compare with a limit: the message says how and when it was lost."""
    one = judged(replace(SLIPPED, loss=loss), Facts())
    assert one.message == f"grip in mujoco: {message}"
    assert one.notes == (
        ("the limit: an object that slips by 2 mm in 5 s is lost in a minute",) if loss is None else ()
    )
    assert ("direction and the limits" in one.help[0]) == (loss is Loss.FREE)


def test_jaws_that_stay_apart_need_other_limits() -> None:
    """Where the gap stays wider than the cube, no gain helps, and the message has both ends of the gap."""
    apart = replace(SLIPPED, loss=Loss.FREE, gaps=(0.0377, 0.052))
    assert judged(apart, Facts(computed=frozenset({"close"}))).help == (
        "check the direction and the limits of the joint: the gap closes from 52 to 38 mm",
    )
    assert len(judged(replace(apart, gaps=(0.003, 0.052)), Facts()).help) == 2


def test_remedies_of_a_grip_are_possible() -> None:
    """Computed gains cannot be raised beside `gains: auto`, and jaws that have `collision: auto` need no other."""
    computed = judged(SLIPPED, Facts(computed=frozenset({"close"}), light=frozenset({"close"})))
    assert "4 % of its effort limit" in computed.help[0]
    assert "armature" in computed.help[1]
    assert computed.help[2] == "`gains: auto` sets kp: write `kp` and `kv` in its place"
    given = judged(SLIPPED, Facts(filled=frozenset({"jaw", "foot"})))
    assert len(given.help) == 2
    assert given.help[0].startswith("raise kp")
    assert given.help[1] == "give hollow jaws `collision: auto`: jaw"
    assert judged(replace(SLIPPED, effort=0.98), Facts()).help == (
        "raise the effort limit of the joint: the motor presses with all of it",
    )
    assert "kp" not in "".join(judged(SLIPPED, Facts(computed=frozenset({"close"})), "pybullet").help)


def test_facts_of_a_report() -> None:
    """Computed gains, shapes that may fill hollows, and motors without the inertia of their rotor."""
    robot = clamp(1.0)
    document = {
        "robot": {"actuators": [{"joint": "close", "computed": {"bandwidth": 5.0}}]},
        "collision_shapes": [{"link": "jaw", "rule": "hull"}, {"link": "hand", "rule": "auto"}],
    }
    assert facts_of(document, robot) == Facts(frozenset({"close"}), frozenset({"jaw"}), frozenset())
    joints = tuple(replace(joint, dynamics=JointDynamics()) for joint in robot.joints)
    assert facts_of(document, replace(robot, joints=joints)).light == frozenset({"close"})
