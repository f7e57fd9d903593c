"""docs/authoring.md: what it shows is what `stepbot init` drafts of a real arm, and what comes of it.

``python -m tests.corpus.test_authoring CORPUS`` writes the output of the commands into the page again.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from .console import printed

PAGE = Path(__file__).parents[2] / "docs" / "authoring.md"
STEP = "low_cost_robot_follower.step"
SIDECAR = "follower.robot.yaml"
CONSOLE = re.compile(r"^```console\n\$ (stepbot [^\n]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)

# `make test` drafts other assemblies: test_init.py.
pytestmark = pytest.mark.long


def blocks(kind: str, page: str) -> list[str]:
    """The fenced blocks of a kind."""
    return re.findall(rf"^```{kind}\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)


def edited(text: str, lines: str) -> str:
    """A text with the lines of a diff removed and inserted, after its context line, or at the end without one."""
    rows, at = text.splitlines(), len(text.splitlines())
    for line in lines.splitlines():
        if line.startswith("+"):
            rows.insert(at, line[1:])
            at += 1
        elif line.startswith("-"):
            at = rows.index(line[1:])
            del rows[at]
        elif line.startswith(" "):
            at = rows.index(line[1:]) + 1
        else:
            at = len(rows)
    return "\n".join([*rows, ""])


def session(page: str, corpus: Path, folder: Path) -> Iterator[str]:
    """Run the commands of the page in a folder, with its edit after the first; yields the output of each."""
    shutil.copy(corpus / STEP, folder)
    for number, (command, _) in enumerate(CONSOLE.findall(page)):
        if number == 1:
            (edit,) = blocks("diff", page)
            text = (folder / SIDECAR).read_text(encoding="utf-8")
            (folder / SIDECAR).write_text(edited(text, edit), encoding="utf-8")
        yield printed(command.split()[1:], folder)


def test_draft(corpus: Path, tmp_path: Path) -> None:
    """The first command prints the page's lines, and the draft has the page's joint."""
    page = PAGE.read_text(encoding="utf-8")
    assert next(session(page, corpus, tmp_path)) == CONSOLE.findall(page)[0][1]
    assert blocks("yaml", page)[0] in (tmp_path / SIDECAR).read_text(encoding="utf-8")


def test_session(corpus: Path, tmp_path: Path) -> None:
    """The commands print the page's lines with exit code 0, the draft has the page's joint, and the arm moves."""
    page = PAGE.read_text(encoding="utf-8")
    shown = [output for _, output in CONSOLE.findall(page)]
    assert list(session(page, corpus, tmp_path)) == shown
    assert blocks("yaml", page)[0] in (tmp_path / SIDECAR).read_text(encoding="utf-8")
    (code,), (printed,) = blocks("python", page), blocks("text", page)
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, encoding="utf-8", check=False)
    assert run.stdout == printed, run.stderr


def refresh(corpus: Path) -> None:
    """Write the output of the commands into the page."""
    page = PAGE.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        outputs = session(page, corpus, Path(folder))
        page = CONSOLE.sub(lambda block: f"```console\n$ {block[1]}\n{next(outputs)}```", page)
    PAGE.write_text(page, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    refresh(Path(sys.argv[1]))
