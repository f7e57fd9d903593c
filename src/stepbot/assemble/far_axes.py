"""Axes far from the robot: coordinates in another unit, or in another frame."""

from collections.abc import Mapping, Sequence
from math import atan2, degrees, hypot

import numpy as np

from stepbot.geometry.spatial import cross
from stepbot.robot.joint_table import JointRow
from stepbot.robot.model import JointKind
from stepbot.sidecar.document import ClosureSection, JointSection
from stepbot.sidecar.origins import AutoOrigin, AxisOrigin, ExplicitOrigin, MateOrigin, Origin
from stepbot.step.features.axes import millimetres
from stepbot.step.features.ground import standing

from .binder import Binder
from .claims import Claims
from .frames import Frames

_FARTHEST = 1.0
"""Distance from the sphere around the assembly, as a share of its diameter, up to which an axis is plausible."""


def report_far_axes(binder: Binder, frames: Frames) -> None:
    """Report SB423: nothing of the assembly is near the axis of a turning joint."""
    given = {name: joint for name, joint in binder.document.joints.items() if _is_given(joint)}
    box = binder.assembly.bounds(0) if given else None
    if box is None:
        return
    low, high = np.array(box)
    center, diagonal = 0.5 * (low + high), float(np.linalg.norm(high - low))
    for name, joint in given.items():
        X_WJ = frames.joint(name)
        if X_WJ is None:
            continue
        arm = center - np.array(X_WJ.position)
        if joint.type.about == "line":
            arm = cross(arm, X_WJ.turn(joint.axis))
        distance = float(np.linalg.norm(arm)) - 0.5 * diagonal
        if distance > _FARTHEST * diagonal:
            binder.report(
                "SB423",
                ("joints", name, "origin"),
                f"its axis is {millimetres(distance)} from the assembly, which is {millimetres(diagonal)} large",
                help=(
                    "write coordinates with their unit, such as `12 mm` or `4 in`; plain numbers are metres",
                    "coordinates are those of the assembly, unless `relative_to` names a link or a component",
                ),
            )


def _is_given(joint: JointSection) -> bool:
    """Whether a turning joint has coordinates in its origin."""
    if not joint.type.about or isinstance(joint.origin, str):
        return False
    return isinstance(joint.origin, ExplicitOrigin) or joint.origin.offset is not None


_LEAST = degrees(1e-3)
"""Angle [degrees] from which an axis does not follow its line."""


def report_axes_off_their_lines(binder: Binder, frames: Frames) -> None:
    """Report SB422: the frame on a line has z along it, so that any other axis is across the faces that were found."""
    document = binder.document
    groups: Mapping[str, Mapping[str, JointSection | ClosureSection]]
    groups = {"joints": document.joints, "closures": document.closures}
    for group, sections in groups.items():
        for name, section in sections.items():
            if section.type.about != "line" or not _is_on_line(section.origin):
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


def report_up_axis(binder: Binder, claims: Claims, root: str, rows: Sequence[JointRow]) -> None:
    """Report SB421, unless ``root`` in the sidecar gives the axis that is up, or a frame."""
    section = binder.document.root
    if section is not None and (section.axes is not None or section.frame is not None):
        return
    base = {root}
    for row in rows:  # in tree order
        if row.kind == JointKind.FIXED and row.parent in base and not row.is_closure:
            base.add(row.child)
    axes = [row.axis for row in rows if row.parent in base and row.child not in base and row.axis is not None]
    parts = [index for link in base for index in claims.parts_of(link)]
    up = standing(binder.assembly, parts, axes)
    if up is not None:
        binder.report(
            "SB421",
            ("root",),
            f"the assembly seems to be drawn with {up.up} up, not z: {up}",
            help=(f"write `root: {{up: {up.up}}}`, or `root: {{up: z}}` if z is up",),
        )
