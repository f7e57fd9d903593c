"""File names that are not UTF-8: of the sidecar, the STEP, folders, the output and files to verify."""

import json
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from tests.command_line import Run, convert_once, snapshot, stepbot, stepbot_process

BAR = os.fsdecode(b"b\xe4r")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform != "linux", reason="file names are Unicode there")]


@pytest.fixture
def folder(tmp_path: Path, robot_library: Path) -> Path:
    """A folder with the four-bar; every name except that in the sidecar is Latin-1."""
    folder = tmp_path / os.fsdecode(b"caf\xe9") / "robots"
    folder.mkdir(parents=True)
    for number in range(2):
        source = robot_library / "stepbot_four_bar"
        (folder / f"{BAR}{number}").mkdir()
        shutil.copy(source / "four_bar.step", folder / f"{BAR}{number}")
        shutil.copy(source / "four_bar.robot.yaml", folder / f"{BAR}{number}" / f"{number}{BAR}.robot.yaml")
    shutil.copy(source / "four_bar.step", folder / f"{BAR}.step")
    return folder


def run(folder: Path, *arguments: str, run: Callable[..., Run] = stepbot) -> Run:
    """Run a command that must succeed; its output is read as UTF-8."""
    done = run(*arguments, cwd=folder)
    assert done.code == 0, done.err
    assert "Traceback" not in done.err
    return done


@pytest.mark.slow
def test_convert_proves_what_it_writes(
    folder: Path, tmp_path_factory: pytest.TempPathFactory, robot_library: Path
) -> None:
    """Files in all formats and all checks are those of a folder with UTF-8 names."""
    elsewhere = convert_once(
        tmp_path_factory, "stepbot_four_bar", robot_library / "stepbot_four_bar" / "four_bar.robot.yaml"
    )
    sidecar, output = f"{BAR}0/0{BAR}.robot.yaml", os.fsdecode(b"o\xfct")
    document = json.loads(run(folder, "convert", sidecar, "-o", output, "--json").out)
    assert document["report"]["checks"] == elsewhere.report["checks"]
    assert document["output"] == output
    written, expected = snapshot(folder / output), snapshot(elsewhere.folder)
    assert set(written) == set(expected)
    for name, content in written.items():
        assert content.decode("utf-8")
        if not name.endswith(".json"):
            assert content == expected[name]
    run(folder, "uptodate", sidecar, "-o", output)
    run(folder, "check", "--step", "--", sidecar)


@pytest.mark.long
def test_batch_and_inspect(folder: Path) -> None:
    """`batch` and `inspect` handle such names; their JUnit and JSON are valid."""
    reported = json.loads(run(folder, "batch", ".", "-o", BAR, "--json", "--no-verify", "--junit", "tests.xml").out)
    assert reported["summary"]["converted"] == 2
    ET.parse(folder / "tests.xml")
    for robot in (folder / BAR).glob("*/*.urdf"):
        ET.parse(robot)
    run(folder, "uptodate", ".", "-o", f"{BAR}/{{name}}")
    assert json.loads(run(folder, "inspect", f"{BAR}.step", "--json", run=stepbot_process).out)
    assert "crank" in run(folder, "inspect", f"{BAR}.step").out


@pytest.mark.long
def test_verify_gives_engines_names_that_they_can_open(
    folder: Path, tmp_path_factory: pytest.TempPathFactory, robot_library: Path
) -> None:
    """`verify` passes files and meshes to engines by names that they can open."""
    elsewhere = convert_once(
        tmp_path_factory, "stepbot_four_bar", robot_library / "stepbot_four_bar" / "four_bar.robot.yaml"
    )
    suffixes = (".urdf", ".sdf", ".xml")
    plain = json.loads(run(elsewhere.folder, "verify", *(f"four_bar{one}" for one in suffixes), "--json").out)
    for file in elsewhere.folder.glob("four_bar.*"):
        shutil.copy(file, folder / f"{BAR}{file.suffix}")
        shutil.copy(file, folder)
    shutil.copytree(elsewhere.folder / "meshes", folder / "meshes")
    for name in ("four_bar", BAR):
        files = [f"{name}{one}" for one in suffixes]
        document = json.loads(run(folder, "verify", *files, "--json", "--junit", "tests.xml").out)
        checks = json.dumps(document["report"]["checks"])
        expected = json.dumps(plain["report"]["checks"])
        assert checks.replace(json.dumps(name)[1:-1], "four_bar") == expected
        ET.parse(folder / "tests.xml")
    (folder / "meshes" / "crank.obj").unlink()
    missing = stepbot("verify", *files, cwd=folder)
    assert missing.code == 1
    assert "crank" in missing.err
