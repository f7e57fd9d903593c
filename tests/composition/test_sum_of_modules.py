"""A composed robot is the sum of its modules: files, names and numbers, against each module converted alone."""

import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from textwrap import dedent
from typing import Any

import mujoco
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Pose
from stepbot.pipeline.composing import ComposedRobot, compose
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.pipeline.loading import Geometry, _GeometryCache
from stepbot.pipeline.stages import produce
from stepbot.robot.model import Robot
from stepbot.runtime.cache import Cache
from tests.command_line import stepbot

from .described import ARM as ARM_URDF
from .described import composing, joint, link, urdf

Compose = Callable[[Mapping[str, str], Diagnostics], Robot]
ARM, HAND = "stepbot_arm2/arm2.robot.yaml", "robotiq_2f85/2f85.robot.yaml"


@pytest.fixture
def converted(tmp_path: Path, robot_library: Path, cache: Cache) -> Callable[..., Conversion]:
    """Converts a sidecar of the test, or of the library, into a folder of its name."""

    def convert(text_or_path: str, name: str, formats: tuple[str, ...] = ("mjcf",)) -> Conversion:
        sidecar = robot_library / text_or_path
        if "\n" in text_or_path:
            sidecar = tmp_path / f"{name}.robot.yaml"
            sidecar.write_text(dedent(text_or_path).replace("LIBRARY", robot_library.as_posix()), encoding="utf-8")
        conversion = produce(sidecar, Options(tmp_path / name, formats=formats, verify=False, cache=cache))
        assert not conversion.diagnostics.has_errors, list(conversion.diagnostics)
        for path, content in conversion.files.items():
            file = tmp_path / name / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        return conversion

    return convert


LIBRARY = sorted(path.parent.name for path in (Path(__file__).parents[2] / "robot_library").glob("*/*.step"))
SMALL = ("stepbot_arm2", "robotiq_2f85", "stepbot_delta")


@pytest.mark.slow
@pytest.mark.parametrize(
    "robot", [pytest.param(one, marks=() if one in SMALL else pytest.mark.long) for one in LIBRARY]
)
def test_one_module_without_prefix_is_the_module(
    robot: str, converted: Callable[..., Conversion], robot_library: Path
) -> None:
    """All robot files and meshes have the same bytes, but for the name of the source."""
    sidecar = next((robot_library / robot).glob("*.robot.yaml"))
    alone = converted(sidecar.as_posix(), "alone", ("urdf", "sdf", "mjcf"))
    assert alone.robot is not None
    text = f"""
        version: 1
        robot: {alone.robot.name}
        modules:
          all: {{file: {sidecar.as_posix()}, prefix: ""}}
        """
    composed = converted(text, alone.robot.name, ("urdf", "sdf", "mjcf"))
    files = {path: content for path, content in composed.files.items() if path != "report.json"}
    assert set(files) == set(alone.files) - {"report.json"}
    source = alone.robot.source.encode()
    for path, content in files.items():
        named = content.replace(f"{alone.robot.name}.robot.yaml".encode(), source)
        assert named == alone.files[path], path


@pytest.mark.slow
@pytest.mark.parametrize(("prefix", "formats"), [("a_", ("mjcf",)), ("", ("urdf", "sdf", "mjcf"))])
def test_modules_of_modules_are_flat(
    prefix: str, formats: tuple[str, ...], converted: Callable[..., Conversion]
) -> None:
    """(arm + hand) as a module gives what arm and hand give, with the same prefixes."""
    flat = converted(
        f"""
        version: 1
        robot: flat
        modules:
          arm: {{file: LIBRARY/{ARM}, prefix: "{prefix}"}}
          hand: {{file: LIBRARY/{HAND}, at: arm/tool0, prefix: {prefix}h_, home: {{finger_joint: 0.3}}}}
        frames:
          tcp:
            link: hand/robotiq_arg2f_base_link
            origin: {{xyz: [0, 0, 1 mm], relative_to: hand/robotiq_arg2f_base_link}}
        """,
        "flat",
        formats,
    )
    converted(
        f"""
        version: 1
        robot: inner
        modules:
          arm: {{file: LIBRARY/{ARM}, prefix: ""}}
          hand: {{file: LIBRARY/{HAND}, at: arm/tool0, prefix: h_, home: {{finger_joint: 0.3}}}}
        """,
        "inner",
    )
    nested = converted(
        f"""
        version: 1
        robot: flat
        modules:
          robot: {{file: inner.robot.yaml, prefix: "{prefix}"}}
        frames:
          tcp:
            link: robot/hand/robotiq_arg2f_base_link
            origin: {{xyz: [0, 0, 1 mm], relative_to: robot/hand/robotiq_arg2f_base_link}}
        """,
        "flat",
        formats,
    )
    files = set(flat.files) - {"report.json"}
    assert files == set(nested.files) - {"report.json"}
    for path in files:
        assert flat.files[path].replace(b"hand_mount", f"{prefix}hand_mount".encode()) == nested.files[path], path
    assert nested.robot is not None
    assert [module.name for module in nested.robot.modules] == ["robot", "robot/arm", "robot/hand"]


