"""Checks the ``inertial`` of links against their geometry: what is given must be possible for a mass within it."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.inertia_bounds import (
    DENSEST,
    OUTSIDE_SLACK,
    SpreadExcess,
    largest_moments,
    outside_by,
    smallest_trace,
    spread_excess,
)
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.kinematics import rigid_bodies
from stepbot.robot.model import Joint, Link
from stepbot.robot.validity import inertia_fault

from .binder import Binder
from .claims import Claims

_UNDRAWN = "if the maker publishes this value, or the CAD omits a heavy part, ignore it with the reason: "
_MOMENTS = ("ixx", "iyy", "izz")


def report_given_inertials(
    binder: Binder, claims: Claims, links: Sequence[Link], joints: Sequence[Joint], X_WL: Mapping[str, Pose]
) -> None:
    """Warn about each given com and inertia that no mass within the link's geometry has.

    The geometry is that of all solids and surfaces of the link and of the links fixed to it: descriptions often draw
    on one link what they weigh on another. Links without geometry are not checked.
    """
    body_of = rigid_bodies(links[0].name, joints)
    for link in links:
        section = binder.document.links[link.name].inertial
        if section is None or (section.com is None and section.inertia is None):
            continue
        if inertia_fault(link.mass_properties) or not link.mass_properties.mass:
            continue  # an error of its own
        members = [name for name in binder.document.links if body_of[name] == body_of[link.name]]
        points = _points(binder, claims, members, X_WL[link.name].inverse())
        _check(binder, link.name, link.mass_properties, points)


def _check(binder: Binder, name: str, properties: MassProperties, points: Array) -> None:
    trace, smallest = float(np.trace(np.array(properties.inertia))), smallest_trace(properties.mass)
    if trace < smallest:
        _report(
            binder,
            "SB520",
            name,
            f"ixx + iyy + izz = {trace:.3g} kg m^2; a ball of osmium ({DENSEST:g} kg/m^3) of its {properties.mass:.4g} "
            f"kg has {smallest:.3g}",
            "check the unit: 1 kg mm^2 is 1e-6 kg m^2",
        )
    if not len(points):
        return
    outside = outside_by(points, properties.com)
    if outside > OUTSIDE_SLACK * float(np.linalg.norm(np.ptp(points, axis=0))):
        com = ", ".join(f"{1e3 * c:.1f}" for c in properties.com)
        message = f"com ({com}) mm is {1e3 * outside:.1f} mm outside its geometry, {_extent(points)}"
        _report(binder, "SB519", name, message, "give the com in the link's frame")
    excess = spread_excess(points, properties)
    if excess is not None:
        remedy = "give the inertia about the com, along the link's axes, in kg m^2; without `inertia` it is computed"
        _report(binder, "SB518", name, _excess_text(properties, points, excess), remedy)


def _excess_text(properties: MassProperties, points: Array, excess: SpreadExcess) -> str:
    """The moment of inertia that exceeds its bound most; if none does, the direction of the spread that does."""
    moments, largest = np.diag(np.array(properties.inertia)), np.array(largest_moments(points, properties))
    worst = int(np.argmax(moments - largest))
    if moments[worst] > largest[worst]:
        return (
            f"{_MOMENTS[worst]} = {moments[worst]:.3g} kg m^2, but {properties.mass:.4g} kg with this com have at most "
            f"{largest[worst]:.3g} within the geometry, {_extent(points)}"
        )
    direction = ", ".join(f"{c + 0.0:.2f}" for c in np.round(excess.direction, 2))
    return (
        f"the inertia spreads the mass by {1e3 * excess.given:.1f} mm (root mean square) along ({direction}), the "
        f"geometry, {_extent(points)}, by at most {1e3 * excess.largest:.1f} mm"
    )


def _extent(points: Array) -> str:
    low, high = 1e3 * points.min(axis=0), 1e3 * points.max(axis=0)
    ranges = (f"{axis} {a:.0f} to {b:.0f}" for axis, a, b in zip("xyz", low + 0.0, high + 0.0, strict=True))
    return ", ".join(ranges) + " mm"


def _report(binder: Binder, code: str, name: str, message: str, remedy: str) -> None:
    ignored = f"{_UNDRAWN}`ignore_findings: [{{code: {code}, reason: ...}}]`"
    binder.report(code, ("links", name, "inertial"), message, help=(remedy, ignored))


def _points(binder: Binder, claims: Claims, links: Iterable[str], X_LW: Pose) -> Array:
    """Vertices (n, 3) [m] of all bodies of links, in the frame L."""
    assembly = binder.assembly
    found = [np.zeros((0, 3))]
    for index in (index for link in links for index in claims.parts_of(link)):
        component = assembly.components[index]
        if component.body >= 0:
            found.append((X_LW @ component.X_WC).apply(assembly.bodies[component.body].mesh.vertices))
    return np.concatenate(found)
