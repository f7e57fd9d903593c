"""Links without mass, for formats in which a mass of 0 means that the engine computes one, or is an error."""

from msgspec.structs import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import ZERO33
from stepbot.robot.kinematics import rigid_bodies
from stepbot.robot.model import Base, JointKind, Link, Robot

STAND_IN_MASS, STAND_IN_MOMENT = 1e-6, 1e-9
"""Mass [kg] and principal moments [kg m^2] for a link that has none: a milligram, with a radius of gyration of 3 cm."""

LEAST_MASS, LEAST_MOMENT = 2e-15, 1e-14
"""The same for a moving link without mass: above the least that MuJoCo accepts, and without effect on the motion."""


def is_massless(link: Link) -> bool:
    """Whether a link has no mass, or no inertia."""
    return link.mass_properties.mass == 0.0 or link.mass_properties.inertia == ZERO33


def with_stand_in(link: Link) -> Link:
    """The link with a small mass and inertia in place of missing ones."""
    return _weighed(link, STAND_IN_MASS, STAND_IN_MOMENT)


def with_least_masses(robot: Robot) -> Robot:
    """The robot with a tiny mass and inertia in place of those of moving bodies that have none."""
    light = massless_bodies(robot)
    links = (_weighed(link, LEAST_MASS, LEAST_MOMENT) if link.name in light else link for link in robot.links)
    return replace(robot, links=tuple(links))


def massless_bodies(robot: Robot) -> list[str]:
    """Names of the topmost link of each moving body without mass."""
    rigid = rigid_bodies(robot.root.name, robot.joints)
    heavy = {rigid[link.name] for link in robot.links if link.mass_properties.mass > 0.0}
    held = {robot.root.name} if robot.base is Base.FIXED else set()
    return [body for body in dict.fromkeys(rigid.values()) if body not in heavy | held]


def massless_fixed(robot: Robot) -> list[str]:
    """Names of links without mass that a fixed joint holds at another one without mass."""
    massless = {link.name for link in robot.links if not link.mass_properties.mass}
    fixed = (joint for joint in robot.joints if joint.kind is JointKind.FIXED)
    return [joint.child for joint in fixed if {joint.parent, joint.child} <= massless]


def _weighed(link: Link, mass: float, moment: float) -> Link:
    body, inertia = link.mass_properties, ((moment, 0.0, 0.0), (0.0, moment, 0.0), (0.0, 0.0, moment))
    return replace(link, mass_properties=MassProperties(body.mass or mass, body.com, inertia))
