"""Conversion of a STEP that describes a kinematic mechanism in addition to its shapes."""

import json
import shutil
from pathlib import Path

import pytest

from tests.command_line import convert_once, stepbot
from tests.unit.step.exchange.test_mechanisms import add_mechanism


@pytest.mark.slow
def test_convert_a_step_with_a_mechanism(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, robot_library: Path
) -> None:
    """The mechanism in the STEP does not change the joints of the sidecar: equal files and checks as without it."""
    source = robot_library / "stepbot_four_bar"
    for file in ("four_bar.step", "four_bar.robot.yaml"):
        shutil.copy(source / file, tmp_path)
    add_mechanism(tmp_path / "four_bar.step")
    inspected = stepbot("inspect", "four_bar.step", cwd=tmp_path)
    assert "1; `stepbot init` drafts joints from them" in inspected.out + inspected.err
    run = stepbot("convert", "four_bar.robot.yaml", "-o", "out", "--json", cwd=tmp_path)
    assert run.code == 0, run.err
    plain = convert_once(tmp_path_factory, "stepbot_four_bar", source / "four_bar.robot.yaml")
    checks = json.loads(run.out)["report"]["checks"]
    assert checks
    assert checks == plain.report["checks"]
    files = [path.relative_to(plain.folder) for path in plain.folder.rglob("*") if path.suffix in (".xml", ".obj")]
    assert len(files) > 1
    for file in files:
        assert (tmp_path / "out" / file).read_bytes() == (plain.folder / file).read_bytes(), file
