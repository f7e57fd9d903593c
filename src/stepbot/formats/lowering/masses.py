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


def massless_links(robot: Robot) -> list[str]:
    """Links without mass, and links without inertia."""
    return [f"'{link.name}'" for link in robot.links if _is_massless(link)]


def with_stand_in_masses(robot: Robot) -> Robot:
    """The robot with a small mass and inertia in place of missing ones."""
    return _with(robot, {link.name for link in robot.links if _is_massless(link)}, STAND_IN_MASS, STAND_IN_MOMENT)


def massless_moving_links(robot: Robot) -> list[str]:
    """The topmost link of each moving body without mass."""
    return [f"'{name}'" for name in massless_bodies(robot)]


def with_least_masses(robot: Robot) -> Robot:
    """The robot with a tiny mass and inertia in place of those of moving bodies that have none."""
    return _with(robot, set(massless_bodies(robot)), LEAST_MASS, LEAST_MOMENT)


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


def _is_massless(link: Link) -> bool:
    return link.mass_properties.mass == 0.0 or link.mass_properties.inertia == ZERO33


def _with(robot: Robot, massless: set[str], mass: float, moment: float) -> Robot:
    inertia = ((moment, 0.0, 0.0), (0.0, moment, 0.0), (0.0, 0.0, moment))

    def weighed(link: Link) -> Link:
        body = link.mass_properties
        return replace(link, mass_properties=MassProperties(body.mass or mass, body.com, inertia))

    return replace(robot, links=tuple(weighed(link) if link.name in massless else link for link in robot.links))
