"""Frames of closures in formats whose joints have X, Y or Z as axis, so that their frames are turned."""

from collections.abc import Sequence

from stepbot.geometry.spatial import Pose, Vector3, vector3
from stepbot.robot.model import LoopClosure

from .observation import ObservedClosure


def turned_as_expected(
    name: str,
    kind: str,
    ends: tuple[str, str],
    frames: tuple[Pose, Pose],
    axis: Vector3 | None,
    loops: Sequence[LoopClosure],
) -> ObservedClosure:
    """A closure with both frames turned alike, so that the first is parallel to that of the expected closure.

    A closure remains the same if both frames are turned alike and its axis is expressed in them. The frame in the
    second link, both positions and the axis show whether it is the expected one.

    Args:
        kind: A :class:`stepbot.robot.model.JointKind` value.
        frames: Its frame in both links.
        axis: In these frames; None for types without one.
        loops: The expected closures.
    """
    expected = next((one for one in loops if one.name == name), None)
    if expected is None:
        return ObservedClosure.of_frames(name, kind, ends, frames, axis)
    X_expected = expected.X_AF if expected.link_a == ends[0] else expected.X_BF
    R_FE = Pose.of(frames[0].R.T @ X_expected.R)
    turned = None if axis is None else vector3(R_FE.inverse().turn(axis))
    return ObservedClosure.of_frames(name, kind, ends, (frames[0] @ R_FE, frames[1] @ R_FE), turned)
