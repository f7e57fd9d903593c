"""docs/first-hour.md: its commands print what it shows."""

import re
import shutil
from pathlib import Path

import pytest

from .console import COLUMNS, printed

PAGE = Path(__file__).parents[2] / "docs" / "first-hour.md"
STEP = "low_cost_robot_follower.step"
SIDECAR = "follower.robot.yaml"
LINES = 2 * 50
"""Lines of two screens."""

pytestmark = pytest.mark.slow


def blocks(kind: str) -> list[str]:
    """The fenced blocks of a kind."""
    return re.findall(rf"^```{kind}\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)


def session() -> list[tuple[list[str], list[str]]]:
    """Arguments of each command, and the lines that it prints."""
    found = []
    for block in blocks("console"):
        command, *lines = block.splitlines()
        prompt, program, *arguments = command.split()
        assert (prompt, program) == ("$", "stepbot")
        found.append((arguments, lines))
    return found


def test_fits_two_screens() -> None:
    """Inspect, sidecar, check and convert fit two screens, with all that is typed and printed."""
    lines = [line for kind in ("console", "yaml") for block in blocks(kind) for line in block.splitlines()]
    assert [arguments[0] for arguments, _ in session()] == ["inspect", "check", "convert"]
    assert len(lines) <= LINES
    assert max(map(len, lines)) <= COLUMNS


@pytest.mark.slow
def test_session(corpus: Path, tmp_path: Path) -> None:
    """Each command prints the page's lines; in the table of checks the installed engines may differ."""
    shutil.copy(corpus / STEP, tmp_path)
    (sidecar,) = blocks("yaml")
    (tmp_path / SIDECAR).write_text(sidecar, encoding="utf-8")
    for arguments, shown in session():
        assert comparable(printed(arguments, tmp_path).splitlines()) == comparable(shown)


def comparable(lines: list[str]) -> list[str]:
    """The lines without what depends on the installed engines: their names, and what stepbot's parsers confirm."""
    text = re.sub(r"(?m)^(proven: .*? match the CAD)[^=]*?\n(?=\d+ files in )", r"\1\n", "\n".join(lines))
    return text.splitlines()
