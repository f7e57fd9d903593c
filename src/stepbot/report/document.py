"""A report as ``report.json``, and as JUnit XML: one suite per robot, one case per check.

The report is deterministic: no times, no local folders, infinite limits as null. Its schema is
``schemas/report-1.schema.json``. The dialect of JUnit is the one that Jenkins and GitLab read:
https://github.com/testmoapp/junitxml.
"""

import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from math import isfinite
from pathlib import PurePath
from typing import Any
from xml.etree import ElementTree as ET

from msgspec import Struct

from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.version import __version__

from .plain import Json, picked, plain
from .robot import MASS, MeasuredBody, Report, Status, robot_document
from .words import joint_table_document

_quoted = json.encoder.encode_basestring


def _not_serializable(value: Any) -> Any:
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")


def indented(document: Any, default: Callable[[Any], Any] = _not_serializable) -> str:
    """The text of :func:`json.dumps` for an indentation of two spaces and ``ensure_ascii=False``; keys are strings.

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
_CHECK = "file format engine against quantity status deviation tolerance unit where why"
_SIMPLIFIED = "link max_triangles max_bytes before after deviation"


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
        "checks": [picked(check, _CHECK) for check in report.checks],
        "notes": {key: list(notes) for key, notes in report.notes.items()},
        "files": [picked(file, "path format content") for file in report.files],
        **({"variant": report.variant} if report.variant else {}),
        "inputs": dict(report.inputs),
        "names": dict(report.names),
        "bodies": [_body(body) for body in report.bodies],
        "collision_shapes": plain(report.collision_shapes),
        "simplified_visuals": [
            picked(visual, _SIMPLIFIED, link=visual.link or None) for visual in report.simplified_visuals
        ],
        "joint_table": joint_table_document(report.joint_table),
        "diagnostics": [_diagnostic(diagnostic) for diagnostic in diagnostics],
    }


def _body(body: MeasuredBody) -> Json:
    masses = {name: mass and picked(mass, MASS) for name, mass in (("mesh", body.mesh), ("exact", body.exact))}
    return picked(body, "name occurrences mesh exact deviation error written", **masses)


def _diagnostic(diagnostic: Diagnostic) -> Json:
    span = diagnostic.span
    place = {"file": PurePath(span.file).name, "line": span.line, "column": span.column}
    return picked(diagnostic, "code severity message file line column help notes", **place)


_NOT_IN_XML = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


class Suite(Struct, frozen=True):
    """A robot."""

    name: str
    checks: Sequence[Mapping[str, Any]]
    """As in ``report.json``."""
    diagnostics: Sequence[Diagnostic] = ()
    seconds: float | None = None
    whole: str = "conversion"
    """Name of the case that represents the whole run."""


def junit_bytes(suites: Iterable[Suite]) -> bytes:
    """The document; a robot that was not converted has one case with the reason."""
    root = ET.Element("testsuites", name="stepbot")
    for suite in suites:
        root.append(_suite(suite))
    for count in ("tests", "failures", "errors", "skipped"):
        root.set(count, str(sum(int(one.get(count, "0")) for one in root)))
    ET.indent(root)
    text: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _suite(suite: Suite) -> ET.Element:
    element = ET.Element("testsuite", name=_clean(suite.name))
    if suite.seconds is not None:
        element.set("time", f"{suite.seconds:.3f}")
    element.append(_conversion(suite))
    for check in suite.checks:
        element.append(_check(suite.name, check))
    element.set("tests", str(len(element)))
    for count, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        element.set(count, str(sum(case.find(tag) is not None for case in element)))
    return element


def _conversion(suite: Suite) -> ET.Element:
    """Whether the robot could be converted, or verified; the diagnostics are in the output."""
    case = ET.Element("testcase", classname=_clean(suite.name), name=suite.whole)
    errors = [diagnostic for diagnostic in suite.diagnostics if diagnostic.severity == "error"]
    collected = Diagnostics()
    collected.extend(suite.diagnostics)
    if errors:
        tag = "error" if collected.exit_code == 2 else "failure"
        failure = ET.SubElement(case, tag, message=_clean(str(errors[0])), type=errors[0].code)
        failure.text = _clean("\n".join(map(str, errors)))
    others = [str(diagnostic) for diagnostic in suite.diagnostics if diagnostic.severity != "error"]
    if others:
        ET.SubElement(case, "system-out").text = _clean("\n".join(others))
    return case


def _check(robot: str, check: Mapping[str, Any]) -> ET.Element:
    subject = f"{check['file']} in {check['engine']}" if check["file"] else str(check["engine"])
    if check.get("against", "model") not in ("", "model"):  # files may be compared with several others
        subject += f" against {check['against']}"
    group = check["against"] if str(check.get("against", "")).startswith("module ") else check["format"] or "robot"
    classname = f"{robot}.{group}"
    case = ET.Element("testcase", classname=_clean(classname), name=_clean(f"{subject}: {check['quantity']}"))
    if check["status"] == "failed":
        why = str(check["why"] or check["where"])
        ET.SubElement(case, "failure", message=_clean(why), type=str(check["quantity"]))
    elif check["status"] == "not run":
        ET.SubElement(case, "skipped", message=_clean(str(check["why"])))
    elif check["deviation"] is not None:
        allowed = f"{check['deviation']} {check['unit']}, {check['tolerance']} allowed: {check['where']}"
        ET.SubElement(case, "system-out").text = _clean(allowed)
    return case


def _clean(text: str) -> str:
    """Text without the characters that XML does not allow."""
    return _NOT_IN_XML.sub("\ufffd", text)
