"""The closures of a description."""

from collections.abc import Iterable, Iterator

from stepbot.engines.observation import ObservedClosure
from stepbot.geometry.spatial import Pose, perpendicular_frame
from stepbot.robot.model import JointKind, LoopClosure

from .finding import UNSUPPORTED, Finding

"""Kinds of closures that the loop solver has."""


def closures_of(seen: Iterable[ObservedClosure], links: set[str], found: list[Finding]) -> Iterator[LoopClosure]:
    """The closures; those of other kinds are listed."""
    for number, one in enumerate(seen, start=1):
        name = one.name or f"closure {number}"
        kind = JointKind(one.kind) if one.kind in set(JointKind) else None
        X_AF, X_BF, axis = one.X_AF, one.X_BF, one.axis or (0.0, 0.0, 1.0)
        if kind is None and one.points is not None:
            kind = JointKind.BALL if one.axes is None else JointKind.REVOLUTE
            directions = one.axes or (axis, axis)
            X_AF, X_BF = (Pose.of(perpendicular_frame(d), p) for d, p in zip(directions, one.points, strict=True))
            axis = (0.0, 0.0, 1.0)
        if (
            kind is None
            or not (kind.closes or kind.is_hinge)
            or X_AF is None
            or X_BF is None
            or not {one.link_a, one.link_b} <= links
        ):
            found.append(Finding(UNSUPPORTED, f"closure '{name}' of type '{one.kind}' is not supported"))
            continue
        yield LoopClosure(name, kind, one.link_a, X_AF, one.link_b, X_BF, axis)
