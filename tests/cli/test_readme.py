"""The commands of the README and of docs/commands.md run, and print what is shown."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from stepbot.runtime.robot_library import library_robot
from stepbot_cli import main
from tests.corpus.test_first_hour import comparable

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")


def blocks(language: str, page: str = README) -> list[str]:
    """Code blocks of a page in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)


@pytest.fixture
def example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, robot_library: Path) -> Path:
    """A folder with the STEP of the example and the sidecar that the README shows."""
    (sidecar,) = blocks("yaml")
    (tmp_path / "arm.robot.yaml").write_text(sidecar, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("STEPBOT_NO_CACHE", "")
    monkeypatch.setenv("STEPBOT_CACHE", str(tmp_path / ".kept"))
    return tmp_path


def test_opens_with_two_commands() -> None:
    """The README starts with two commands that show a conversion."""
    assert blocks("sh")[0].splitlines()[0].startswith("make demo")
    assert blocks("sh")[0].splitlines()[1].startswith("make test")


@pytest.mark.slow
def test_example_runs(example: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Every command of the example succeeds, prints what the page shows, and writes the files it names."""
    commands = re.findall(
        r"^(?:\$ )?(stepbot .*)$", "\n".join(blocks("(?:sh|console)") + blocks("sh", COMMANDS)), re.MULTILINE
    )
    names = [command.split()[1] for command in commands]
    assert names == ["library", "init", "check", "convert", "batch", "uptodate"]
    shown = {command: lines for command, *lines in (block.splitlines() for block in blocks("console"))}
    assert len(shown) == 2
    monkeypatch.setenv("COLUMNS", "100")
    for command in commands:
        code = main(shlex.split(command)[1:])
        captured = capsys.readouterr()
        assert code == 0, captured.err
        if lines := shown.get(f"$ {command}"):
            *verdict, where = captured.out.rstrip("\n").splitlines()  # notes are counted before the last line
            printed = [*verdict, *captured.err.splitlines(), where]
            assert comparable(printed) == comparable(lines)
    written = {file.name for file in (example / "arm").iterdir()}
    assert {"arm.urdf", "arm.sdf", "arm.xml", "meshes", "report.json"} <= written
    assert written == {file.name for file in (example / "build" / "arm").iterdir()}
    assert (example / "build" / "junit.xml").is_file()


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
def test_rule_in_a_makefile(example: Path) -> None:
    """The Makefile rule converts if its stamp is older than the input, also from the cache, and only once."""
    shutil.copy(library_robot("arm2").step, example)
    (rule,) = blocks("make", COMMANDS)
    command = f"{shlex.quote(sys.executable)} -m stepbot_cli convert --no-verify"
    (example / "Makefile").write_text(rule.replace("stepbot convert", command), encoding="utf-8")

    def is_made() -> bool:
        run = subprocess.run(["make"], cwd=example, capture_output=True, text=True, check=True, timeout=600)
        return "is up to date" not in run.stdout

    assert is_made()
    assert not is_made()
    os.utime(example / "arm" / ".stepbot.json", (1e9, 1e9))  # older than all input, which is otherwise unchanged
    assert is_made()
    assert not is_made()


@pytest.mark.slow
def test_what_a_core_install_does_not_prove_of_sdformat(example: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Beside stepbot's parser, PyBullet confirms SDFormat except for the README's list, which Drake would confirm."""
    shutil.copy(library_robot("arm2").step, example)
    assert main(["convert", "arm.robot.yaml", "-f", "sdf"]) == 0, capsys.readouterr().err
    checks = json.loads((example / "arm" / "report.json").read_bytes())["checks"]
    confirmed: dict[str, set[str]] = {}
    for check in checks:
        if check["format"] == "sdf" and check["status"] == "passed":
            confirmed.setdefault(check["engine"], set()).add(check["quantity"])
    apart = {"inertia", "mass matrix", "mimic", "frames", "actuators"}
    assert {"inertia", "mass matrix"} <= confirmed["reader"]  # this arm has no mimics, frames or actuators
    assert confirmed.get("pybullet", set()).isdisjoint(apart)
    assert set(confirmed) <= {"reader", "pybullet", "drake", "libsdformat"}


def test_fault_looks_as_shown(example: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The error in the README is printed literally."""
    (shown,) = [block for block in blocks("text") if "error[" in block]
    sidecar = example / "arm.robot.yaml"
    text = sidecar.read_text(encoding="utf-8")
    sidecar.write_text(text.replace("child: forearm", "child: forarm"), encoding="utf-8")
    (example / "arm").mkdir()
    assert main(["convert", "arm.robot.yaml", "-o", "arm"]) == 1
    captured = capsys.readouterr()
    assert captured.out + captured.err == shown


def test_links_lead_somewhere() -> None:
    """Every file that the documentation links to exists."""
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "robot_library").rglob("*.md")]
    broken = [
        f"{page.relative_to(ROOT)}: {target}"
        for page in pages
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
        if not (page.parent / target).exists()
    ]
    assert not broken


def test_sidecar_page_is_valid(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The first sidecar in docs/sidecar.md is valid."""
    page = (ROOT / "docs" / "sidecar.md").read_text(encoding="utf-8")
    sidecar = tmp_path / "arm.robot.yaml"
    sidecar.write_text(re.findall(r"^```yaml\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)[0], encoding="utf-8")
    assert main(["check", str(sidecar)]) == 0, capsys.readouterr().out
