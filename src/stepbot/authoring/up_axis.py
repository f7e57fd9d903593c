"""The axis that is up in a draft, if that is probably not z."""

from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly
from stepbot.step.features.ground import Standing, standing

from .draft import Draft


def drawn_up(draft: Draft, assembly: Assembly) -> Standing | None:
    """Evidence that an axis other than z is up; None if there is none.

    Args:
        draft: A draft of the assembly.
        assembly: The assembly.
    """
    base = {draft.root}
    for joint in draft.joints:  # in tree order
        if joint.type is JointKind.FIXED and joint.parent in base:
            base.add(joint.child)
    parts = [index for link in draft.links if link.name in base for index in link.components]
    moving = [joint for joint in draft.joints if joint.parent in base and joint.child not in base]
    return standing(assembly, parts, [joint.direction for joint in moving if joint.direction is not None])
