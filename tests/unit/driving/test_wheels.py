"""Wheeled bases turn by where their wheels touch the floor, and say why they cannot turn without slipping."""

from math import pi
from pathlib import Path

import pytest

from stepbot.driving.mechanism import mechanism_of, wheels_of
from stepbot.driving.plan import reasons
from stepbot.driving.remedies import spin_words
from stepbot.driving.results import Spin
from stepbot.driving.survey import Survey
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Base,
    Collision,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    Robot,
    Sphere,
)
from stepbot.robot.surfaces import Surface
from tests.unit.driving.test_closed_forms import run, value
from tests.unit.driving.workbench import ENGINES, VERTICAL, body, stage_of

RADIUS, HALF = 0.033, 0.0864
TURNED = (-0.5 * pi, 0.0, 0.0)
"""Axles along y."""


def rover(*axles: float, face: float = 0.0, caster: float | None = None) -> Robot:
    """Driven wheels at both ends of axles, and a support without friction in front, or a wheel on a fixed axle there.

    Args:
        axles: Places [m] of the axles along the base.
        face: Distance [m] from the frame of each wheel outwards to the middle of its tread.
        caster: Distance [m] of a passive wheel in front of the first axle; None for none.
    """
    front = Collision("front", Sphere(0.01), Pose.of(position=(0.12, 0.0, 0.01 - RADIUS)), Surface(friction=0.0))
    links = [Link("base", body(0.3, (0.03, 0.0, 0.0)), collisions=(front,) if caster is None else ())]
    joints, motors = [], []
    for n, x in enumerate(axles):
        for name, side in ((f"left{n}", 1.0), (f"right{n}", -1.0)):
            tread = Collision(f"{name}_tread", Sphere(RADIUS), Pose.of(position=(0.0, 0.0, side * face)))
            links.append(Link(name, body(0.05, (0.0, 0.0, side * face), 3e-5), collisions=(tread,)))
            X = Pose.from_xyz_rpy((x, side * (HALF - face), 0.0), TURNED)
            limit = Limit(velocity=17.0, effort=0.2)
            dynamics = JointDynamics(armature=1e-4)
            joints.append(Joint(name, JointKind.CONTINUOUS, "base", name, X, VERTICAL, limit=limit, dynamics=dynamics))
            motors.append(Actuator(f"{name}_motor", name, ActuatorKind.VELOCITY, kv=0.05))
    if caster is not None:
        links.append(Link("trailer", body(0.02, inertia=1e-6), collisions=(Collision("trailer", Sphere(RADIUS)),)))
        X = Pose.from_xyz_rpy((axles[0] + caster, 0.0, 0.0), TURNED)
        joints.append(Joint("trailing", JointKind.CONTINUOUS, "base", "trailer", X, VERTICAL))
    return Robot("rover", tuple(links), tuple(joints), actuators=tuple(motors), base=Base.FLOATING)


@pytest.mark.mujoco
@pytest.mark.pybullet
@pytest.mark.parametrize("engine", ENGINES)
def test_a_base_turns_by_the_middle_of_its_treads_not_by_the_frames_of_its_wheels(engine: str, tmp_path: Path) -> None:
    """Frames at the faces of the motors, 8.7 mm inside of the treads, would make the turn a tenth too small."""
    result = run("turn", stage_of(rover(0.0, face=0.0087), engine, tmp_path))
    assert value(result, "turn error") < 0.5
    assert value(result, "displacement") < 2.0


def test_wheels_on_two_axles_have_the_reason_why_they_do_not_turn_on_the_spot() -> None:
    """The reason names the wheels and how far apart their axles are; wheels on one axle have none."""
    for axles, expected in (((0.0,), ""), ((-0.07, 0.07), "'left0', 'right0', 'left1', 'right1' are up to 140 mm")):
        mechanism = mechanism_of(rover(*axles), ())
        why = reasons(mechanism, Survey((), (), (), 1.0, (), {}), wheels_of(mechanism), (), mjcf=True)
        assert expected in why["turn"]
        assert bool(expected) == bool(why["turn"])
        assert not why["roll"]


def test_a_wheel_that_does_not_swivel_is_named_where_it_has_to_slip() -> None:
    """One in front of the driven axle is; one on the same line, which rolls in a turn, is not."""
    ahead, beside = (wheels_of(mechanism_of(rover(0.0, caster=x), ())) for x in (0.1, 0.0))
    assert ahead is not None
    assert beside is not None
    assert (ahead.dragged, beside.dragged) == (frozenset({"trailer"}), frozenset())


@pytest.mark.parametrize(("share", "first"), [(0.86, "the wheel of 'left0' turned 86 %"), (0.99, "the wheels turned")])
def test_the_remedy_of_a_dragged_wheel_is_to_let_it_swivel(share: float, first: str) -> None:
    """Also where the motors are at their limits because of it: stronger motors would drag it faster."""
    why, remedy = spin_words(Spin("left0", share, 0.9, 1.0, ("trailer",), ("trailer",)), gains=True)
    assert why.startswith(first)
    assert why.endswith("'trailer' rolls on an axle that does not swivel, and slipped sideways")
    assert "vertical axis" in remedy
