"""Each diagnostic code has an input that causes it, and the whole report about it, as text and as JSON."""

import json
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.diagnostics.codes import CODES
from tests.diagnostics.transcripts import Stage, folders, missing_engines

FOLDERS = folders()


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Stage:
    """A folder in which the commands run."""
    return Stage(tmp_path_factory.mktemp("stage"))


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_reports_what_is_expected(folder: Path, stage: Stage) -> None:
    """The input of a folder causes its code; the report and the exit code are as expected."""
    if missing := missing_engines(folder):
        pytest.skip("; ".join(missing))
    now = stage.transcript(folder)
    assert folder.name[:5] in now.codes
    assert now.diagnostics == json.loads((folder / "expected.json").read_text(encoding="utf-8"))
    assert now.text == (folder / "expected.txt").read_text(encoding="utf-8")
    if now.exit_code is not None:
        assert now.exit_code == exit_code_of(now.diagnostics)


def exit_code_of(diagnostics: list[dict[str, str]]) -> int:
    """The exit code required by a list of diagnostics."""
    found = Diagnostics()
    found.extend(Diagnostic(one["code"], one["severity"], one["message"], Span("file")) for one in diagnostics)
    return found.exit_code


def test_each_code_has_a_folder() -> None:
    """Every code has a folder."""
    assert {folder.name[:5] for folder in FOLDERS} == set(CODES)


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_places_are_in_the_file(folder: Path) -> None:
    """Every place within an input file exists, and its columns are within the line."""
    for one in json.loads((folder / "expected.json").read_text(encoding="utf-8")):
        source = folder / one["file"]
        if not one["line"] or not source.is_file():
            continue
        lines = source.read_bytes().decode("utf-8", "replace").splitlines()
        assert 1 <= one["line"] <= len(lines)
        assert 0 <= one["column"] <= len(lines[one["line"] - 1]) + 1  # 0 is the whole line
