"""Strafe: a base on mecanum wheels drives to the left and back.

A roller on the floor does not slip along its axis e: v . e = w R (f . e) for the base's velocity v, the wheel's speed w
and radius R, and the direction f in which the wheel drives the base.
"""

from collections.abc import Mapping

import numpy as np

from stepbot.engines.simulation import Simulation

from ..mechanism import Wheels
from ..results import Result
from ..stage import Stage
from .roll import drive


def experiment(stage: Stage) -> Result:
    """Drive to the left and back at constant speed."""
    assert stage.wheels is not None
    left = np.cross((0.0, 0.0, 1.0), stage.wheels.direction)
    direction = (float(left[0]), float(left[1]), float(left[2]))
    robot = stage.mechanism.robot

    def spins(simulation: Simulation, wheels: Wheels) -> Mapping[str, float]:
        # Speed of each wheel's motor per speed of the base over the radius, from the roller nearest to the floor.
        found = {}
        for wheel, rollers in zip(wheels.wheels, wheels.rollers, strict=True):
            joints = [robot.joint_by_name[name] for name in rollers]
            lowest = min(joints, key=lambda joint: simulation.pose(joint.child).position[2])
            axis = simulation.pose(lowest.child).turn(lowest.axis)
            found[wheel.motor] = wheel.forwards * float(axis @ direction) / float(axis @ wheels.direction)
        return found

    return drive(stage, "strafe", direction, spins)
