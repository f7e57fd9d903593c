"""What a robot can do is found in its model, and each test that does not apply has a reason."""

import pytest
from msgspec.structs import replace

from stepbot.driving.grasping import Grasp
from stepbot.driving.mechanism import finger_candidates, jaw_candidates, limbs_of, mechanism_of, wheels_of
from stepbot.driving.plan import TESTS, reasons, ungripped
from stepbot.driving.survey import Survey
from stepbot.engines.simulation import Cube
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Actuator, ActuatorKind, Base, Joint, JointKind, Limit, Link, Robot
from tests.robots import ROBOTS
from tests.unit.driving.workbench import VERTICAL, body, clamp, gripper, looped_gripper, one_joint

NOTHING = Survey((), (), (), 1.0, (), {})


def cart(base: Base) -> Robot:
    """Two driven wheels whose axes point to opposite sides, and a driven caster with a vertical axis."""
    links, joints, actuators = [Link("cart", body(5.0))], [], []
    for name, turn in (("left", -1.5707963267948966), ("right", 1.5707963267948966), ("caster", 0.0)):
        links.append(Link(f"{name}_wheel", body(0.3)))
        X = Pose.from_xyz_rpy((0.0, 0.1, 0.05), (turn, 0.0, 0.0))
        joints.append(Joint(name, JointKind.CONTINUOUS, "cart", f"{name}_wheel", X, VERTICAL, limit=Limit(effort=2.0)))
        actuators.append(Actuator(f"{name}_motor", name, ActuatorKind.VELOCITY, kv=1.0))
    return Robot("cart", tuple(links), tuple(joints), actuators=tuple(actuators), base=base)


def test_wheels_have_horizontal_axles_and_drive_the_same_way() -> None:
    """Wheels turn forwards with opposite signs if their axes point to opposite sides; casters are no wheels."""
    wheels = wheels_of(mechanism_of(cart(Base.FLOATING), ()))
    assert wheels is not None
    assert {wheel.link: wheel.forwards for wheel in wheels.wheels} == {"left_wheel": 1.0, "right_wheel": -1.0}
    assert wheels.direction == pytest.approx((1.0, 0.0, 0.0))
    assert wheels_of(mechanism_of(cart(Base.FIXED), ())) is None


def test_fingers_are_moved_by_one_motor() -> None:
    """A finger and its mimic are a pair; the links of an arm are not."""
    (fingers,) = finger_candidates(mechanism_of(gripper(10.0), ()))
    assert {fingers.one, fingers.other} == {frozenset({"left"}), frozenset({"right"})}
    assert finger_candidates(mechanism_of(ROBOTS["two_link_arm"](), ())) == ()


def test_jaws_of_a_linkage_are_fingers() -> None:
    """Two jaws on one guide that a crank moves by rods are a pair; its rods, on different jaws, are none."""
    (fingers,) = finger_candidates(mechanism_of(looped_gripper(1.0), ()))
    assert {fingers.one, fingers.other} == {frozenset({"right_jaw"}), frozenset({"left_jaw"})}
    assert (fingers.motors, fingers.hand) == (("motor",), "rail")
    four_bar = ROBOTS["four_bar"]()
    assert finger_candidates(mechanism_of(four_bar, ())) == ()


def test_the_reason_for_no_grip_says_what_was_searched() -> None:
    """In a robot with loops not every pair of links is tried."""
    robot = ROBOTS["four_bar"]()
    why = reasons(mechanism_of(robot, ()), NOTHING, None, (), mjcf=True)["grip"]
    assert why.startswith("no two links moved by a mimic, or through loops on one link, that a motor closes")
    assert "no link outside of loops" in why
    assert "loops" not in reasons(mechanism_of(one_joint(VERTICAL), ()), NOTHING, None, (), mjcf=True)["grip"]


def test_limbs_have_two_motors_each() -> None:
    """A biped has two limbs if it floats, none on a fixed base."""
    biped = ROBOTS["floating_biped"]()
    driven = tuple(
        Actuator(f"{joint.name}_drive", joint.name, ActuatorKind.POSITION, kp=1.0)
        for joint in biped.joints
        if joint.kind is JointKind.REVOLUTE
    )
    biped = replace(biped, actuators=driven)
    mechanism = mechanism_of(biped, ())
    count = dict.fromkeys(limbs_of(mechanism), 0)
    assert len(count) in (0, 2)
    assert limbs_of(mechanism_of(replace(biped, base=Base.FIXED), ())) == ()


def test_every_test_that_does_not_apply_has_a_reason() -> None:
    """A joint without an actuator can only be dropped."""
    why = reasons(mechanism_of(one_joint(VERTICAL), ()), NOTHING, None, (), mjcf=True)
    assert why.keys() == TESTS.keys()
    assert [test for test, reason in why.items() if not reason] == ["drop"]


def test_fingers_that_grip_nothing_are_named_with_the_reason() -> None:
    """A robot without fingers has a general reason, one whose fingers cannot grip has that of each pair."""
    limp = reasons(mechanism_of(one_joint(VERTICAL), ()), NOTHING, None, (), mjcf=True)
    assert {test for test, why in limp.items() if why == "the robot has no actuators"} == {*TESTS} - {"drop"}
    mechanism = mechanism_of(one_joint(VERTICAL, 10.0), ())
    assert "no two links" in reasons(mechanism, NOTHING, None, (), mjcf=True)["grip"]
    surveyed = replace(NOTHING, misses={"thumb": "too short", "index": "not opposite", "ring": "too short"})
    assert reasons(mechanism, surveyed, None, (), mjcf=True)["grip"] == "thumb, ring: too short; index: not opposite"


def test_grippers_without_a_grip_are_named_beside_those_that_grip() -> None:
    """The reason of a gripper is not lost if another one grips; that of another pair of links of the same motor is."""
    (jaw,) = jaw_candidates(mechanism_of(clamp(1.0), ()), ())
    grasp = Grasp(jaw, Cube(0.02, 0.2), Pose(), {}, 0.0, (0.0, 0.05))
    misses = {"motor": "not opposite", "other_motor": "too short"}
    assert ungripped(replace(NOTHING, grasps=(grasp,), misses=misses)) == {"grip of other_motor": "too short"}
    assert ungripped(replace(NOTHING, misses=misses)) == {}


def test_jaws_are_at_the_end_of_the_tree() -> None:
    """A jaw is a candidate with the hand that carries it; fingers, and links that turn further, are not."""
    mechanism = mechanism_of(clamp(1.0), ())
    (jaw,) = jaw_candidates(mechanism, finger_candidates(mechanism))
    assert (jaw.one, jaw.other) == (frozenset({"jaw"}), frozenset({"base", "hand"}))
    assert (jaw.hand, jaw.fixed, jaw.motors) == ("hand", True, ("motor",))
    for robot in (gripper(10.0), one_joint(VERTICAL, 100.0, 10.0)):
        mechanism = mechanism_of(robot, ())
        assert jaw_candidates(mechanism, finger_candidates(mechanism)) == ()