NESTED = """<mujoco model="nested"><compiler angle="degree" autolimits="true"/><option timestep="0.001"/>
  <default><joint damping="0.1" armature="0.01"/><geom density="500"/>
    <default class="wide"><joint range="-90 90" frictionloss="0.2"/>
      <default class="strong"><position kp="40" kv="4" ctrlrange="-60 60" forcerange="-9 9"/></default>
  </default></default>
  <worldbody><body name="base"><geom size="0.1"/>
    <body name="arm" pos="0 0 0.1" childclass="wide" euler="0 20 0"><joint name="lift" axis="0 1 0"/>
      <geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0"/>
      <body name="tip" pos="0.3 0 0"><joint name="roll" axis="1 0 0" range="-45 30"/>
        <geom type="box" size="0.05 0.02 0.01"/></body>
    </body></body></worldbody>
  <actuator><position name="m" joint="lift" class="strong"/></actuator>
  <keyframe><key name="other" qpos="0 0"/><key name="home" qpos="0.3 -0.2"/></keyframe></mujoco>
"""


@pytest.mark.slow
def test_a_module_of_mjcf_is_what_convert_reads(converted: Callable[..., Conversion], tmp_path: Path) -> None:
    """Defaults, degrees, several keyframes: the same links, joints and drives as the file converted alone."""
    (tmp_path / "nested.xml").write_text(NESTED, encoding="utf-8")
    alone = converted((tmp_path / "nested.xml").as_posix(), "alone").robot
    text = f"version: 1\nrobot: both\nmodules:\n  a: {{file: {tmp_path}/nested.xml, prefix: ''}}\n"
    composed = converted(text + f"  b: {{file: {tmp_path}/nested.xml, at: a/tip}}\n", "both").robot
    assert alone is not None
    assert composed is not None
    names = set(alone.link_by_name)
    assert [link for link in composed.links if link.name in names] == list(alone.links)
    assert [joint for joint in composed.joints if joint.child in names] == list(alone.joints)
    assert [one for one in composed.actuators if one.joint in alone.joint_by_name] == list(alone.actuators)
    assert [round(joint.drawn_position, 9) for joint in alone.joints] == [0.3, -0.2]


def test_home_of_a_module_with_a_branch(converted: Callable[..., Conversion], tmp_path: Path) -> None:
    """The arm has a camera on its first link and a hand at its end, so that its coordinates are not contiguous."""
    chain = [joint(f"j{i}", f"l{i}", f"l{i + 1}", axis="0 1 0", xyz="0 0 0.2") for i in range(3)]
    eye = (link("pan"), link("tilt"), joint("p", "l1", "pan"), joint("t", "pan", "tilt"))
    (tmp_path / "arm.urdf").write_text(urdf("arm", *(link(f"l{i}") for i in range(4)), *chain, *eye))
    (tmp_path / "hand.urdf").write_text(ARM_URDF)
    text = (
        f"version: 1\nrobot: seeing\nbase: fixed\nmodules:\n"
        f"  arm: {{file: {tmp_path}/arm.urdf, home: {{j0: 0.1, j1: 0.2, j2: 0.3, p: 0.4, t: 0.5}}}}\n"
        f"  hand: {{file: {tmp_path}/hand.urdf, at: arm/l3, home: {{lift: 0.6}}}}\n"
    )
    converted(text, "seeing")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "seeing/seeing.xml"))
    qpos, names = model.key("home").qpos, ("arm_j0", "arm_j1", "arm_j2", "arm_p", "arm_t", "hand_lift")
    where = {name: int(model.joint(name).qposadr[0]) for name in names}
    assert len(qpos) == len(names)
    assert [qpos[where[name]] for name in names] == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    assert where["arm_j2"] < where["hand_lift"] < where["arm_p"]


