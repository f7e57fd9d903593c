"""``stepbot uptodate``: written files against those that would be written now, byte by byte."""

import json
import os
import shutil
from pathlib import Path

import pytest

from tests import command_line

from .conftest import Stepbot

CONVERT = ("convert", "arm2.robot.yaml", "-o", "out/arm2")
UPTODATE = ("uptodate", "-o", "out/{name}", "--concise")


@pytest.fixture(scope="module")
def converted(tmp_path_factory: pytest.TempPathFactory, robot_library: Path) -> Path:
    """A folder with a robot, its output without the report, as in a repository, and the cache."""
    folder = tmp_path_factory.mktemp("converted")
    for file in ("arm2.robot.yaml", "arm2.step"):
        shutil.copy(robot_library / "stepbot_arm2" / file, folder)
    changes = {"STEPBOT_NO_CACHE": "", "STEPBOT_CACHE": str(folder / ".kept")}
    run = command_line.stepbot(*CONVERT, "--no-verify", cwd=folder, changes=changes)
    assert run.code == 0, run.err
    (folder / "out" / "arm2" / "report.json").unlink()
    return folder


@pytest.fixture
def written(converted: Path, arm: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of that output in the current folder, with the cache switched on."""
    shutil.copytree(converted, arm, dirs_exist_ok=True)
    monkeypatch.setenv("STEPBOT_NO_CACHE", "")
    monkeypatch.setenv("STEPBOT_CACHE", str(arm / ".kept"))
    return arm / "out" / "arm2"


@pytest.mark.slow
def test_changed_files_are_reported(written: Path, stepbot: Stepbot) -> None:
    """Current files cause no output; an edited, removed or obsolete file is reported."""
    run = stepbot(*UPTODATE)
    assert (run.code, run.out, run.err) == (0, "", "")
    urdf = written / "arm2.urdf"
    urdf.write_bytes(urdf.read_bytes().replace(b"\n", b"\r\n", 1))
    (written / "arm2.sdf").unlink()
    run = stepbot(*UPTODATE, "arm2.robot.yaml")
    assert run.code == 1
    assert [line.partition(": error[SB007]: ")[::2] for line in run.out.splitlines()] == [
        ("out/arm2/arm2.urdf", "differs from the current output"),
        ("out/arm2/arm2.sdf", "missing"),
    ]
    assert stepbot(*UPTODATE, "--exclude", "*.urdf", "--exclude", "*.sdf").code == 0
    assert not (written / "arm2.sdf").exists(), "it writes nothing"


def test_success_is_one_line(written: Path, stepbot: Stepbot) -> None:
    """Current files are reported as such, unless errors and warnings alone are asked for."""
    command = ("uptodate", "-o", "out/{name}")
    assert stepbot(*command).out == "ok: 1 output folder up to date\n"
    assert stepbot(*command, "-q").out == ""
    (written / "arm2.sdf").unlink()
    assert "ok:" not in stepbot(*command).out


@pytest.mark.slow
def test_edited_sidecar_and_left_over_mesh(written: Path, stepbot: Stepbot) -> None:
    """The current sidecar is compared, and files of an earlier run are reported."""
    sidecar = Path("arm2.robot.yaml")
    text = sidecar.read_text(encoding="utf-8")
    sidecar.write_text(text.replace("robot: arm2", "robot: arm3"), encoding="utf-8")
    run = stepbot(*UPTODATE)
    assert run.code == 1
    assert "out/arm2/arm3.urdf: error[SB007]: missing" in run.out
    assert "out/arm2/arm2.urdf: error[SB007]: no longer written" in run.out


def test_invalid_sidecar_is_reported_as_such(written: Path, stepbot: Stepbot) -> None:
    """An invalid sidecar is reported instead of the missing files."""
    Path("arm2.robot.yaml").write_text("version: 1\n", encoding="utf-8")
    run = stepbot(*UPTODATE)
    assert run.code == 1
    assert "SB121" in run.out
    assert "SB007" not in run.out


def test_nothing_to_compare(tmp_path: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder without sidecars is an error."""
    monkeypatch.chdir(tmp_path)
    assert stepbot("uptodate").code == 2
    assert stepbot("uptodate", "-o", "{robot}", "x.robot.yaml").code == 2


def test_missing_folder_is_one_error(written: Path, stepbot: Stepbot) -> None:
    """If nothing was written at all, one line reports it, with the command to run."""
    run = stepbot("uptodate", "-o", "my robots/{name}", "arm2.robot.yaml")
    assert run.code == 1
    assert run.out.count("SB007]") == 1
    assert "my robots/arm2: error[SB007]: output folder of" in run.out
    assert "`stepbot convert arm2.robot.yaml -o 'my robots/arm2'`" in run.out
    assert "SB001" in stepbot("uptodate", "-o", "my robots/{name}", "arm3.robot.yaml").out


@pytest.mark.parametrize("output", ["out/{name}", "elsewhere/{name}"], ids=["folder", "no folder"])
def test_step_instead_of_a_sidecar_is_one_error(output: str, written: Path, stepbot: Stepbot) -> None:
    """A STEP instead of a sidecar is SB102, with or without an output folder."""
    run = stepbot("uptodate", "-o", output, "--concise", "arm2.step")
    assert run.code == 1
    assert [line.partition("[")[2][:5] for line in run.out.splitlines()] == ["SB102"]


@pytest.mark.slow
def test_ignored_warnings_are_those_of_convert(written: Path, stepbot: Stepbot) -> None:
    """Output of `convert --strict --ignore CODE` is up to date for `uptodate` with the same options only."""
    sidecar = Path("arm2.robot.yaml")
    text = sidecar.read_text(encoding="utf-8")
    assert "friction: 0.02}" in text
    sidecar.write_text(text.replace("friction: 0.02}", "friction: 0.02, armature: 0.01}"), encoding="utf-8")
    assert stepbot(*CONVERT, "--no-verify", "--strict", "--ignore", "SB760:armature").code == 0
    run = stepbot(*UPTODATE, "--strict")
    assert run.code == 1
    assert "error[SB760:armature]" in run.out
    run = stepbot(*UPTODATE, "--strict", "--ignore", "SB760:armature")
    assert (run.code, run.out) == (0, "")
    assert "SB50" in stepbot(*UPTODATE, "--ignore", "SB50").err


def test_folder_is_found_by_its_list(written: Path, stepbot: Stepbot) -> None:
    """Output folders below the current folder are found by their file lists, and each is compared."""
    assert stepbot("uptodate", "--concise").code == 0
    assert stepbot("convert", "arm2.robot.yaml", "--no-verify").code == 0
    assert stepbot("uptodate", "--concise").code == 0
    (written / "arm2.sdf").unlink()
    Path("arm2", "arm2.urdf").unlink()
    run = stepbot("uptodate", "--concise")
    assert [line.partition(": error[SB007]: ")[::2] for line in run.out.splitlines()] == [
        ("arm2/arm2.urdf", "missing"),
        ("out/arm2/arm2.sdf", "missing"),
    ]


@pytest.mark.slow
def test_batch_then_uptodate(written: Path, stepbot: Stepbot) -> None:
    """Output of `batch . -o build` is found without arguments, also for robots of one name in several folders."""
    shutil.rmtree("out")
    for folder in ("left", "right"):
        Path(folder).mkdir()
        shutil.copy("arm2.robot.yaml", folder)
        shutil.copy("arm2.step", folder)
    Path("arm2.robot.yaml").unlink()
    assert stepbot("batch", ".", "-o", "build", "--no-verify").code == 0
    run = stepbot("uptodate", "--concise")
    assert (run.code, run.out) == (0, "")
    Path("build", "left-arm2", "arm2.urdf").write_bytes(b"")
    run = stepbot("uptodate", "--concise")
    assert run.out == "build/left-arm2/arm2.urdf: error[SB007]: differs from the current output\n"
    assert stepbot("uptodate", "right", "--concise").code == 0


@pytest.mark.slow
def test_two_robots_in_one_folder(written: Path, stepbot: Stepbot) -> None:
    """Files of another robot in the same folder are not obsolete; its report is replaced with a warning."""
    text = Path("arm2.robot.yaml").read_text(encoding="utf-8")
    Path("arm3.robot.yaml").write_text(text.replace("robot: arm2", "robot: arm3"), encoding="utf-8")
    (written / "report.json").touch()
    first = stepbot("convert", "arm3.robot.yaml", "-o", "out/arm2", "--no-verify", "--concise")
    assert first.code == 0
    expected = (
        "out/arm2/report.json: warning[SB022]: the folder also has files of 'arm2', and report.json describes one robot"
    )
    assert expected in first.err.splitlines()
    (written / "report.json").unlink()
    run = stepbot("uptodate", "--concise")
    assert (run.code, run.out) == (0, "")


def test_paths_outside_of_the_project_stay_outside(
    written: Path, stepbot: Stepbot, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """The file list in a folder elsewhere does not name the sidecar: files contain no local paths."""
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    assert stepbot("convert", "arm2.robot.yaml", "-o", str(elsewhere), "--no-verify").code == 0
    assert "sidecars" not in json.loads((elsewhere / ".stepbot.json").read_bytes())
    assert json.loads((written / ".stepbot.json").read_bytes())["sidecars"]["arm2.urdf"] == "../../arm2.robot.yaml"


def test_stamp_is_newer_than_the_input(written: Path, stepbot: Stepbot) -> None:
    """After a conversion from the cache the file list is newer than the input; unchanged files keep their time."""
    for file in (*written.rglob("*"), written / ".stepbot.json"):
        os.utime(file, (1e9, 1e9))
    assert stepbot(*CONVERT, "--no-verify").code == 0
    assert (written / ".stepbot.json").stat().st_mtime >= Path("arm2.robot.yaml").stat().st_mtime
    assert (written / "arm2.urdf").stat().st_mtime == 1e9


@pytest.mark.slow
def test_stamp_of_an_unchanged_robot_of_a_batch(written: Path, stepbot: Stepbot) -> None:
    """A robot that a batch finds unchanged gets a new stamp, too."""
    assert stepbot("batch", ".", "-o", "build", "--no-verify").code == 0
    listed = Path("build", "arm2", ".stepbot.json")
    os.utime(listed, (1e9, 1e9))
    assert "unchanged" in stepbot("batch", ".", "-o", "build", "--no-verify").out
    assert listed.stat().st_mtime >= Path("arm2.robot.yaml").stat().st_mtime


@pytest.mark.slow
def test_other_engines_make_no_difference(written: Path, stepbot: Stepbot) -> None:
    """The robot of a report is compared, not the proof, which depends on the installed engines."""
    assert stepbot(*CONVERT).code == 0
    shutil.rmtree(".kept")
    assert stepbot("uptodate").code == 0
    report = written / "report.json"
    proven = json.loads(report.read_bytes())
    assert proven["summary"]["passed"] > 0
    engine = next(iter(proven["engines"]))
    there = {**proven, "engines": {engine: "0.1"}, "generator": "stepbot 0.0.1"}
    there["checks"] = [check for check in proven["checks"] if check["engine"] == engine]
    report.write_text(json.dumps(there), encoding="utf-8")
    run = stepbot("uptodate")
    assert (run.code, run.out) == (0, "ok: 1 output folder up to date\n")
    there["robot"]["mass"] *= 1.001
    report.write_text(json.dumps(there), encoding="utf-8")
    run = stepbot("uptodate")
    assert run.code == 1
    assert "out/arm2/report.json: error[SB007]" in run.out
    report.write_text("{}", encoding="utf-8")
    assert stepbot("uptodate").code == 1


def test_formats_of_an_earlier_run(written: Path, stepbot: Stepbot) -> None:
    """A conversion to fewer formats names the files that it leaves; the remedies of `uptodate` name these formats."""
    arguments = ("convert", "arm2.robot.yaml", "-o", "out/arm2", "--no-verify", "-f", "urdf", "--concise")
    run = stepbot(*arguments)
    kept = (
        "out/arm2: note[SB023]: 'arm2.scene.xml', 'arm2.sdf', 'arm2.world.sdf', 'arm2.xml': from an earlier conversion"
    )
    assert run.code == 0
    assert kept in run.err
    (written / "arm2.urdf").write_bytes(b"")
    found = json.loads(stepbot("uptodate", "-o", "out/{name}", "-f", "urdf", "--json").out)["diagnostics"]
    helps = {one["file"].rpartition("/")[2]: one["help"] for one in found if one["code"] == "SB007"}
    assert helps["arm2.urdf"] == ["`stepbot convert arm2.robot.yaml -o out/arm2 -f urdf`"]
    assert helps["arm2.sdf"] == ["remove it, or add sdf to `-f` of `uptodate`"]
    for name in ("arm2.scene.xml", "arm2.sdf", "arm2.world.sdf", "arm2.xml"):
        (written / name).unlink()
    assert "SB023" not in stepbot(*arguments).err


@pytest.mark.parametrize(
    "template", ["{name.foo}", "{name[0]}", "{name!r}", "{name:9}", "{}", "{0}", "{other}", "{", "a}"]
)
@pytest.mark.parametrize("command", ["uptodate", "batch"])
@pytest.mark.usefixtures("arm")
def test_templates_of_folders(stepbot: Stepbot, command: str, template: str) -> None:
    """`batch` and `uptodate` take the same placeholders, and refuse the same others as a wrong option."""
    run = stepbot(command, "arm2.robot.yaml", "-o", f"other/{template}")
    assert run.code == 2
    assert "placeholder" in run.err
    assert "Traceback" not in run.err
    assert not Path("other").exists()


@pytest.mark.slow
def test_one_template_for_batch_and_uptodate(written: Path, stepbot: Stepbot) -> None:
    """What `batch` writes by a template, `uptodate` finds by it."""
    assert stepbot("batch", "arm2.robot.yaml", "-o", "other/{name}/files", "-f", "urdf", "--no-verify").code == 0
    assert Path("other/arm2/files/arm2.urdf").is_file()
    assert Path("other/.stepbot-batch").is_dir()
    assert stepbot("uptodate", "arm2.robot.yaml", "-o", "other/{name}/files", "-f", "urdf").code == 0
