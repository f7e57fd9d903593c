"""Checks the ``inertial`` of links against their geometry: what is given must be possible for a mass within it."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from stepbot.geometry.spatial import Array, Pose
from stepbot.geometry.sums import exact_sum
from stepbot.robot.inertial_doubts import Doubt, density_doubt, inertial_doubts
from stepbot.robot.kinematics import rigid_bodies
from stepbot.robot.model import Joint, Link
from stepbot.robot.validity import inertia_fault

from .binder import Binder
from .claims import Claims

_UNDRAWN = "if the maker publishes this value, or the CAD omits a heavy part, ignore it with the reason: "


def report_given_inertials(
    binder: Binder, claims: Claims, links: Sequence[Link], joints: Sequence[Joint], X_WL: Mapping[str, Pose]
) -> None:
    """Warn about each given mass, com and inertia that nothing within the link's geometry has.

    The geometry is that of all solids and surfaces of the link and of the links fixed to it: descriptions often draw
    on one link what they weigh on another. Links without geometry are not checked.
    """
    body_of = rigid_bodies(links[0].name, joints)
    for link in links:
        section = binder.document.links[link.name].inertial
        if section is None:
            continue
        members = [name for name in binder.document.links if body_of[name] == body_of[link.name]]
        heavy = density_doubt(section.mass, _volume(binder, claims, members))
        if heavy is not None:
            _report(binder, link.name, heavy, "mass")
        if section.com is None and section.inertia is None:
            continue
        if inertia_fault(link.mass_properties) or not link.mass_properties.mass:
            continue  # an error of its own
        points = _points(binder, claims, members, X_WL[link.name].inverse())
        for doubt in inertial_doubts(link.mass_properties, points):
            _report(binder, link.name, doubt)


def _report(binder: Binder, link: str, doubt: Doubt, *key: str) -> None:
    ignored = f"{_UNDRAWN}`ignore_findings: [{{code: {doubt.code}, reason: ...}}]`"
    help = tuple(filter(None, (doubt.remedy, ignored)))
    binder.report(doubt.code, ("links", link, "inertial", *key), doubt.message, help=help)


def _volume(binder: Binder, claims: Claims, links: Iterable[str]) -> float:
    """Volume [m^3] of all solids of links; 0 with other bodies, whose thickness is unknown."""
    components, bodies = binder.assembly.components, binder.assembly.bodies
    drawn = [components[index].body for link in links for index in claims.parts_of(link)]
    exact = [bodies[body].exact for body in drawn if body >= 0]
    volumes = [one.volume for one in exact if one is not None]
    return exact_sum(volumes) if len(volumes) == len(exact) else 0.0


def _points(binder: Binder, claims: Claims, links: Iterable[str], X_LW: Pose) -> Array:
    """Vertices (n, 3) [m] of all bodies of links, in the frame L."""
    assembly = binder.assembly
    found = [np.zeros((0, 3))]
    for index in (index for link in links for index in claims.parts_of(link)):
        component = assembly.components[index]
        if component.body >= 0:
            found.append((X_LW @ component.X_WC).apply(assembly.bodies[component.body].mesh.vertices))
    return np.concatenate(found)
