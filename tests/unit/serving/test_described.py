"""Edits of a robot that a URDF, SDFormat or MJCF describes: a sidecar with the changes alone, converted and proven."""

from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import mujoco
import pytest

from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Options
from stepbot.runtime.cache import Cache
from stepbot.serving.local_server import Refused
from stepbot.serving.session import Session
from stepbot.sidecar.starter import description_starter

pytestmark = pytest.mark.slow

INERTIA = "<inertia><ixx>0.01</ixx><iyy>0.011</iyy><izz>0.012</izz></inertia>"
SOURCES = {
    "arm.urdf": """<robot name="arm"><link name="base"/>
      <link name="upper arm"><inertial><origin xyz="0 0 0.1"/><mass value="2"/>
        <inertia ixx="0.01" iyy="0.011" izz="0.012" ixy="0" ixz="0" iyz="0"/></inertial>
        <visual><geometry><box size="0.4 0.4 0.4"/></geometry></visual>
        <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
      <joint name="lift" type="revolute"><parent link="base"/><child link="upper arm"/>
        <axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="9" velocity="3"/></joint></robot>""",
    "arm.sdf": f"""<sdf version="1.9"><model name="arm" canonical_link="base"><link name="base"/>
      <joint name="world_fixed" type="fixed"><parent>world</parent><child>base</child></joint>
      <link name="upper arm"><inertial><pose>0 0 0.1 0 0 0</pose><mass>2</mass>{INERTIA}</inertial>
        <visual name="v"><geometry><box><size>0.4 0.4 0.4</size></box></geometry></visual>
        <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>
      <joint name="lift" type="revolute"><parent>base</parent><child>upper arm</child>
        <axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>2</upper><effort>9</effort><velocity>3</velocity></limit>
        </axis></joint></model></sdf>""",
    "arm.xml": """<mujoco model="arm"><compiler angle="radian"/><worldbody><body name="base">
      <body name="upper arm"><inertial pos="0 0 0.1" mass="2" diaginertia="0.01 0.011 0.012"/>
        <joint name="lift" axis="0 1 0" range="-1 2" limited="true" actuatorfrcrange="-9 9"/>
        <geom type="box" size="0.2 0.2 0.2" contype="0" conaffinity="0"/><geom type="sphere" size="0.1" group="3"/>
      </body></body></worldbody></mujoco>""",
}


@pytest.fixture(params=sorted(SOURCES))
def source(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A description of an arm."""
    path = tmp_path / str(request.param)
    path.write_text(SOURCES[path.name], encoding="utf-8")
    return path


@pytest.fixture
def ask(source: Path, tmp_path: Path) -> Any:
    """Asks the page's server for an edit."""
    sidecar = source.with_name("arm.robot.yaml")
    sidecar.write_text(description_starter(source), encoding="utf-8")
    session = Session(sidecar, Options(tmp_path / "out", cache=Cache(tmp_path / "cache")), edits=True)
    assert not session.load().diagnostics.has_errors
    yield lambda name, **question: session.server._answers[name](question)
    session.close()


def put(keys: list[str], text: str) -> dict[str, Any]:
    """A value that is typed into a field."""
    return {"action": "set", "keys": keys, "text": text}


def test_edits_are_converted_and_proven(source: Path, ask: Callable[..., Any], tmp_path: Path) -> None:
    """Rename, limits, mass, collision, frame, drive and type: in the sidecar alone, and in MuJoCo as asked for."""
    before = source.read_bytes()
    ask("edit", action="rename", what="link", **{"from": "upper arm", "to": "upper_arm"})
    ask("edit", action="limits", joint="lift", lower=-0.5, upper=0.75)
    ask("edit", **put(["links", "upper_arm", "inertial", "mass"], "3 kg"))
    ask("edit", **put(["links", "upper_arm", "collision"], "box"))
    ask(
        "edit",
        action="all",
        edits=[
            put(["frames", "tip", "link"], "upper_arm"),
            put(["frames", "tip", "origin"], "{xyz: [0, 0, 200 mm], relative_to: upper_arm}"),
        ],
    )
    ask(
        "edit",
        action="all",
        edits=[
            put(["actuators", "servo", "joint"], "lift"),
            put(["actuators", "servo", "kind"], "position"),
            put(["actuators", "servo", "kp"], "20 N*m/rad"),
            put(["actuators", "servo", "kv"], "1 N*m*s/rad"),
        ],
    )
    ask("edit", action="rename", what="joint", **{"from": "lift", "to": "shoulder"})
    ask("edit", **put(["base"], "fixed"))
    written = source.with_name("arm.robot.yaml").read_text(encoding="utf-8")
    assert source.read_bytes() == before
    assert "axis" not in written  # nothing that was not changed
    assert "inertia" not in written.replace("inertial", "")
    answer = ask("written")
    assert answer["described"] == source.name
    assert answer["data"]["joints"]["shoulder"]["limits"]["effort"] == 9.0
    conversion = convert(source.with_name("arm.robot.yaml"), Options(tmp_path / "made"))
    assert not conversion.diagnostics.has_errors, list(conversion.diagnostics)
    assert conversion.summary is not None
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "made" / "arm.xml"))
    assert model.joint("shoulder").range == pytest.approx([-0.5, 0.75], abs=1e-5)
    assert model.body("upper_arm").mass[0] == pytest.approx(3.0)
    assert sorted(model.body("upper_arm").inertia) == pytest.approx([0.015, 0.0165, 0.018])
    assert model.actuator("servo").gainprm[0] == pytest.approx(20.0)
    assert model.site("tip").pos == pytest.approx([0.0, 0.0, 0.2])
    solid = [i for i in range(model.ngeom) if model.geom_contype[i]]
    assert [model.geom_type[i] for i in solid] == [mujoco.mjtGeom.mjGEOM_BOX]
    assert model.geom_size[solid[0]] == pytest.approx([0.2, 0.2, 0.2])
    urdf = ET.parse(tmp_path / "made" / "arm.urdf").getroot()
    assert {one.get("name") for one in urdf.iter("joint")} >= {"shoulder"}
    assert not [one for one in urdf.iter() if " " in (one.get("name") or "")]


def test_type_and_what_stays(source: Path, ask: Callable[..., Any]) -> None:
    """Another type takes no settings of the former one; values of the file and its tree stay; undo is one step."""
    start = source.with_name("arm.robot.yaml").read_text(encoding="utf-8")
    for question in (
        {"action": "merge", "joint": "lift"},
        {"action": "all", "edits": [{"action": "root", "link": "upper arm"}]},
        put(["joints", "lift", "parent"], "upper arm"),
        put(["joints", "lift", "limits", "effort"], ""),
        put(["parts", "x", "mass"], "1 kg"),
        put(["joints", "lift", "limits", "upper"], "-2"),
    ):
        with pytest.raises(Refused):
            ask("edit", **question)
    assert source.with_name("arm.robot.yaml").read_text(encoding="utf-8") == start
    ask("edit", action="type", joint="lift", kind="prismatic")
    ask("edit", action="limits", joint="lift", lower=0.0, upper=0.1)
    assert "100 mm" in source.with_name("arm.robot.yaml").read_text(encoding="utf-8")
    assert ask("written")["data"]["joints"]["lift"]["type"] == "prismatic"
    ask("edit", action="type", joint="lift", kind="fixed")
    assert ask("written")["data"]["joints"]["lift"]["type"] == "fixed"
    for _ in range(3):
        ask("undo")
    assert source.with_name("arm.robot.yaml").read_text(encoding="utf-8") == start
