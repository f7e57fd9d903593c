"""The output of ``stepbot`` for the input of a folder, as JSON and as text, normalized to be equal on every machine.

A folder ``SBnnn_slug`` has an input that causes the diagnostic SBnnn, and the expected output:

- ``command``: the arguments of ``stepbot``; without this file ``check robot.robot.yaml``.
- ``make.py``, if the input is not text: ``make(patch)`` writes it to the current folder, and may change the environment
  with ``patch``, a ``pytest.MonkeyPatch``. If no command can cause the diagnostic, ``find(found)`` calls the library
  instead.
- ``engines``: names of required engines other than :data:`CORE`. Without them the folder is skipped.
- all other files: input, copied to the folder that the command runs in.
- ``expected.json``: the diagnostics, as printed by ``--json``; ``expected.txt``: the same, as printed by ``--verbose``.

``python -m tests.diagnostics.update [SBnnn...]`` rewrites the expected files; review the difference.
"""

import io
import json
import os
import re
import runpy
import shlex
import shutil
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import pytest
from msgspec import Struct

import stepbot
from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.engines import engine_of, engines
from stepbot_cli import main
from stepbot_cli.diagnostic_text import full, plain

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
if str(ROOT) not in sys.path:  # the command line removes the current folder
    sys.path.append(str(ROOT))
NOT_INPUT = ("command", "engines", "expected.json", "expected.txt", "make.py", "__pycache__")
CORE = ("extensions", "mujoco", "reader", "yourdfpy")
"""Engines that every installation has; others are disabled unless a folder names them."""
Plain = dict[str, Any]
"""A diagnostic as ``--json`` prints it."""


class Transcript(Struct, frozen=True):
    """The output of a command."""

    diagnostics: list[Plain]
    text: str
    exit_code: int | None
    """None if no command ran."""

    @property
    def codes(self) -> set[str]:
        """The codes of the diagnostics."""
        return {one["code"].partition(":")[0] for one in self.diagnostics}

    @property
    def json(self) -> str:
        """Content of ``expected.json``."""
        return json.dumps(self.diagnostics, indent=2, ensure_ascii=False) + "\n"


def copy_library_robot(folder: str, name: str, *changes: tuple[str, str]) -> None:
    """Copy the STEP and the sidecar of a robot of the library here, the sidecar with some texts replaced."""
    source = ROOT / "robot_library" / folder
    step, sidecar = f"{name}.step", f"{name}.robot.yaml"
    Path(step).write_bytes((source / step).read_bytes())
    text = (source / sidecar).read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    Path(sidecar).write_text(text, encoding="utf-8", newline="\n")


def folders() -> list[Path]:
    """The folders of all transcripts, by name."""
    return sorted(path for path in HERE.glob("SB[0-9][0-9][0-9]_*") if path.is_dir())


def arguments(folder: Path) -> list[str]:
    """The arguments of ``stepbot`` in a folder; none if the library is called."""
    command = folder / "command"
    if command.exists():
        return shlex.split(command.read_text(encoding="utf-8"))
    return [] if "find" in _made(folder) else ["check", "robot.robot.yaml"]


def missing_engines(folder: Path) -> list[str]:
    """Engines that a folder needs and that are not installed, each with the reason."""
    reasons = ((name, engine_of(name).available()) for name in (*CORE, *_more_engines(folder)))
    return [f"{name}: {reason}" for name, reason in reasons if reason is not None]


