"""``stepbot verify`` on files of any origin."""

import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.rendering import render
from stepbot.runtime.output import write_atomically
from tests.robots import two_link_arm

from .conftest import Stepbot


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """A robot in every format, in the current folder."""
    robot = two_link_arm()
    for name in FORMATS:
        write_atomically(render(robot, name, Diagnostics()), tmp_path)
    monkeypatch.chdir(tmp_path)
    return [f"{robot.name}{writer.suffix}" for writer in FORMATS.values()]


@pytest.mark.slow
def test_same_robot_in_all_formats(files: list[str], stepbot: Stepbot) -> None:
    """Files of all formats agree, as the first line says; the table of -v names the reference of each comparison."""
    run = stepbot("verify", *files)
    assert run.code == 0, run.err
    first, _, engines = run.out.partition("\n")[0].partition(" are the same robot in ")
    assert first == f"equal: {', '.join(files[:-1])} and {files[-1]}"
    assert "MuJoCo" in engines  # after Drake, where that is installed
    verbose = stepbot("verify", "-v", *files[:2])
    assert any("compared with" in line for line in verbose.out.splitlines())
    assert " 0 failed" in verbose.out


@pytest.mark.slow
@pytest.mark.usefixtures("brief")
def test_a_folder_stands_for_the_files_of_its_robot(files: list[str], stepbot: Stepbot) -> None:
    """All of its formats are compared; a folder of two robots is reported, since they need not be the same."""
    run = stepbot("verify", ".")
    assert run.code == 0, run.err
    assert run.out.startswith(f"equal: {', '.join(files[:-1])} and {files[-1]} are the same robot")
    Path("other.urdf").write_bytes(Path(files[0]).read_bytes())
    two = stepbot("verify", ".")
    assert two.code == 2
    assert "SB001" in two.err
    assert "other.urdf" in two.err


@pytest.mark.slow
@pytest.mark.usefixtures("brief")
def test_other_mass_in_one_file(files: list[str], stepbot: Stepbot) -> None:
    """A file with another mass is reported, with exit code 1, in JSON and JUnit too."""
    urdf = Path(files[0])
    text = urdf.read_text(encoding="utf-8")
    urdf.write_text(text.replace('<mass value="', '<mass value="1'), encoding="utf-8")
    run = stepbot("verify", "--json", "--junit", "ci/results.xml", *files)
    document = json.loads(run.out)
    assert document["exit_code"] == run.code == 1
    failed = {check["quantity"] for check in document["report"]["checks"] if check["status"] == "failed"}
    assert "mass" in failed
    cases = list(ET.parse("ci/results.xml").getroot().iter("testcase"))
    assert len({(case.get("classname"), case.get("name")) for case in cases}) == len(cases)
    assert {str(case.get("name")).split(": ")[-1] for case in cases if case.find("failure") is not None} >= failed
    assert cases[0].get("name") == "verification"


FLOATING = """<robot name="thrower">
  <link name="base">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="arm">
    <inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="ball">
    <inertial><mass value="3"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="flight" type="floating"><parent link="arm"/><child link="ball"/></joint>
</robot>
"""


@pytest.mark.slow
def test_urdf_with_a_floating_joint_within(stepbot: Stepbot, tmp_path: Path) -> None:
    """MuJoCo cannot read it, which is a reason and no error; another parser reads all of its links and joints."""
    file = tmp_path / "thrower.urdf"
    file.write_text(FLOATING, encoding="utf-8")
    run = stepbot("verify", "--json", str(file))
    assert run.code == 0, run.err
    checks = {(one["engine"], one["quantity"]): one for one in json.loads(run.out)["report"]["checks"]}
    reason = "MuJoCo has no floating joints within a robot: 'flight' (floating)"
    assert (checks["mujoco", "load"]["status"], checks["mujoco", "load"]["why"]) == ("not run", reason)
    assert checks["yourdfpy", "load"]["status"] == "passed"


@pytest.mark.parametrize(("name", "what"), [("arm.robot.yaml", "a sidecar"), ("arm.stp", "a STEP file")])
def test_source_of_a_robot(name: str, what: str, stepbot: Stepbot, tmp_path: Path) -> None:
    """A sidecar or a STEP is named as such, with the command that leads to a description."""
    (tmp_path / name).write_text("version: 1\n", encoding="utf-8")
    run = stepbot("verify", str(tmp_path / name))
    assert run.code == 1
    assert f"error[SB814]: {what}, not a robot description" in run.err
    assert f"help: `stepbot {'init' if name.endswith('stp') else 'convert'} {(tmp_path / name).as_posix()}`" in run.err


def test_missing_file(stepbot: Stepbot, tmp_path: Path) -> None:
    """A missing file is exit code 2."""
    run = stepbot("verify", str(tmp_path / "gone.urdf"))
    assert run.code == 2
    assert "error[SB001]" in run.err


@pytest.mark.slow
def test_required_engine_that_is_not_there(files: list[str], stepbot: Stepbot) -> None:
    """A required engine that is not installed is an error: not run is not passed."""
    run = stepbot("verify", "--require", "nosuchengine", files[0])
    assert run.code == 2
    assert "error[SB005]" in run.err
