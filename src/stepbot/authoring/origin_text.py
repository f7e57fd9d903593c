"""The frames of drafted joints, formatted for the sidecar."""

from math import atan2, hypot

from stepbot.geometry.spatial import ZERO3, Vector3
from stepbot.step.structure.paths import quoted

from .draft import OriginForm, OriginSnippet
from .yaml_lines import angles, flow, lengths, listed, millimetres


def origin_text(origin: OriginSnippet) -> str:
    """The value of ``origin:``."""
    if origin.form is OriginForm.XYZ:
        return _numbers(origin.xyz, origin.rpy)
    entries = [
        ("mate", listed(origin.paths)) if origin.form is OriginForm.MATE else ("axis_of", quoted(origin.paths[0]))
    ]
    if origin.radius is not None:
        entries.append(("radius", millimetres(origin.radius)))
    if origin.near is not None:
        entries.append(("near", lengths(origin.near)))
    return flow(entries)


def alternative_origin(point: Vector3, direction: Vector3 | None) -> str:
    """A numeric frame with z along ``direction``."""
    return _numbers(point, ZERO3 if direction is None else z_along(direction))


def z_along(direction: Vector3) -> Vector3:
    """Roll, pitch and yaw [rad] of a frame whose z axis is a unit direction."""
    x, y, z = direction
    return (0.0, atan2(hypot(x, y), z), atan2(y, x) if x or y else 0.0)


def _numbers(xyz: Vector3, rpy: Vector3) -> str:
    entries = [("xyz", lengths(xyz))]
    if any(rpy):
        entries.append(("rpy", angles(rpy)))
    return flow(entries)
