"""Written files that no installed engine reads."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engines_for
from stepbot.engines.workers import Fate, Outcome
from stepbot.report.robot import Status
from stepbot.verification.conversion import Provers, verify
from stepbot.verification.judging import checks_within
from tests.conftest import ReadDiagnostics
from tests.robots import four_bar, one_link
from tests.simulators.conftest import write


def test_openusd_without_its_library_is_reported_with_the_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file is written; that nothing proves it is a warning that names the package, and no check passes."""
    for engine in engines_for("usd"):
        monkeypatch.setattr(engine, "available", lambda: "usd-core is not installed")
    folder = write(one_link(), tmp_path)
    found = ReadDiagnostics()
    with Provers(["usd"]) as provers:
        report = verify(folder.robot, {"usd": folder.written["usd"]}, provers, found, timeout=60.0)
    (unread,) = [one for one in found if one.code == "SB815"]
    assert unread.severity == "warning"
    assert unread.span.file == "one_link.usda"
    assert "pip install 'stepbot[usd]'" in unread.help
    assert {check.status for check in report.checks if check.format == "usd"} == {Status.NOT_RUN}


@pytest.mark.slow
def test_companions_for_optional_engines_alone_are_not_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Most installations lack Drake, so that a file for Drake alone is not worth a warning."""
    for engine in engines_for("drake.sdf"):
        monkeypatch.setattr(engine, "available", lambda: "drake is not installed")
    folder = write(four_bar(), tmp_path)
    diagnostics = Diagnostics()
    with Provers(["drake.sdf"]) as provers:
        verify(folder.robot, {"drake.sdf": folder.written["drake.sdf"]}, provers, diagnostics, timeout=60.0)
    assert [one.code for one in diagnostics if one.code == "SB815"] == []


@pytest.mark.parametrize(
    ("fates", "codes"), [([Fate.ABSENT, Fate.UNREADABLE], ["SB815"]), ([Fate.ABSENT, Fate.REFUSED], ["SB801"])]
)
def test_a_file_is_unread_unless_an_engine_refuses_it(fates: list[Fate], codes: list[str]) -> None:
    """That an engine rejects it is reported instead, and fails its check."""
    outcomes = [Outcome("a.sdf", "sdf", name, fate) for name, fate in zip(("drake", "pybullet"), fates, strict=True)]
    found = ReadDiagnostics()
    list(checks_within("a.sdf", outcomes, found))
    assert found.codes() == codes