@pytest.mark.slow
def test_each_module_is_in_the_report(tmp_path: Path) -> None:
    """Poses, masses, inertias and settings of each module against its own file, for the report and for CI servers."""
    (tmp_path / "arm.urdf").write_text(ARM_URDF)
    modules = ("left: {file: arm.urdf}", "right: {mirror_of: left, at: left/tip, flip: [lift]}")
    (tmp_path / "r.robot.yaml").write_text(composing(*modules))
    options = ("-f", "urdf", "-v", "-o", "out", "--junit", "j.xml", "--html")
    run = stepbot("convert", "r.robot.yaml", *options, cwd=tmp_path)
    assert run.code == 0, run.err
    assert "module 'right' alone" in run.out
    checks = json.loads((tmp_path / "out/report.json").read_text())["checks"]
    of_all = [one for one in checks if one["against"].startswith("module")]
    of_modules = {(one["against"], one["quantity"]): one for one in of_all if one["engine"] == "stepbot"}
    seen = {(one["engine"], one["against"]) for one in of_all if one["quantity"] == "poses"}
    assert {
        (engine, f"module '{name}' alone") for engine in ("mujoco", "pybullet") for name in ("left", "right")
    } < seen
    assert {name for name, _ in of_modules} == {f"module '{name}' alone" for name in ("left", "right")}
    quantities = {"links", "joints", "axes", "limits", "dynamics", "mass", "com", "inertia", "poses"}
    assert {quantity for _, quantity in of_modules} >= quantities
    assert {one["status"] for one in of_all} == {"passed"}
    assert all(one["deviation"] <= 1e-9 for one in of_modules.values() if one["deviation"] is not None)
    page = (tmp_path / "out/report.html").read_text(encoding="utf-8")
    rows = re.findall(
        r"<tr><th>(\w+)</th><td>arm.urdf</td><td>[\w–]+</td><td>([y–])</td>.*?<td>(\d+) checks passed", page
    )
    passed = [sum(one["against"] == f"module '{name}' alone" for one in of_all) for name in ("left", "right")]
    assert rows == [("left", "–", str(passed[0])), ("right", "y", str(passed[1]))]
    cases = (tmp_path / "j.xml").read_text().count("classname=\"whole.module 'right' alone\"")
    assert cases == sum(one["against"] == "module 'right' alone" for one in of_all)


