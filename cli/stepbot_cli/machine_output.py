"""Diagnostics in the formats of programs that show them beside the code: GitHub, GitLab, SARIF for both, and JUnit."""

import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import click

from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.diagnostics.codes import CODES
from stepbot.version import __version__

from .command import PATH
from .terminal import Display

if TYPE_CHECKING:
    from stepbot.report.document import Suite


junit_option = click.option("--junit", type=PATH, metavar="FILE", help="Also write the results as JUnit XML.")


def write_junit(path: Path, suites: "Sequence[Suite]") -> None:
    """Write the results of robots to a file, creating its folder if necessary.

    Raises:
        StepbotError: It cannot be written (SB004).
    """
    from stepbot.report.document import junit_bytes
    from stepbot.runtime.file import write_file

    write_file(path, junit_bytes(suites), diagnostics := Diagnostics())
    diagnostics.raise_if_errors()


_GITHUB = {"error": "error", "warning": "warning", "note": "notice"}
_GITLAB = {"error": "major", "warning": "minor", "note": "info"}
_IN_MESSAGE = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A"})
_IN_PROPERTY = _IN_MESSAGE | str.maketrans({":": "%3A", ",": "%2C"})
_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def github(diagnostics: Iterable[Diagnostic]) -> str:
    """Commands of a workflow, one a line, which GitHub shows at the lines of a pull request.

    https://docs.github.com/en/actions/reference/workflow-commands-for-github-actions
    """
    return "\n".join(map(_command, diagnostics))


def gitlab(diagnostics: Iterable[Diagnostic]) -> str:
    """A report of code quality: https://docs.gitlab.com/ci/testing/code_quality/#code-quality-report-format."""
    issues = [
        {
            "description": _text(one),
            "check_name": one.code,
            "fingerprint": fingerprint,
            "severity": _GITLAB[one.severity],
            "location": {"path": _path(one), "lines": {"begin": max(one.span.line, 1)}},
        }
        for one, fingerprint in _fingerprints(diagnostics)
    ]
    return json.dumps(issues, indent=2, ensure_ascii=False)


def sarif(diagnostics: Iterable[Diagnostic]) -> str:
    """A log of static analysis, version 2.1.0: https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html."""
    listed = list(diagnostics)
    rules = [
        {
            "id": code,
            "shortDescription": {"text": CODES[code].title},
            "fullDescription": {"text": CODES[code].explanation},
            "help": {"text": CODES[code].fix},
            "defaultConfiguration": {"level": CODES[code].severity},
        }
        for code in sorted({one.code for one in listed})
    ]
    results = [
        {
            "ruleId": one.code,
            "level": one.severity,
            "message": {"text": _text(one)},
            "locations": [{"physicalLocation": _location(one)}],
            "partialFingerprints": {"stepbot/v1": fingerprint},
        }
        for one, fingerprint in _fingerprints(listed)
    ]
    driver = {"name": "stepbot", "version": __version__, "rules": rules}
    log = {"$schema": _SCHEMA, "version": "2.1.0", "runs": [{"tool": {"driver": driver}, "results": results}]}
    return json.dumps(log, indent=2, ensure_ascii=False)


FORMATS: dict[str, Callable[[Iterable[Diagnostic]], str]] = {"github": github, "gitlab": gitlab, "sarif": sarif}


def output_format_option(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--output-format`` to a command that has ``display``."""

    @wraps(command)
    def with_format(*, output_format: str, display: Display, **others: Any) -> int:
        if output_format != "text" and display.json and output_format != "json":
            raise click.UsageError(f"--json and --output-format {output_format} cannot be combined")
        if output_format in FORMATS:
            display = display._replace(concise=True, machine=output_format)
        return command(display=display._replace(json=display.json or output_format == "json"), **others)

    return click.option(
        "--output-format",
        type=click.Choice(["text", "json", *FORMATS]),
        default="text",
        help="How findings are printed: for people, as --json, as annotations of GitHub, as a report of GitLab's code "
        "quality, or as SARIF.  [default: text]",
    )(with_format)


def _command(diagnostic: Diagnostic) -> str:
    place = {"file": _path(diagnostic), "title": f"{diagnostic.code} {CODES[diagnostic.code].title}"}
    if diagnostic.span.line:
        place["line"] = str(diagnostic.span.line)
        if diagnostic.span.column:
            place["col"] = str(diagnostic.span.column)
        if diagnostic.span.end_column:
            place["endColumn"] = str(diagnostic.span.end_column)
    properties = ",".join(f"{name}={value.translate(_IN_PROPERTY)}" for name, value in place.items())
    return f"::{_GITHUB[diagnostic.severity]} {properties}::{_text(diagnostic).translate(_IN_MESSAGE)}"


def _text(diagnostic: Diagnostic) -> str:
    """The message with its notes and remedies, which these programs have no place for."""
    lines = [
        diagnostic.message,
        *(f"note: {note}" for note in diagnostic.notes),
        *(f"help: {help}" for help in diagnostic.remedies),
    ]
    return "\n".join(lines)


def _path(diagnostic: Diagnostic) -> str:
    """The file relative to the current folder, where it is in it: these programs know the repository alone."""
    path, here = Path(diagnostic.span.file), Path.cwd()
    return path.relative_to(here).as_posix() if path.is_absolute() and path.is_relative_to(here) else path.as_posix()


def _location(diagnostic: Diagnostic) -> dict[str, Any]:
    region: dict[str, int] = {}
    if diagnostic.span.line:
        region = {"startLine": diagnostic.span.line}
        if diagnostic.span.column:
            region["startColumn"] = diagnostic.span.column
        if diagnostic.span.column and diagnostic.span.end_column:
            region["endColumn"] = diagnostic.span.end_column
    where = Path(_path(diagnostic))
    artifact = {"uri": where.as_uri() if where.is_absolute() else quote(where.as_posix())}
    return {"artifactLocation": artifact, **({"region": region} if region else {})}


def _fingerprints(diagnostics: Iterable[Diagnostic]) -> Iterator[tuple[Diagnostic, str]]:
    """Each diagnostic with a hash that stays the same when its line moves, and is its own in the report."""
    from hashlib import sha256

    seen: Counter[tuple[str, str, str]] = Counter()
    for diagnostic in diagnostics:
        what = (_path(diagnostic), diagnostic.code, diagnostic.message)
        seen[what] += 1
        yield diagnostic, sha256("\n".join((*what, str(seen[what]))).encode()).hexdigest()
