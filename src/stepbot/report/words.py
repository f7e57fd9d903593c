"""Results in words: joints, masses, collision shapes, missing engines, degrees of freedom, data sheets."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from math import isfinite
from typing import TYPE_CHECKING

from stepbot.diagnostics import counted
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.joint_table import Basis, Evidence, JointRow, Rival, Side, Vector3

from .plain import Json, picked
from .results import LinkCollision, Results, Row

if TYPE_CHECKING:
    from stepbot.robot.datasheet import ArmFigures, DataSheet

_KILOGRAM = 0.9995
"""Mass [kg] from which it is written in kilograms."""


def mass_words(mass: float) -> str:
    """A mass [kg] to three digits: ``1.04 kg``, ``57.2 g``."""
    return f"{mass:.3g} kg" if not mass or mass >= _KILOGRAM else f"{1e3 * mass:.3g} g"


def mass_summary(masses: Mapping[str, float]) -> str:
    """The masses [kg] of all links in one line: the total, the lightest and the heaviest; empty without links."""
    heavy = {link: mass for link, mass in masses.items() if mass > 0.0}
    words = f"mass: {mass_words(exact_sum(masses.values()))} in {counted(len(masses), 'link')}"
    if len(heavy) < 2:
        return words if masses else ""
    least, most = min(heavy, key=heavy.__getitem__), max(heavy, key=heavy.__getitem__)
    return f"{words}, from {mass_words(heavy[least])} ({least}) to {mass_words(heavy[most])} ({most})"


_PLURALS = {"box": "boxes", "mesh": "meshes"}


def shape_words(shapes: Mapping[str, int]) -> str:
    """``2 boxes, 1 cylinder, 3 hulls``."""
    return ", ".join(counted(n, name, _PLURALS.get(name, "")) for name, n in sorted(shapes.items()))


def collision_summary(shapes: Sequence[LinkCollision]) -> str:
    """All links in one line: the number of shapes, the worst intersection over union, the largest overshoot."""
    counts: Counter[str] = Counter()
    for collision in shapes:
        counts.update(collision.shapes)
    words = f"collision shapes of {counted(len(shapes), 'link')}: {shape_words(counts)}"
    scored = [shape for shape in shapes if shape.iou is not None and shape.overshoot is not None]
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
    evidence = row.evidence
    rivals = [picked(rival, "basis point direction radii share") for rival in evidence.rivals]
    return picked(row, "name kind is_closure parent child origin axis axis2") | picked(
        evidence, "basis source=text faces=sides overlap clearance selected rivals doubt", rivals=rivals
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


def joint_table_title(rows: Sequence[JointRow]) -> str:
    """What is above the joint table: the frame and the configuration of its numbers."""
    from_file = all(row.evidence.basis is Basis.FILE for row in rows)
    return "Joints, in the base frame at q = 0:" if from_file else "Joints, as modelled in CAD, in the STEP frame:"


def weak_joints(rows: Sequence[JointRow]) -> str:
    """Number and names of the joints on weak evidence; empty without any."""
    weak = [row.name for row in rows if row.evidence.doubt]
    return f"{len(weak)} of {len(rows)} joints on weak evidence: {', '.join(weak)}" if weak else ""


def joint_words(row: JointRow) -> tuple[str, ...]:
    """A joint: name, type and links after a mark of weak evidence; then its axis, and the evidence for it."""
    mark = "?" if row.evidence.doubt else " "
    kind = f"{row.kind} closure" if row.is_closure else row.kind
    head = f"{mark} {row.name or '(unnamed)'}: {kind}, {row.parent} -> {row.child}"
    return head, _place(row), *_details(row)


def _place(row: JointRow) -> str:
    through = "position not reported by any engine" if row.origin is None else point_words(row.origin)
    if row.axis is None:
        return f"at {through}"
    second = "" if row.axis2 is None else f" and {direction_words(row.axis2)}"
    return f"axis {direction_words(row.axis)}{second} through {through}"


def _details(row: JointRow) -> Iterator[str]:
    evidence = evidence_words(row.evidence)
    if evidence:
        yield evidence
    if row.evidence.doubt:
        yield f"weak: {row.evidence.doubt}"
    sides = dict.fromkeys((*row.evidence.selected_by, *row.evidence.sides))
    yield from (f"{face_words(side)}: {side.component}" for side in sides)
    yield from map(rival_words, row.evidence.rivals)


def absent_engines(results: Results, optional: Collection[str]) -> tuple[str, ...]:
    """Optional engines that are not installed here."""
    return tuple(dict.fromkeys(row.engine for row in results.rows() if is_absent(row, optional)))


def is_absent(row: Row, optional: Collection[str]) -> bool:
    """Whether an optional engine is missing from the result of a file because it is not installed."""
    return not row.compared and row.engine in optional and row.why.endswith("is not installed")


def independent_joints(results: Results) -> str:
    """The degrees of freedom of a robot with loops, and its independent joints; empty for one without."""
    if not results.driven or results.degrees_of_freedom is None:
        return ""
    return f"{counted(results.degrees_of_freedom, 'degree')} of freedom, driven by {', '.join(results.driven)}"


Table = tuple[tuple[str, ...], list[tuple[str, ...]]]
"""Headings and rows."""


def _millimetres(length: float) -> str:
    """A length [m] in whole millimetres; below 10 mm, with three digits."""
    return f"{1e3 * length:.0f}" if abs(length) >= 0.01 else f"{1e3 * length:.3g}"


def sheet_blocks(sheet: "DataSheet") -> Iterator[str | Table]:
    """A data sheet as headings (``## tip``), items of lists (``- reach: ...``) and tables, without its title."""
    yield f"- mass: {sheet.mass:.4g} kg"
    if sheet.size is not None:
        yield "- size at home: " + " x ".join(map(_millimetres, sheet.size)) + " mm"
    if sheet.standing is not None:
        height, margin = sheet.standing
        inside = "" if margin is None else f"; its com is {_millimetres(margin)} mm inside of what it stands on"
        yield f"- stands with its base {_millimetres(height)} mm over the floor{inside}"
    yield from (f"- {actuator}: motor {motor}" for actuator, motor in sheet.motors)
    plays = sheet.backlash
    yield from (f"- {joint}: play of {size:.3g} {unit}, the backlash of its motor" for joint, size, unit in plays)
    for what, masses in (("link", sheet.links), ("material", sheet.materials)):
        if masses:
            yield (what, "mass [kg]"), [(name, f"{mass:.4g}") for name, mass in masses]
    if sheet.joints:
        heads = (
            "joint [SI]",
            "range",
            "velocity",
            "effort",
            "gravity",
            "inertia",
            "acceleration",
            "jerk",
            "gains [Hz]",
        )
        yield (
            heads,
            [
                (
                    joint.name,
                    f"{joint.lower:.4g} to {joint.upper:.4g}",
                    *map(_number, (joint.velocity, joint.effort, joint.gravity)),
                    f"{joint.inertia[0]:.4g} to {joint.inertia[1]:.4g}",
                    *map(_number, (joint.acceleration, joint.jerk)),
                    "-" if joint.frequency is None else f"{joint.frequency[0]:.3g} to {joint.frequency[1]:.3g}",
                )
                for joint in sheet.joints
            ],
        )
    if sheet.looped:
        yield f"- no reach, payload or DH parameters of joints of closed loops: {', '.join(sheet.looped)}"
    for arm in sheet.arms:
        yield from _arm_blocks(arm)


def _arm_blocks(arm: "ArmFigures") -> Iterator[str | Table]:
    yield f"## {arm.tip}"
    yield f"- reach: {_millimetres(arm.reach)} mm from the axis of {arm.joints[0]}"
    if arm.payloads:
        held: list[tuple[str, ...]] = [(_millimetres(far), f"{mass:.3g}") for far, mass in arm.payloads]
        yield ("tip up to [mm]", "payload [kg]"), held
    if arm.dh is None:
        return
    rows = [(row.joint, *(f"{value:.5g}" for value in (row.theta, row.d, row.a, row.alpha))) for row in arm.dh.rows]
    yield ("DH, standard", "theta [rad]", "d [m]", "a [m]", "alpha [rad]"), rows
    shifted = [("0", "0"), *((row[3], row[4]) for row in rows)]
    modified = [(*row[:3], *before) for row, before in zip(rows, shifted, strict=False)]
    yield ("DH, modified", "theta [rad]", "d [m]", "a before [m]", "alpha before [rad]"), modified
    for words, X in (("first frame in the base", arm.dh.base), (f"{arm.tip} in the last frame", arm.dh.tool)):
        xyz, rpy = (" ".join(f"{value:.5g}" for value in values) for values in (X.position, X.rpy))
        yield f"- {words}: xyz {xyz}, rpy {rpy}"


def _number(value: float | None) -> str:
    return "-" if value is None or not isfinite(value) else f"{value:.4g}"