class Stage:
    """The folder that all commands run in, one after the other."""

    def __init__(self, scratch: Path) -> None:
        self.scratch = scratch

    def transcript(self, folder: Path) -> Transcript:
        """Run the command of a folder in an empty folder."""
        self._set(folder)
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(self.scratch)
            patch.setenv("STEPBOT_NO_CACHE", "1")
            patch.delenv("COLUMNS", raising=False)
            for engine in engines():
                if engine.name not in (*CORE, *_more_engines(folder)):
                    patch.setattr(engine, "available", lambda name=engine.name: f"{name} is not installed")
            made = _made(folder)
            if "make" in made:
                made["make"](patch)
            if "find" in made:
                found = Diagnostics()
                made["find"](found)
                diagnostics, exit_code = [plain(one) for one in found], None
            else:
                diagnostics, exit_code = _run([*arguments(folder), "--json"])
            same = [_same_everywhere(one, self.scratch) for one in diagnostics]
            text = full([_diagnostic(one) for one in same])
        return Transcript(same, _normalised(text, self.scratch) + "\n", exit_code)

    def _set(self, folder: Path) -> None:
        """Empty the folder, and copy the input there."""
        for path in self.scratch.iterdir():
            (shutil.rmtree if path.is_dir() and not path.is_symlink() else Path.unlink)(path)
        for path in folder.iterdir():
            if path.name not in NOT_INPUT:
                (shutil.copytree if path.is_dir() else shutil.copyfile)(path, self.scratch / path.name)


def _made(folder: Path) -> dict[str, Any]:
    path = folder / "make.py"
    return runpy.run_path(str(path)) if path.exists() else {}


def _more_engines(folder: Path) -> list[str]:
    path = folder / "engines"
    return path.read_text(encoding="utf-8").split() if path.exists() else []


def _run(command: list[str]) -> tuple[list[Plain], int]:
    """Run ``stepbot`` in this process."""
    out = io.StringIO()
    with redirect_stdout(out), redirect_stderr(io.StringIO()):
        exit_code = main(command)
    document = json.loads(out.getvalue())
    assert document["exit_code"] == exit_code
    return document["diagnostics"], exit_code


def _diagnostic(one: Plain) -> Diagnostic:
    span = Span(one["file"], one["line"], one["column"], one["end_column"])
    return Diagnostic(one["code"], one["severity"], one["message"], span, tuple(one["help"]), tuple(one["notes"]))


# Text that differs between machines and versions is normalized here, and only here.

_NORMALISED: tuple[tuple[str, str], ...] = (
    (re.escape(stepbot.__version__), "VERSION"),
    (r"\bCPython \d+\.\d+\.\d+|\bPython \d+\.\d+(\.\d+)?", "PYTHON"),
    (r"\b(MuJoCo|mujoco|PyBullet|pybullet|yourdfpy|lxml|numpy) \d+(\.\d+)+", r"\1 VERSION"),
    (r"0x[0-9a-f]{6,}", "ADDRESS"),
    (r"\bpid \d+", "pid NUMBER"),
    (r"\bentries-\d+/[0-9a-f]+", "entries/HASH"),
    # Digits that depend on the version of the kernel or an engine: below 1e-9, and all after the third of six or more.
    (r"(?<![\w.])-?\d(\.\d+)?e-(1[0-9]|[2-9]\d)\b", "TINY"),
    (r"(?<![\w.])(-?0\.0*[1-9]\d\d)\d{3,}(e[-+]\d+)?(?!\w)", r"\1…\2"),
    (r"(?<![\w.])(-?[1-9]\d*\.\d\d)\d{4,}(e[-+]\d+)?(?!\w)", r"\1…\2"),
)


def _normalised(text: str, scratch: Path) -> str:
    """``text`` without local folders, versions, addresses, and digits that depend on them."""
    for path, name in ((scratch.resolve(), "FOLDER"), (scratch, "FOLDER"), (ROOT, "CHECKOUT")):
        text = text.replace(path.as_posix(), name).replace(str(path), name)
    text = text.replace(os.path.expanduser("~") + os.sep, "HOME/")  # noqa: PTH111 - a prefix of a text
    for pattern, replacement in _NORMALISED:
        text = re.sub(pattern, replacement, text)
    return text


def _same_everywhere(one: Plain, scratch: Path) -> Plain:
    """A diagnostic with normalized texts; its place is kept, so that the text can show the line."""
    texts = {key: _normalised(one[key], scratch) for key in ("message",)}
    lists = {key: [_normalised(text, scratch) for text in one[key]] for key in ("help", "notes")}
    file = one["file"] if not Path(one["file"]).is_absolute() else _normalised(one["file"], scratch)
    return {**one, **texts, **lists, "file": file}
