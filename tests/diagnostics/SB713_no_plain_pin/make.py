"""A loop closed by a piston, with damping in every other joint."""

from dataclasses import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.robot.model import JointDynamics
from tests import closed_mechanisms


def find(found: Diagnostics) -> None:
    """Ask the library."""
    robot = closed_mechanisms.sliding_closure()
    joints = tuple(replace(joint, dynamics=JointDynamics(damping=1.0)) for joint in robot.joints)
    lower(replace(robot, joints=joints), FORMATS["mjcf"], found)
