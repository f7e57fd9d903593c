"""docs/use-it-in.md: the Python code of its last section runs on the robot that it exports, and the example learns."""

import re
import shlex
from pathlib import Path

import pytest

from stepbot_cli import main

pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install stepbot[learn]")

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "use-it-in.md").read_text(encoding="utf-8").partition("\n## Learning")[2]
EXAMPLES = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


@pytest.mark.slow
def test_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The exported arm becomes an environment; the examples print observations, distance, shape."""
    monkeypatch.chdir(tmp_path)
    (command,) = re.findall(r"^(stepbot library export ur5e .*?) *(?:#.*)?$", PAGE, re.MULTILINE)
    assert main([*shlex.split(command)[1:], "--no-verify"]) == 0
    capsys.readouterr()
    examples = [code for code in EXAMPLES if "import cma" not in code]
    assert len(examples) == 3
    printed = []
    for code in examples:
        exec(compile(code, "docs/use-it-in.md", "exec"), {"__name__": "example"})
        printed.append(capsys.readouterr().out)
    first, vector, own = printed
    assert re.search(r"^shoulder_pan_joint/position +-?\d\.\d{3} rad$", first, re.MULTILINE)
    assert re.search(r"^0\.\d{3} m from the target$|^1\.\d{3} m from the target$", first, re.MULTILINE)
    assert re.match(r"\(16, \d+\)\n", vector)
    assert float(own) >= 0.0


@pytest.mark.long
def test_arm_learns_to_reach(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The documented search raises the return and the share of targets reached."""
    pytest.importorskip("cma", reason="NO LEARNING IS TESTED: pip install stepbot[learn]")
    monkeypatch.chdir(tmp_path)
    assert main(["library", "export", "ur5e", "-f", "mjcf", "-o", "ur5e", "--no-verify"]) == 0
    capsys.readouterr()
    (code,) = (code for code in EXAMPLES if "import cma" in code)
    exec(compile(code.replace("range(30)", "range(6)"), "docs/use-it-in.md", "exec"), {"__name__": "example"})
    before, after = re.findall(r"return (\S+), reached (\d+)%", capsys.readouterr().out)
    assert float(after[0]) > float(before[0]) + 5.0
    assert int(after[1]) > int(before[1])
