"""Every target of other programs, for the eight robots of the library that are others', written and proven at once."""

import json
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from stepbot.report.robot import Status
from stepbot.runtime.robot_library import library_robot

from .conftest import Stepbot
from .test_ros2 import xacro

pytestmark = pytest.mark.long

NAMES = ("ur5e", "gen3", "panda", "sawyer", "yumi", "2f85", "hand", "youbot")
FORMATS = ("urdf", "sdf", "webots")


@pytest.mark.parametrize("name", NAMES)
def test_one_folder_is_a_package_a_model_and_a_proto(stepbot: Stepbot, tmp_path: Path, name: str) -> None:
    """It is a ROS 2 package and a Gazebo model, with a PROTO: engines prove all files, and ROS parsers read them."""
    package = f"robot_{name}_description"
    folder = tmp_path / package
    sidecar = str(library_robot(name).sidecar)
    run = stepbot("convert", sidecar, "-f", ",".join(FORMATS), "--ros2", f"robot_{name}", "--gazebo", "-o", str(folder))
    assert run.code == 0, run.err
    checks = json.loads((folder / "report.json").read_text(encoding="utf-8"))["checks"]
    for one in FORMATS:
        assert {check["status"] for check in checks if check["format"] == one} == {Status.PASSED, Status.NOT_RUN}
    assert (folder / "model.config").is_file()
    assert list(folder.glob("*.proto"))
    uris = [uri.text or "" for uri in ET.parse(folder / "model.sdf").iter("uri")]
    assert uris
    assert all((tmp_path / uri.removeprefix("model://")).is_file() for uri in uris)
    urdf = xacro(folder / "urdf" / f"{name}.urdf.xacro", parent="world")
    links = {link.attrib["name"] for link in urdf.iter("link")}
    srdf = ET.parse(folder / f"{name}.srdf").getroot()
    named = [one.attrib[key] for one in srdf.iter() for key in ("link1", "link2", "parent_link") if key in one.attrib]
    assert set(named) <= links
    if shutil.which("check_urdf") is None:
        pytest.skip("check_urdf of liburdfdom-tools is not installed")
    file = tmp_path / "mounted.urdf"
    file.write_bytes(ET.tostring(urdf))
    checked = subprocess.run(["check_urdf", str(file)], capture_output=True, text=True, check=False, timeout=60)
    assert checked.returncode == 0, checked.stderr
    assert "root Link: world has 1 child(ren)" in checked.stdout
