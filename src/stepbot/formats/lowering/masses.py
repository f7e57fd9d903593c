"""Links without mass, for formats in which a mass of 0 means that the engine computes one."""

from dataclasses import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import ZERO33
from stepbot.robot.model import Link, Robot

STAND_IN_MASS, STAND_IN_MOMENT = 1e-6, 1e-9
"""Mass [kg] and principal moments [kg m^2] for a link that has none: a milligram, with a radius of gyration of 3 cm."""


def massless_links(robot: Robot) -> list[str]:
    """Links without mass, and links without inertia."""
    return [f"'{link.name}'" for link in robot.links if _is_massless(link)]


def with_stand_in_masses(robot: Robot) -> Robot:
    """The robot with a small mass and inertia in place of missing ones."""
    return replace(robot, links=tuple(_with_stand_in(link) if _is_massless(link) else link for link in robot.links))


def _is_massless(link: Link) -> bool:
    return link.mass_properties.mass == 0.0 or link.mass_properties.inertia == ZERO33


def _with_stand_in(link: Link) -> Link:
    body, I = link.mass_properties, STAND_IN_MOMENT  # noqa: E741 - the field's letter
    inertia = ((I, 0.0, 0.0), (0.0, I, 0.0), (0.0, 0.0, I))
    return replace(link, mass_properties=MassProperties(body.mass or STAND_IN_MASS, body.com, inertia))
