"""``stepbot library``: the robots that come with stepbot."""

import json
from fnmatch import fnmatch
from pathlib import Path
from urllib.request import url2pathname

import pytest

from .conftest import Stepbot


def test_list_names_every_robot(stepbot: Stepbot, robot_library: Path) -> None:
    """`library list` has one line per robot; JSON has the same."""
    run = stepbot("library", "list")
    assert run.code == 0
    found = sorted(robot_library.glob("*/*.robot.yaml"))
    names = [path.name.partition(".")[0] if path.parent.name == "composed" else path.parent.name for path in found]
    assert [line.split()[0] for line in run.out.splitlines()] == names
    document = json.loads(stepbot("library", "list", "--json").out)
    assert [robot["name"] for robot in document["robots"]] == names
    assert all(Path(robot["step"]).is_file() for robot in document["robots"] if robot["step"] is not None)
    assert all(Path(robot["page"]).is_file() for robot in document["robots"])


def test_show_lists_joints_links_and_files(stepbot: Stepbot, robot_library: Path) -> None:
    """`library show` summarizes a robot's page; the maker's name is optional."""
    run = stepbot("library", "show", "ur5e")
    assert run.code == 0
    assert run.out == stepbot("library", "show", "universal_robots_ur5e").out
    assert "\nwrist_3_joint " in run.out
    assert "\nforearm_link " in run.out
    assert str(robot_library / "universal_robots_ur5e" / "ur5e.robot.yaml") in run.out
    document = json.loads(stepbot("library", "show", "ur5e", "--json").out)
    assert document["name"] == "universal_robots_ur5e"


@pytest.mark.parametrize(
    ("name", "remedy"), [("ur5", "did you mean 'ur5e'?"), ("x", "list all robots with `stepbot library list`")]
)
def test_unknown_robot_is_wrong_usage(name: str, remedy: str, stepbot: Stepbot) -> None:
    """An unknown robot is a usage error with similar names or all names."""
    run = stepbot("library", "show", name)
    assert (run.code, run.out) == (2, "")
    assert remedy in " ".join(run.err.split())


@pytest.mark.parametrize("command", ["convert", "check", "view"])
def test_robots_of_the_library_are_exported_first(command: str, stepbot: Stepbot) -> None:
    """`library:NAME` is a module's file; commands answer how to get its files."""
    run = stepbot(command, "library:arm2")
    assert run.code == 2
    assert "`stepbot library export arm2` converts it" in run.out + run.err


@pytest.mark.slow
def test_export_of_the_source(
    stepbot: Stepbot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, robot_library: Path
) -> None:
    """`library export` writes STEP, sidecar and schema; the sidecar converts; changed files are kept."""
    monkeypatch.chdir(tmp_path)
    run = stepbot("library", "export", "arm2", "--source")
    assert (run.code, run.err) == (0, "")
    assert run.out.splitlines() == [
        "arm2/arm2.step",
        "arm2/arm2.robot.yaml",
        "arm2/robot-1.schema.json",
        "next: stepbot view arm2/arm2.robot.yaml",
    ]
    original = robot_library / "stepbot_arm2"
    assert (tmp_path / "arm2" / "arm2.step").read_bytes() == (original / "arm2.step").read_bytes()
    sidecar = tmp_path / "arm2" / "arm2.robot.yaml"
    text = sidecar.read_text(encoding="utf-8")
    first, _, rest = text.partition("\n")
    assert first == "# yaml-language-server: $schema=robot-1.schema.json"
    assert rest == (original / "arm2.robot.yaml").read_text(encoding="utf-8").partition("\n")[2]
    assert (tmp_path / "arm2" / "robot-1.schema.json").read_text(encoding="utf-8") == stepbot("schema").out
    assert stepbot("check", "--step", "arm2/arm2.robot.yaml").code == 0
    assert stepbot("library", "export", "arm2", "--source").code == 0, "the same again is no conflict"
    schema = tmp_path / "arm2" / "robot-1.schema.json"
    schema.write_text(stepbot("schema").out.replace("version 1", "version 1, an older text"), encoding="utf-8")
    assert stepbot("library", "export", "arm2", "--source").code == 0, "the schema is ours to renew"
    assert schema.read_text(encoding="utf-8") == stepbot("schema").out
    sidecar.write_text(text + "# mine\n", encoding="utf-8")
    (tmp_path / "arm2" / "arm2.step").unlink()
    run = stepbot("library", "export", "arm2", "--source")
    assert run.code == 2
    assert "arm2/arm2.robot.yaml: error[SB004]" in run.out + run.err
    assert sidecar.read_text(encoding="utf-8").endswith("# mine\n")
    assert not (tmp_path / "arm2" / "arm2.step").exists()
    assert stepbot("library", "export", "arm2", "--source", "-f", "urdf").code == 2
    document = json.loads(stepbot("library", "export", "arm2", "--source", "-o", "b", "--json").out)
    assert document["files"] == ["arm2.robot.yaml", "arm2.step", "robot-1.schema.json"]


def test_settings_of_an_editor_point_to_the_schema(stepbot: Stepbot) -> None:
    """`schema --vscode` refers to an existing schema file, with patterns that match sidecars."""
    settings = json.loads(stepbot("schema", "--vscode").out)["yaml.schemas"]
    ((uri, patterns),) = settings.items()
    path = Path(url2pathname(uri.removeprefix("file://")))
    assert path.read_text(encoding="utf-8") == stepbot("schema").out
    assert all(any(fnmatch(name, pattern) for pattern in patterns) for name in ("arm.robot.yaml", "robot.yml"))


@pytest.mark.slow
def test_export_writes_what_was_asked_for(stepbot: Stepbot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`export -f` writes one format with meshes and report to the current folder."""
    monkeypatch.chdir(tmp_path)
    run = stepbot("library", "export", "four_bar", "-f", "mjcf", "--no-verify")
    assert run.code == 0, run.err
    written = {path.name for path in (tmp_path / "four_bar").iterdir() if not path.name.startswith(".")}
    assert written == {"four_bar.scene.xml", "four_bar.xml", "meshes", "report.json"}
    assert stepbot("library", "export", "four_bar", "-f", "nope").code == 2
