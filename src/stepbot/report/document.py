"""A report as ``report.json``.

The report is deterministic: no times, no local folders, infinite limits as null. Its schema is
``schemas/report-1.schema.json``.
"""

from collections import Counter
from collections.abc import Iterable
from pathlib import PurePath
from typing import Any

from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.version import __version__

from .indented_json import indented
from .joint_table import joint_table_document
from .record import Check, LinkCollision, MeasuredBody, Report, SimplifiedVisuals, Status
from .robot import mass_document, number, robot_document

VERSION = 1
"""Version of the schema."""

Json = dict[str, Any]


def report_bytes(report: Report, diagnostics: Iterable[Diagnostic]) -> bytes:
    """``report.json``: UTF-8, indented, one newline at the end."""
    text = indented(report_document(report, diagnostics))
    return (text + "\n").encode("utf-8", "backslashreplace")


def report_document(report: Report, diagnostics: Iterable[Diagnostic]) -> Json:
    """The report as JSON data; suppressed diagnostics only as counts."""
    ignored = diagnostics.ignored if isinstance(diagnostics, Diagnostics) else ()
    statuses = [check.status for check in report.checks]
    return {
        "version": VERSION,
        "generator": f"stepbot {__version__}",
        "robot": None if report.robot is None else robot_document(report, report.robot),
        "summary": {
            **{status.name.lower(): statuses.count(status) for status in Status},
            "passed_by_own_parsers": len(report.read_back),
            "ignored": dict(sorted(Counter(one.code for one in ignored).items())),
        },
        "engines": dict(report.versions),
        "distributions": dict(report.distributions),
        "checks": [_check(check) for check in report.checks],
        "notes": {key: list(notes) for key, notes in report.notes.items()},
        "files": [{"path": file.path, "format": file.format, "content": file.content.value} for file in report.files],
        "inputs": dict(report.inputs),
        "names": dict(report.names),
        "bodies": [_body(body) for body in report.bodies],
        "collision_shapes": [_link_collision(one) for one in report.collision_shapes],
        "simplified_visuals": [_simplified(one) for one in report.simplified_visuals],
        "joint_table": joint_table_document(report.joint_table),
        "diagnostics": [_diagnostic(diagnostic) for diagnostic in diagnostics],
    }


def _check(check: Check) -> Json:
    return {
        "file": check.file,
        "format": check.format,
        "engine": check.engine,
        "against": check.against,
        "quantity": check.quantity,
        "status": check.status.value,
        "deviation": number(check.deviation),
        "tolerance": number(check.tolerance),
        "unit": check.unit,
        "where": check.where,
        "why": check.why,
    }


def _body(body: MeasuredBody) -> Json:
    return {
        "name": body.name,
        "occurrences": body.occurrences,
        "mesh": None if body.mesh is None else mass_document(body.mesh),
        "exact": None if body.exact is None else mass_document(body.exact),
        "deviation": number(body.deviation),
        "error": number(body.error),
        "written": body.written,
    }


def _simplified(one: SimplifiedVisuals) -> Json:
    return {
        "link": one.link or None,
        "max_triangles": one.max_triangles,
        "before": one.before,
        "after": one.after,
        "deviation": one.deviation,
    }


def _link_collision(one: LinkCollision) -> Json:
    return {
        "link": one.link,
        "rule": one.rule,
        "shapes": dict(one.shapes),
        "vertices": one.vertices,
        "most_vertices": one.most_vertices,
        "iou": number(one.iou),
        "overshoot": number(one.overshoot),
    }


def _diagnostic(diagnostic: Diagnostic) -> Json:
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity,
        "message": diagnostic.message,
        "file": PurePath(diagnostic.span.file).name,
        "line": diagnostic.span.line,
        "column": diagnostic.span.column,
        "help": list(diagnostic.help),
        "notes": list(diagnostic.notes),
    }
