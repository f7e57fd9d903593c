"""Joints, masses and collision shapes in words, and the rows of the joint table as JSON data."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.joint_table import Basis, Evidence, JointRow, Rival, Side, Vector3

from .plain import Json, picked
from .results import LinkCollision

_KILOGRAM = 0.9995
"""Mass [kg] from which it is written in kilograms."""


def mass_words(mass: float) -> str:
    """A mass [kg] to three digits: ``1.04 kg``, ``57.2 g``."""
    return f"{mass:.3g} kg" if not mass or mass >= _KILOGRAM else f"{1e3 * mass:.3g} g"


def mass_summary(masses: Mapping[str, float]) -> str:
    """All links in one line: the total, the lightest and the heaviest; empty without links.

    Args:
        masses: Mass of each link [kg].
    """
    heavy = {link: mass for link, mass in masses.items() if mass > 0.0}
    words = f"mass: {mass_words(exact_sum(masses.values()))} in {len(masses)} link" + "s" * (len(masses) != 1)
    if len(heavy) < 2:
        return words if masses else ""
    least, most = min(heavy, key=heavy.__getitem__), max(heavy, key=heavy.__getitem__)
    return f"{words}, from {mass_words(heavy[least])} ({least}) to {mass_words(heavy[most])} ({most})"


_PLURALS = {"box": "boxes", "mesh": "meshes"}


def shape_words(shapes: Mapping[str, int]) -> str:
    """``2 boxes, 1 cylinder, 3 hulls``."""
    return ", ".join(f"{n} {name if n == 1 else _PLURALS.get(name, name + 's')}" for name, n in sorted(shapes.items()))


def collision_summary(shapes: Sequence[LinkCollision]) -> str:
    """All links in one line: the number of shapes, the worst intersection over union, the largest overshoot."""
    counts: Counter[str] = Counter()
    for one in shapes:
        counts.update(one.shapes)
    links = f"{len(shapes)} link" + "s" * (len(shapes) != 1)
    words = f"collision shapes of {links}: {shape_words(counts)}"
    scored = [one for one in shapes if one.iou is not None and one.overshoot is not None]
    if scored:
        least = min(scored, key=lambda one: one.iou or 0.0)
        most = max(scored, key=lambda one: one.overshoot or 0.0)
        words += f"; intersection / union at least {least.iou:.2f} ({least.link})"
        words += f", overshoot at most {1e3 * (most.overshoot or 0.0):.1f} mm ({most.link})"
    return words


def joint_table_document(rows: Iterable[JointRow]) -> list[Json]:
    """The joint table as JSON data."""
    return [_joint_row(row) for row in rows]


def _joint_row(row: JointRow) -> Json:
    found = row.evidence
    rivals = [picked(rival, "basis point direction radii share") for rival in found.rivals]
    return picked(row, "name kind is_closure parent child origin axis axis2") | picked(
        found, "basis source=text faces=sides overlap clearance selected rivals doubt", rivals=rivals
    )


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
