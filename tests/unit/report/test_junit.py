"""JUnit XML for CI servers."""

from typing import Any
from xml.etree import ElementTree as ET

from stepbot.diagnostics import Diagnostics, Span
from stepbot.report.document import Suite, junit_bytes

CHECK = {
    "file": "arm.urdf",
    "format": "urdf",
    "engine": "mujoco",
    "quantity": "mass",
    "status": "passed",
    "deviation": 1e-12,
    "tolerance": 1e-9,
    "unit": "kg",
    "where": "link 'base'",
    "why": "",
}


def check(**changes: Any) -> dict[str, Any]:
    """A check of the report."""
    return {**CHECK, **changes}


def test_counts_and_cases() -> None:
    """The conversion and each check are one case each; failures and skipped checks are distinguished."""
    checks = [
        check(),
        check(quantity="com", status="failed", why="off by a lot"),
        check(quantity="load", status="not run", why="pybullet is not installed", deviation=None),
        check(file="", format="", engine="python-fcl", quantity="self-collision", deviation=None),
    ]
    root = ET.fromstring(junit_bytes([Suite("arm", checks, seconds=1.5)]))
    (suite,) = root
    assert (root.get("tests"), root.get("failures"), root.get("errors"), root.get("skipped")) == ("5", "1", "0", "1")
    assert suite.get("time") == "1.500"
    assert [case.get("name") for case in suite] == [
        "conversion",
        "arm.urdf in mujoco: mass",
        "arm.urdf in mujoco: com",
        "arm.urdf in mujoco: load",
        "python-fcl: self-collision",
    ]
    (failure,) = root.iter("failure")
    (skipped,) = root.iter("skipped")
    assert (failure.get("message"), skipped.get("message")) == ("off by a lot", "pybullet is not installed")


def test_errors_of_the_conversion() -> None:
    """A robot with errors fails its first case; one that could not be read is an error."""
    diagnostics, lost = Diagnostics(), Diagnostics()
    diagnostics.add("SB301", "no component 'x'", Span("a.robot.yaml", 3, 1))
    diagnostics.add("SB760:armature", "armatures are omitted", Span("a.urdf"))
    lost.add("SB001", "no file", Span("b.robot.yaml"))
    root = ET.fromstring(junit_bytes([Suite("a", [], tuple(diagnostics)), Suite("b", [], tuple(lost))]))
    assert (root.get("failures"), root.get("errors")) == ("1", "1")
    (failure,) = root.iter("failure")
    assert failure.get("type") == "SB301"
    assert "armatures" in str(next(root.iter("system-out")).text)


def test_any_name_is_well_formed() -> None:
    """Names with markup and control characters give well-formed XML."""
    root = ET.fromstring(junit_bytes([Suite("<&\x00\x1b\ud800>\"'", [check(why="a\x07b", status="failed")])]))
    assert root[0].get("name") == "<&\ufffd\ufffd\ufffd>\"'"
