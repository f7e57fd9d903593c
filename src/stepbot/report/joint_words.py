"""Joints in words: directions, points, and the evidence for a joint's position."""

from stepbot.robot.joint_table import Basis, Evidence, Rival, Side, Vector3

_ALONG = 1e-6
"""Largest component of a direction along another axis at which it still counts as axis-aligned."""


def direction_words(direction: Vector3) -> str:
    """A direction: ``+z``, ``-x``, or its components."""
    for index, letter in enumerate("xyz"):
        if all(abs(c) <= _ALONG for i, c in enumerate(direction) if i != index):
            return f"{'+' if direction[index] > 0.0 else '-'}{letter}"
    return f"[{', '.join(f'{round(c, 6) + 0.0:.4g}' for c in direction)}]"


def in_millimetres(length: float) -> str:
    """A length [m] as a number of millimetres, to the micrometre."""
    return f"{round(length * 1e3, 3) + 0.0:.10g}"


def point_words(point: Vector3) -> str:
    """A point [m]: ``[0, 12.5, 3] mm``."""
    return f"[{', '.join(map(in_millimetres, point))}] mm"


def evidence_words(evidence: Evidence) -> str:
    """The evidence for a joint's position, in one phrase; empty for a file's."""
    if evidence.basis is Basis.FILE:
        return ""
    if evidence.basis is Basis.GIVEN:
        return f"given: {evidence.text}"
    words = _meeting_words(evidence)
    if not evidence.selected:
        return words
    by = dict.fromkeys(map(face_words, evidence.selected_by))
    if not by or not by.keys().isdisjoint(map(face_words, evidence.sides)):
        return f"{words}, selected by the sidecar"
    return f"selected by {' and '.join(by)}: {words}"


def _meeting_words(evidence: Evidence) -> str:
    """The faces on a line and how they meet."""
    if evidence.basis is Basis.AXIS:
        return f"axis of {' and '.join(map(face_words, evidence.sides))}"
    a, b = sorted(evidence.sides, key=lambda side: side.bore)
    if evidence.basis is Basis.FIT:
        return f"{face_words(a)} in {face_words(b)}, {in_millimetres(evidence.overlap or 0.0)} mm engaged"
    gap = -(evidence.overlap or 0.0)
    if evidence.basis is Basis.FLANGE:
        return f"equal bores of radius {in_millimetres(a.radius)} mm, {_gap(gap)}"
    return f"{face_words(a)} and {face_words(b)}, {_gap(gap)}"


def rival_words(rival: Rival) -> str:
    """Another line that matches the origin, in one phrase."""
    radii = ", ".join(map(in_millimetres, rival.radii[:4]))
    share = f"{100.0 * rival.share:.3g} % as wide"
    return (
        f"other line ({rival.basis}), {share}: {direction_words(rival.direction)} "
        f"through {point_words(rival.point)}, radius {radii} mm"
    )


def face_words(side: Side) -> str:
    """A face: ``bore of radius 4 mm``."""
    return f"{'bore' if side.bore else 'shaft'} of radius {in_millimetres(side.radius)} mm"


def _gap(gap: float) -> str:
    if round(abs(gap), 6) == 0.0:
        return "end to end"
    return f"{in_millimetres(gap)} mm apart" if gap > 0.0 else f"overlapping by {in_millimetres(-gap)} mm"
