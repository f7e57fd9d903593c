"""``--encoding`` and ``step_encoding``: names in a code page, from the STEP to the files."""

import json
from pathlib import Path

import pytest

from tests import parts, solids

from .conftest import Stepbot

SIDECAR = """\
version: 1
robot: crate
step: crate.step
{encoding}
defaults: {{density: 1000 kg/m^3}}
links:
  crate: {{parts: ["螺丝"]}}
"""


@pytest.fixture
def crate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a STEP whose root and only component have Chinese names in GBK."""
    from robot_library.moments import pose
    from robot_library.step_file import Assembly, Occurrence

    screw = parts.drawn("SCREW", solids.box(10, 20, 30))
    parts.draw(tmp_path / "crate.step", Assembly("CRATE", [Occurrence(screw, "SCREW:1", pose())]))
    content = (tmp_path / "crate.step").read_bytes()
    for name, text in (("SCREW", "螺丝"), ("CRATE", "箱")):
        content = content.replace(name.encode(), text.encode("gbk"))
    (tmp_path / "crate.step").write_bytes(content)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_sidecar(folder: Path, encoding: str = "") -> None:
    """Write the sidecar, with its line about the encoding."""
    (folder / "crate.robot.yaml").write_text(SIDECAR.format(encoding=encoding), encoding="utf-8")


@pytest.mark.slow
def test_inspect(crate: Path, stepbot: Stepbot) -> None:
    """`inspect --encoding` decodes paths and names; without the option a warning suggests code pages."""
    run = stepbot("inspect", "crate.step", "--encoding", "GBK")
    assert (run.code, run.err) == (0, "")
    assert "encoding: gbk, as declared" in run.out
    assert '"螺丝"' in run.out
    assert "  '螺丝'\n" in run.out
    run = stepbot("inspect", "crate.step")
    assert run.code == 0
    assert "warning[SB210]" in run.err
    assert "in gb18030 the first reads '箱'" in run.err


def test_the_sidecar_declares_it(crate: Path, stepbot: Stepbot) -> None:
    """Names in the sidecar bind to decoded names of the STEP, without warnings."""
    write_sidecar(crate, "step_encoding: gbk")
    run = stepbot("convert", "crate.robot.yaml", "--no-verify", "-o", "out", "--json")
    document = json.loads(run.out)
    assert run.code == 0, document
    assert not [d for d in document["diagnostics"] if d["severity"] != "note"]
    assert document["report"]["robot"]["links"][0]["components"] == ["螺丝"]
    assert stepbot("check", "--step", "crate.robot.yaml").code == 0


@pytest.mark.slow
def test_the_command_line_overrules_the_sidecar(crate: Path, stepbot: Stepbot) -> None:
    """`--encoding` overrides the sidecar; with a wrong code page, names that match nothing are errors."""
    write_sidecar(crate, "step_encoding: cp949")
    assert stepbot("check", "--step", "crate.robot.yaml").code == 1
    assert stepbot("check", "--encoding", "gbk", "--step", "crate.robot.yaml").code == 0
    write_sidecar(crate)
    run = stepbot("check", "--step", "crate.robot.yaml")
    assert run.code == 1
    assert "SB210" in run.out


@pytest.mark.parametrize("command", [["inspect", "crate.step"], ["check", "x.yaml"], ["convert", "x.yaml"]])
def test_no_such_code_page(command: list[str], crate: Path, stepbot: Stepbot) -> None:
    """An unknown code page is a usage error with similar names."""
    run = stepbot(*command, "--encoding", "cp1521")
    assert run.code == 2
    assert "unknown code page 'cp1521'; did you mean" in run.err
    assert "'cp1251'" in run.err


def test_no_such_code_page_in_the_sidecar(crate: Path, stepbot: Stepbot) -> None:
    """An unknown code page in the sidecar is reported at its line."""
    write_sidecar(crate, "step_encoding: utf-16")
    run = stepbot("check", "crate.robot.yaml", "--concise")
    assert run.code == 1
    assert "crate.robot.yaml:4:16: error[SB123]: step_encoding: code page 'utf-16' is not ASCII-compatible" in run.out