@pytest.mark.slow
def test_a_changed_step_of_a_module_is_read_alone(
    tmp_path: Path, robot_library: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a change of the hand's STEP, the kernel reads it and no other; the composed robot has the new input."""
    bytes_ = (robot_library / "robotiq_2f85/2f85.step").read_bytes()
    for name in ("arm.step", "hand.step"):
        (tmp_path / name).write_bytes(bytes_)
    density = "set: {defaults: {density: 2700}}"
    modules = (f"arm: {{file: arm.step, {density}}}", f"hand: {{file: hand.step, at: arm/body, {density}}}")
    (tmp_path / "r.robot.yaml").write_text(composing(*modules))
    read, put = list[str](), _GeometryCache.put

    def noted(self: _GeometryCache, geometry: Geometry) -> None:
        read.append(self._step.name)
        put(self, geometry)

    monkeypatch.setattr(_GeometryCache, "put", noted)
    options = Options(tmp_path / "out", formats=("urdf",), verify=False, cache=Cache(tmp_path / "cache"))
    before = produce(tmp_path / "r.robot.yaml", options)
    assert read == ["arm.step", "hand.step"]
    (tmp_path / "hand.step").write_bytes(bytes_.replace(b"ENDSEC;", b"ENDSEC; ", 1))
    after = produce(tmp_path / "r.robot.yaml", options)
    assert read[2:] == ["hand.step"]
    assert before.geometry != after.geometry


OTHERS: dict[str, Callable[[Robot], Robot]] = {
    "mass": lambda robot: _with_link(robot, mass=1.001),
    "com": lambda robot: _with_link(robot, com=(0.01, 0.02, 0.030001)),
    "limits": lambda robot: _with_joint(robot, limit=replace(robot.joints[0].limit, upper=0.9)),
    "axes": lambda robot: _with_joint(robot, axis=(0.0, -1.0, 0.0)),
    "poses": lambda robot: _with_joint(robot, X_PC=Pose.from_xyz_rpy((0.1, 0.2, 0.30001), (0.0, 0.0, 0.0))),
    "dynamics": lambda robot: _with_joint(robot, dynamics=replace(robot.joints[0].dynamics, damping=0.1)),
}


def _with_link(robot: Robot, **changes: Any) -> Robot:
    *others, tip = robot.links
    return replace(robot, links=(*others, replace(tip, mass_properties=replace(tip.mass_properties, **changes))))


def _with_joint(robot: Robot, **changes: Any) -> Robot:
    return replace(robot, joints=(replace(robot.joints[0], **changes),))


@pytest.mark.slow
@pytest.mark.parametrize("quantity", OTHERS)
@pytest.mark.parametrize("module", ["left", "right"])
def test_engines_are_compared_with_the_module_alone(
    module: str, quantity: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each engine reports a module, mirrored and reversed or not, as it is alone; any other number is an error."""
    (tmp_path / "arm.urdf").write_text(ARM_URDF)
    modules = (
        "left: {file: arm.urdf, prefix: ''}",  # a name of the first is one of the second without its prefix
        "right: {mirror_of: left, at: left/tip, flip: [lift]}",
    )
    (tmp_path / "r.robot.yaml").write_text(composing(*modules))

    def tampered(*arguments: Any) -> ComposedRobot:
        made = compose(*arguments)
        alone = (
            one._replace(robot=OTHERS[quantity](one.robot)) if one.module.name == module else one
            for one in made.modules
        )
        return replace(made, modules=tuple(alone))

    monkeypatch.setattr("stepbot.pipeline.composing.compose", tampered)
    made = produce(tmp_path / "r.robot.yaml", Options(tmp_path / "out", ("urdf", "mjcf")))
    assert made.report is not None
    failed = {
        (check.engine, check.against, check.quantity) for check in made.report.checks if check.status.value == "failed"
    }
    against = f"module '{module}' alone"
    assert failed >= {
        ("mujoco", against, quantity),
        ("yourdfpy" if quantity == "dynamics" else "pybullet", against, quantity),
    }
    assert {one for _, one, _ in failed} == {against}
    assert {named for *_, named in failed} <= {quantity, "poses"}  # with another axis there are other poses
    assert "SB803" in {one.code for one in made.diagnostics}


DRIVEN = """<mujoco><worldbody><body name="base"><geom type="box" size="0.1 0.1 0.1" mass="1"/>
  <body name="tip" pos="0 0 0.3"><joint name="lift" axis="0 1 0" range="-1 1" limited="true"/>
    <geom type="box" size="0.1 0.1 0.1" mass="1"/></body></body></worldbody>
  <actuator><position name="m" joint="lift" kp="10"/></actuator></mujoco>"""


@pytest.mark.slow
@pytest.mark.parametrize("kp", [10.0, 10.1])
def test_drives_are_compared_with_the_module_alone(kp: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo reports the gains of a module's actuators as they are alone; other gains are an error."""
    (tmp_path / "arm.xml").write_text(DRIVEN)
    (tmp_path / "r.robot.yaml").write_text(composing("left: {file: arm.xml}", "right: {file: arm.xml, at: left/tip}"))

    def tampered(*arguments: Any) -> ComposedRobot:
        made = compose(*arguments)
        left, right = made.modules
        (drive,) = left.robot.actuators
        alone = replace(left.robot, actuators=(replace(drive, kp=kp),))
        return replace(made, modules=(left._replace(robot=alone), right))

    monkeypatch.setattr("stepbot.pipeline.composing.compose", tampered)
    made = produce(tmp_path / "r.robot.yaml", Options(tmp_path / "out", ("mjcf",)))
    assert made.report is not None
    failed = [(one.against, one.quantity) for one in made.report.checks if one.status.value == "failed"]
    assert failed == ([("module 'left' alone", "actuators")] if kp != 10.0 else [])
