"""Each code that a sidecar alone can cause: a sidecar that causes it, and all that is said about it.

A folder is named after its code and holds ``robot.robot.yaml`` and ``expected.txt``; a sidecar that is too large to
keep is the ``CONTENT`` of ``make.py``. ``STEPBOT_UPDATE=1`` writes ``expected.txt`` anew: read the difference.
"""

import os
import runpy
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.diagnostics.codes import mechanism, sidecar
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import load_sidecar

HERE = Path(__file__).parent
CODES = {code.id: code for code in (*sidecar.CODES, *mechanism.CODES)}
FOLDERS = sorted(folder for folder in HERE.iterdir() if folder.is_dir() and folder.name[:5] in CODES)


def transcript(folder: Path) -> tuple[str, set[str]]:
    """What is said about the folder's sidecar, and the codes in it."""
    path = Path("robot.robot.yaml")
    if not (folder / path).exists():
        path.write_bytes(runpy.run_path(str(folder / "make.py"))["CONTENT"])
    else:
        path.write_bytes((folder / path).read_bytes())
    found = Diagnostics()
    loaded = load_sidecar(path, found)
    if loaded is not None:
        check_sidecar(loaded, found)
    lines = []
    for diagnostic in found:
        lines.append(str(diagnostic))
        lines += [f"  help: {line}" for line in diagnostic.help]
        lines += [f"  note: {line}" for line in diagnostic.notes]
    return "\n".join(lines) + "\n", {diagnostic.code for diagnostic in found}


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_says_what_is_expected(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The sidecar of a folder draws its code, and every line that is said about it is the expected one."""
    monkeypatch.chdir(tmp_path)
    text, codes = transcript(folder)
    expected = folder / "expected.txt"
    if os.environ.get("STEPBOT_UPDATE"):
        expected.write_text(text, encoding="utf-8", newline="\n")
    assert folder.name[:5] in codes
    assert text == expected.read_text(encoding="utf-8")


NEEDS_A_WHOLE_RUN = {"SB142"}
"""Whether a rule of `ignore_findings` is unused is known only after everything else."""


def test_each_code_has_a_folder() -> None:
    """No code is without a sidecar that draws it."""
    assert {folder.name[:5] for folder in FOLDERS} == set(CODES) - NEEDS_A_WHOLE_RUN


@pytest.mark.parametrize("folder", [f for f in FOLDERS if not (f / "make.py").exists()], ids=lambda folder: folder.name)
def test_places_are_in_the_file(folder: Path) -> None:
    """Every place that is given lies within the file, and its columns mark a part of the line."""
    content = (folder / "robot.robot.yaml").read_bytes().decode("utf-8", "replace").splitlines()
    for line in (folder / "expected.txt").read_text(encoding="utf-8").splitlines():
        place = line.split(": ")[0].split(":")
        if line.startswith("  ") or len(place) < 3:
            continue
        row, column = int(place[1]), int(place[2])
        assert 1 <= row <= len(content)
        assert 1 <= column <= len(content[row - 1]) + 1
