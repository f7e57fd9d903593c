"""Results of verification and diagnostics for the page."""

from collections.abc import Iterable
from pathlib import PurePath
from typing import Any

from stepbot.diagnostics import Diagnostic
from stepbot.report.results import Results

Json = dict[str, Any]


def proof_document(report: Results) -> Json:
    """The verification table: one row per file and engine; pairs of links that overlap as drawn."""
    return {
        "rows": [
            {
                "file": row.file,
                "engine": row.engine,
                "version": report.versions.get(row.engine, ""),
                "against": row.against,
                "status": row.status.value,
                "compared": list(row.compared),
                "worst": None
                if row.worst is None
                else {
                    "quantity": row.worst.quantity,
                    "deviation": row.worst.deviation,
                    "tolerance": row.worst.tolerance,
                    "unit": row.worst.unit,
                    "where": row.worst.where,
                },
                "why": row.why,
            }
            for row in report.rows()
        ],
        "overlaps": [{"links": [a, b], "depth": depth} for a, b, depth in report.collisions],
        "own_parsers": list(report.own_parsers),
    }


def diagnostic_documents(found: Iterable[Diagnostic]) -> list[Json]:
    """Diagnostics with places relative to the folders of their files."""
    return [
        {
            "code": one.code,
            "severity": one.severity,
            "message": one.message,
            "file": PurePath(one.span.file).name,
            "line": one.span.line,
            "help": list(one.remedies),
            "notes": list(one.notes),
        }
        for one in found
    ]
