"""docs/learning.md: its Python code runs on the robot that it exports, and its commands are valid."""

import re
import shlex
from pathlib import Path

import pytest

from stepbot_cli import main

pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install stepbot[learn]")

from stepbot.gym.__main__ import argument_parser

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "learning.md").read_text(encoding="utf-8")


def test_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The exported arm becomes an environment; the examples print observations, distance, shape."""
    monkeypatch.chdir(tmp_path)
    (command,) = re.findall(r"^(stepbot library export ur5e .*?) *(?:#.*)?$", PAGE, re.MULTILINE)
    assert main([*shlex.split(command)[1:], "--no-verify"]) == 0
    capsys.readouterr()
    examples = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    assert len(examples) == 3
    printed = []
    for code in examples:
        exec(compile(code, "docs/learning.md", "exec"), {"__name__": "example"})
        printed.append(capsys.readouterr().out)
    first, vector, own = printed
    assert re.search(r"^shoulder_pan_joint/position +-?\d\.\d{3} rad$", first, re.MULTILINE)
    assert re.search(r"^0\.\d{3} m from the target$|^1\.\d{3} m from the target$", first, re.MULTILINE)
    assert re.match(r"\(16, \d+\)\n", vector)
    assert float(own) >= 0.0


def test_training_commands_are_valid() -> None:
    """Each command that trains has arguments that `python -m stepbot.gym` takes."""
    commands = re.findall(r"^python -m stepbot\.gym (.*)$", PAGE.replace("\\\n", " "), re.MULTILINE)
    assert commands
    for command in commands:
        argument_parser().parse_args(shlex.split(command))
