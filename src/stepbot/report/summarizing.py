"""The texts of a summary, from the results."""

from collections.abc import Collection, Iterator, Sequence

from stepbot.robot.joint_table import Basis, JointRow

from .collision_words import collision_summary
from .joint_words import direction_words, evidence_words, face_words, point_words, rival_words
from .mass_words import mass_summary
from .results import Check, Results, Row
from .summary import JointTable, JointText, Proof, Summary

_ROBOT = "robot"
"""Label of checks that do not belong to a file."""


def summary_of(results: Results, optional: Collection[str]) -> Summary:
    """The texts about a conversion.

    Args:
        results: Its results.
        optional: Names of the engines that need not be installed.
    """
    return Summary(
        joint_table_of(results.joint_table) if results.joint_table else None,
        mass_summary(results.masses),
        collision_summary(results.collision_shapes) if results.collision_shapes else "",
        proof_of(results, optional) if results.checks else None,
    )


def joint_table_of(rows: Sequence[JointRow], *, verbose: bool = False) -> JointTable:
    """The joint table.

    Args:
        rows: The joints.
        verbose: Whether to name the components whose faces were found, and the other lines.
    """
    from_file = all(row.evidence.basis is Basis.FILE for row in rows)
    title = "Joints, in the base frame at q = 0:" if from_file else "Joints, as modelled in CAD, in the STEP frame:"
    weak = [row.name for row in rows if row.evidence.doubt]
    return JointTable(
        title,
        tuple(_joint(row, verbose=verbose) for row in rows),
        f"? {len(weak)} of {len(rows)} on weak evidence: {', '.join(weak)}" if weak else "",
    )


def _joint(row: JointRow, *, verbose: bool) -> JointText:
    mark = "?" if row.evidence.doubt else " "
    kind = f"{row.kind} closure" if row.is_closure else row.kind
    head = f"{mark} {row.name or '(unnamed)'}: {kind}, {row.parent} -> {row.child}"
    details = tuple(_details(row, verbose=verbose))
    return JointText(head, "", (_place(row), *details)) if verbose else JointText(head, _place(row), details)


def _place(row: JointRow) -> str:
    through = "position not reported by any engine" if row.origin is None else point_words(row.origin)
    if row.axis is None:
        return f"at {through}"
    second = "" if row.axis2 is None else f" and {direction_words(row.axis2)}"
    return f"axis {direction_words(row.axis)}{second} through {through}"


def _details(row: JointRow, *, verbose: bool) -> Iterator[str]:
    found = evidence_words(row.evidence)
    if found:
        yield found
    if row.evidence.doubt:
        yield f"weak: {row.evidence.doubt}"
    if verbose:
        sides = dict.fromkeys((*row.evidence.selected_by, *row.evidence.sides))
        yield from (f"{face_words(side)}: {side.component}" for side in sides)
        yield from map(rival_words, row.evidence.rivals)


def proof_of(results: Results, optional: Collection[str]) -> Proof:
    """The verification results of each file: its engines and the worst deviation, and the number of all checks.

    Args:
        results: The results.
        optional: Names of the engines that need not be installed.
    """
    by_file: dict[str, list[Row]] = {}
    for row in results.rows():
        by_file.setdefault(row.file, []).append(row)
    remarks = (independent_joints(results), _counts(results, optional))
    return Proof(tuple(map(_file, by_file.values())), tuple(filter(None, remarks)))


def _file(rows: Sequence[Row]) -> tuple[str, str, str, str, str]:
    statuses = [row.status.value for row in rows]
    result = next(status for status in ("failed", "passed", "not run") if status in statuses)
    engines = [name for row in rows if row.compared for name in row.engine.split(", ")]
    measured = [row.worst for row in rows if row.worst is not None and row.status.value == result]
    return (
        rows[0].format,
        rows[0].file or _ROBOT,
        result,
        ", ".join(dict.fromkeys(engines)) or "-",
        _deviation(max(measured, key=lambda check: check.ratio, default=None)),
    )


def _deviation(check: Check | None) -> str:
    """The deviation that is largest relative to its tolerance, and that tolerance."""
    if check is None or check.deviation is None:
        return "-"
    unit = f" {check.unit}" if check.unit else ""
    return f"{check.quantity}: {check.deviation:.1e} of {check.tolerance:.0e}{unit}"


def _counts(results: Results, optional: Collection[str]) -> str:
    """The number of checks that passed, failed and did not run, and of those confirmed by own parsers only."""
    statuses = [check.status.value for check in results.checks]
    own = len(results.read_back)
    passed = f"{statuses.count('passed')} passed" + (f" ({own} by stepbot's parsers only)" if own else "")
    absent = absent_engines(results, optional)
    missing = f"; not installed: {', '.join(absent)}" if absent else ""
    failed, not_run = statuses.count("failed"), statuses.count("not run")
    return f"{len(statuses)} checks: {passed}, {failed} failed, {not_run} not run (-v for reasons){missing}"


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
    degrees = f"{results.degrees_of_freedom} degree" + "s" * (results.degrees_of_freedom != 1)
    return f"{degrees} of freedom, driven by {', '.join(results.driven)}"
