"""Motion of a joint's axis between two revisions."""

import numpy as np

from stepbot.geometry.spatial import Pose, angle_between

from .shapes import ANGLE, PLACE
from .snapshot import Joint
from .wording import angle, length


def axis_words(old: Joint, new: Joint, common: Pose) -> str:
    """How a joint has moved, for messages; empty if it has not.

    Args:
        old: The joint in the old revision.
        new: The joint in the new revision.
        common: The motion of the whole assembly, which is subtracted.
    """
    start, end = common.apply(old.origin), np.array(new.origin)
    shift = end - start
    if old.axis is None or new.axis is None:
        distance = float(np.linalg.norm(shift))
        return f"origin moved by {length(distance)}" if distance > PLACE else ""
    before, after = common.turn(old.axis), np.array(new.axis)
    turned = angle_between(before, after)
    along = float(shift @ after)
    across = float(np.linalg.norm(shift - along * after))
    words = []
    if across > PLACE:
        words.append(f"moved by {length(across)}")
    if turned > ANGLE:
        words.append(f"turned by {angle(turned)}")
    if words:
        return f"axis {' and '.join(words)}"
    return f"origin moved by {length(abs(along))} along its axis" if abs(along) > PLACE else ""
