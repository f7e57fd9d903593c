"""Joints, missing engines and degrees of freedom as texts, from the results."""

from collections.abc import Collection, Iterator, Sequence

from stepbot.robot.joint_table import Basis, JointRow

from .results import Results, Row
from .summary import JointTable, JointText
from .words import direction_words, evidence_words, face_words, point_words, rival_words


def joint_table_of(rows: Sequence[JointRow], *, verbose: bool = False) -> JointTable:
    """The joint table.

    Args:
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


def doubtful_joints(rows: Sequence[JointRow]) -> JointTable | None:
    """The table of the joints on weak evidence; None without any."""
    weak = [row for row in rows if row.evidence.doubt]
    if not weak:
        return None
    title = f"{len(weak)} of {len(rows)} joints on weak evidence, in the STEP frame:"
    return JointTable(title, tuple(_joint(row, verbose=False) for row in weak), "")


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
