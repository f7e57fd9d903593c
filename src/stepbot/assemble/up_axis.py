"""Warns if the assembly was probably drawn with another axis up than the sidecar implies."""

from collections.abc import Sequence

from stepbot.robot.joint_table import JointRow
from stepbot.robot.model import JointKind
from stepbot.step.features.ground import standing

from .binder import Binder
from .claims import Claims


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
    found = standing(binder.assembly, parts, axes)
    if found is not None:
        binder.report(
            "SB421",
            ("root",),
            f"the assembly seems to be drawn with {found.up} up, not z: {found}",
            help=(f"write `root: {{up: {found.up}}}`, or `root: {{up: z}}` if z is up",),
        )
