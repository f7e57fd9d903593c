"""A report as ``report.json``.

The report is deterministic: no times, no local folders, infinite limits as null. Its schema is
``schemas/report-1.schema.json``.
"""

import json
from collections import Counter
from collections.abc import Callable, Iterable
from math import isfinite
from pathlib import PurePath
from typing import Any

from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.version import __version__

from .robot import (
    Check,
    LinkCollision,
    MeasuredBody,
    Report,
    SimplifiedVisuals,
    Status,
    mass_document,
    number,
    robot_document,
)
from .words import joint_table_document

_quoted = json.encoder.encode_basestring


def _not_serializable(value: Any) -> Any:
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")


def indented(document: Any, default: Callable[[Any], Any] = _not_serializable) -> str:
    """The text that :func:`json.dumps` returns for an indentation of two spaces and ``ensure_ascii=False``.

    Args:
        document: JSON data; the keys of objects are strings.
        default: JSON data in place of any other object.

    Raises:
        TypeError: An object cannot be written as JSON, and ``default`` is not given.
        ValueError: A number is not finite.
    """
    return _text(document, "\n", default)


def _text(value: Any, indent: str, default: Callable[[Any], Any]) -> str:
    kind = type(value)
    if kind is str:
        return _quoted(value)
    if kind is int or (kind is float and isfinite(value)):
        return repr(value)
    if value is None:
        return "null"
    if kind is bool:
        return "true" if value else "false"
    inner = f"{indent}  "
    if isinstance(value, dict) and value:
        members = [f"{_quoted(name)}: {_text(member, inner, default)}" for name, member in value.items()]
        return f"{{{inner}{f',{inner}'.join(members)}{indent}}}"
    if isinstance(value, list | tuple) and value:
        return f"[{inner}{f',{inner}'.join([_text(member, inner, default) for member in value])}{indent}]"
    if isinstance(value, str | int | float | dict | list | tuple):
        return json.dumps(value, ensure_ascii=False, allow_nan=False)
    return _text(default(value), indent, default)


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
        **({"variant": report.variant} if report.variant else {}),
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
        "max_bytes": one.max_bytes,
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
