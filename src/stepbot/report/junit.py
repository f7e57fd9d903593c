"""Results as JUnit XML for CI servers: one suite per robot, one case per check.

The dialect is the one that Jenkins and GitLab read: https://github.com/testmoapp/junitxml.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as ET

from stepbot.diagnostics import Diagnostic, Diagnostics

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(frozen=True)
class Suite:
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
    errors = [one for one in suite.diagnostics if one.severity == "error"]
    collected = Diagnostics()
    collected.extend(suite.diagnostics)
    if errors:
        tag = "error" if collected.exit_code == 2 else "failure"
        failure = ET.SubElement(case, tag, message=_clean(str(errors[0])), type=errors[0].code)
        failure.text = _clean("\n".join(map(str, errors)))
    others = [str(one) for one in suite.diagnostics if one.severity != "error"]
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
