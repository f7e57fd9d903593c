"""The largest speeds of joints: which are the motor's doing."""

from typing import Any, cast

import pytest
from msgspec import Struct
from msgspec.structs import replace

from stepbot.driving.stage import Speeds
from stepbot.engines.simulation import Motor, Simulation
from stepbot.robot.model import ActuatorKind, JointDynamics, Limit
from tests.unit.driving.workbench import one_joint

MOTOR = Motor("drive", "turn", ActuatorKind.POSITION, 100.0, 1.0, 1.0, Limit(-4.0, 4.0, 10.0, 2.0), angular=True)


class Turning(Struct):
    """A joint at some speed [rad/s], and the effort [N m] of its motor."""

    speed: float
    given: float

    def speeds(self) -> dict[str, float]:
        """Of the joint."""
        return {"turn": self.speed}

    def effort(self, _: str) -> float:
        """Of the motor."""
        return self.given


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("speed", "effort", "quantity"),
    [
        (12.0, 10.0, "speed of limit with other gains"),
        (12.0, 6.4, "pushed speed of limit"),  # 0.5 N m s/rad and 0.5 N m take 6.5 N m
        (12.0, -1.0, "pushed speed of limit"),
        (2.0, -1.0, "speed of limit with other gains"),
    ],
)
def test_a_motor_that_gives_less_than_the_joint_takes_does_not_drive_it(
    sign: float, speed: float, effort: float, quantity: str
) -> None:
    """Beyond its limit, what its own damping and friction would slow down is pushed."""
    robot = one_joint((0.0, 0.0, 1.0))
    (joint,) = robot.joints
    robot = replace(robot, joints=(replace(joint, dynamics=JointDynamics(damping=0.5, friction=0.5)),))
    speeds, simulation = Speeds(robot), cast(Simulation, cast(Any, Turning(sign * speed, sign * effort)))
    assert speeds.measure(simulation, MOTOR) == sign * speed
    (measure,) = speeds.measures()
    assert (measure.quantity, measure.value) == (quantity, 10.0 * speed)
