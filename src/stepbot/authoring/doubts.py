"""Joints to be reviewed whatever their score, because the geometry is ambiguous."""

from collections.abc import Sequence

from stepbot.robot.model import JointKind

from .evidence import Rank
from .loops import Arc, locked_arcs, loop_motions
from .structure import Structure


def note_doubts(arcs: Sequence[Arc], structure: Structure, *, has_drives: bool) -> None:
    """Add review notes to each joint without a motor or a bearing.

    Args:
        arcs: Joints and closures.
        structure: Subassemblies that look like links.
        has_drives: Whether there is any motor: without one, the assembly may not be a mechanism.
    """
    motions, locked = loop_motions(arcs), locked_arcs(arcs)
    for k, arc in enumerate(arcs):
        h, motion = arc.hinge, motions.get(k)
        if h.review or h.drives or h.by_role or h.rank == Rank.STATED or h.type == JointKind.FIXED:
            continue
        if not structure.are_across(h.a, h.b):
            h.review = "inferred from shapes alone; the parts may be fixed"
        elif arc.could_slide and (motion is None or motion.slides):
            h.review = "nothing blocks it along its axis: could also be prismatic"
        elif k in locked:
            h.review = "its loop of joints cannot move as drafted"
        elif not has_drives and not any(arc.is_closure for arc in arcs):
            h.review = "no motor found: the assembly may not be a mechanism"
