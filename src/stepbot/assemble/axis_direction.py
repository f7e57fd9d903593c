"""Axes that do not follow the line that their origin was found on."""

from collections.abc import Mapping
from math import atan2, degrees, hypot

from stepbot.robot.model import JointKind
from stepbot.sidecar.document import ClosureSection, JointSection
from stepbot.sidecar.origins import AutoOrigin, AxisOrigin, MateOrigin, Origin

from .binder import Binder
from .frames import Frames

_TURNING = {JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.CYLINDRICAL, JointKind.SCREW}
_LEAST = degrees(1e-3)
"""Angle [degrees] from which an axis does not follow its line."""


def report_axes_off_their_lines(binder: Binder, frames: Frames) -> None:
    """Report SB422: the frame on a line has z along it, so that any other axis is across the faces that were found."""
    document = binder.document
    groups: Mapping[str, Mapping[str, JointSection | ClosureSection]]
    groups = {"joints": document.joints, "closures": document.closures}
    for group, sections in groups.items():
        for name, section in sections.items():
            if section.type not in _TURNING or not _is_on_line(section.origin):
                continue
            x, y, z = section.axis
            angle = degrees(atan2(hypot(x, y), abs(z)))
            if angle < _LEAST:
                continue
            evidence = frames.evidence(group, name, "origin")
            binder.report(
                "SB422",
                (group, name, "axis"),
                f"the axis is {angle:.3g} degrees from the line of the origin",
                help=("write `axis: z` or `axis: -z`: z of the joint's frame is along the line that was found",),
                notes=(evidence.text,) if evidence.text else (),
            )


def _is_on_line(origin: Origin) -> bool:
    """Whether the frame has z along a line of faces, and is not turned from it."""
    if isinstance(origin, AutoOrigin | AxisOrigin | MateOrigin):
        return origin.offset is None or not any(origin.offset.rpy)
    return origin == "auto"
