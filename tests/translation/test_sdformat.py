"""An SDFormat file as the source of a conversion: nested models, frames, a joint that moves on the world."""

from pathlib import Path

import numpy as np
import pytest

from stepbot.described.robot import robot_of_description
from stepbot.engines.describe import describe
from stepbot.engines.observation import EngineCannotRead, EngineRefused
from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Options
from stepbot.robot.kinematics import link_poses

RIG = """<sdf version="1.11"><model name="rig">
  <link name="base">
    <inertial><mass>2</mass><inertia><ixx>0.02</ixx><iyy>0.02</iyy><izz>0.02</izz></inertia></inertial>
    <collision name="c"><geometry><box><size>0.3 0.3 0.3</size></box></geometry>
      <surface><contact/></surface></collision>
  </link>
  <frame name="flange" attached_to="base"><pose>0 0 0.1 0 0 0.5</pose></frame>
  <model name="hand">
    <pose relative_to="flange">0 0 0.05 0 0 0</pose>
    <link name="palm"><pose frame="">0 0 0.02 0 0 0</pose>
      <inertial><mass>1</mass><inertia><ixx>0.002</ixx><iyy>0.002</iyy><izz>0.002</izz></inertia></inertial>
      <visual name="v"><pose relative_to="__model__">0 0 0 0.1 0 0</pose>
        <geometry><box><size>0.2 0.2 0.2</size></box></geometry></visual>
    </link>
    <link name="finger"><pose relative_to="palm">0.05 0 0 0 0 0</pose>
      <inertial><mass>0.1</mass><inertia><ixx>0.0002</ixx><iyy>0.0002</iyy><izz>0.0002</izz></inertia></inertial>
    </link>
    <joint name="grip" type="revolute"><pose>0.01 0 0 0 0 0</pose><parent>palm</parent><child>finger</child>
      <axis><xyz expressed_in="__model__">0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>
  </model>
  <joint name="wrist" type="revolute"><parent>base</parent><child>hand::palm</child>
    <axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>
  <joint name="rail" type="prismatic"><parent>world</parent><child>base</child>
    <axis><xyz>1 0 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>
</model></sdf>
"""


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    """The file."""
    path = tmp_path / "rig.sdf"
    path.write_text(RIG, encoding="utf-8")
    return path


def test_poses_of_nested_models(rig: Path) -> None:
    """Links of a nested model are where the chain of frames puts them, and turn about axes of its frame."""
    robot = robot_of_description(describe(str(rig), "sdf"), "rig", rig.name).robot
    poses = link_poses(robot, {"rail": 0.2, "wrist": 0.3, "hand_grip": 0.4})
    # By hand: the flange turns x by 0.5, the wrist by 0.3 more; the joint is 0.01 m beyond the finger's origin.
    turned = np.array([np.cos(0.8), np.sin(0.8), 0.0])
    further = np.array([np.cos(1.2), np.sin(1.2), 0.0])
    assert poses["hand_palm"].p == pytest.approx([0.2, 0.0, 0.17])
    assert poses["hand_finger"].p == pytest.approx(np.array([0.2, 0.0, 0.17]) + 0.06 * turned - 0.01 * further)
    (visual,) = robot.link_by_name["hand_palm"].visuals
    assert visual.X_LG.position == pytest.approx((0.0, 0.0, -0.02))


@pytest.mark.slow
def test_conversion_is_proven_and_declares_losses(rig: Path, tmp_path: Path) -> None:
    """The MJCF moves like the source; contact properties, new names and added links are declared."""
    conversion = convert(rig, Options(tmp_path / "out", formats=("mjcf",)))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    codes = [one.code for one in conversion.diagnostics]
    assert codes.count("SB860") == 1
    assert {"SB864", "SB867"} <= set(codes)  # only stepbot's parser reads nested models
    assert conversion.report is not None
    passed = {
        one.quantity for one in conversion.report.checks if one.against == "rig.sdf (reader)" and one.status == "passed"
    }
    assert {"links", "joints", "poses", "mass matrix", "inertia", "limits"} <= passed


def test_include_is_not_followed(rig: Path) -> None:
    """A model from another file is an error, not a robot without it."""
    rig.write_text(
        RIG.replace("</model></sdf>", "<include><uri>model://x</uri></include></model></sdf>"), encoding="utf-8"
    )
    with pytest.raises(EngineCannotRead, match="include"):
        describe(str(rig), "sdf")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('<link name="finger">', '<link name="palm">', "duplicate link 'hand::palm'"),
        ('<frame name="flange"', '<frame name=""', "<frame> without a name"),
        ("<parent>base</parent>", "", "joint 'wrist' has no <parent>"),
        ("<axis><xyz>0 0 1</xyz>", "<axis><xyz>0 0 0</xyz>", "joint 'wrist': the axis is '0 0 0', not a direction"),
        ("<mass>2</mass>", "<mass>2 kg</mass>", "line [0-9]+: <mass> is '2 kg', not a number"),
        (
            '<link name="base">',
            '<link name="base"><sensor name="eye" type="camera"><camera><image><width>inf</width></image>'
            "</camera></sensor>",
            "<width> is infinite",
        ),
        (
            '<link name="base">',
            '<link name="base"><sensor name="eye" type="lidar"><lidar><scan><horizontal><min_angle>-inf</min_angle>'
            "</horizontal></scan></lidar></sensor>",
            "<min_angle> is infinite",
        ),
    ],
)
def test_faults_have_a_message(old: str, new: str, message: str, rig: Path) -> None:
    """Duplicate and missing names, a joint without an end or a direction, and text are reported, not raised."""
    assert old in RIG
    rig.write_text(RIG.replace('relative_to="flange"', "").replace(old, new, 1), encoding="utf-8")
    with pytest.raises(EngineRefused, match=message):
        describe(str(rig), "sdf")


@pytest.mark.long
@pytest.mark.pybullet
def test_sdformat_of_others_converts_with_proof(tmp_path: Path) -> None:
    """A gripper of pybullet_data, with joints beside the origins of its links, converts to URDF and MJCF."""
    data = pytest.importorskip("pybullet_data")
    source = Path(data.getDataPath(), "gripper", "wsg50_one_motor_gripper_new_free_base.sdf")
    conversion = convert(source, Options(tmp_path / "out", formats=("urdf", "mjcf")))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    assert not conversion.report.failed
    against = {check.file for check in conversion.report.checks if check.against.startswith(source.name)}
    assert len(against) == 2


@pytest.mark.slow
@pytest.mark.parametrize("turned", ["", 'euler="0.3 0.2 0.1"'])
def test_a_loop_whose_home_is_not_zero(turned: str, tmp_path: Path) -> None:
    """A parallelogram of MJCF with its keyframe away from q = 0: the zeros move, and no comparison fails."""
    arm = '<geom type="capsule" size="0.01" fromto="0 0 0 0 0 0.1"/>'
    body = '<body name="{}" pos="{} 0 {}"><joint name="{}" axis="0 1 0" range="-1 1"/>'
    text = (
        f'<mujoco><compiler angle="radian"/><worldbody><body name="ground" {turned}><geom size="0.05"/>'
        f"{body.format('crank', 0, 0, 'a')}{arm}{body.format('coupler', 0, 0.1, 'b')}"
        '<geom type="capsule" size="0.01" fromto="0 0 0 0.3 0 0"/></body></body>'
        f"{body.format('rocker', 0.3, 0, 'c')}{arm}</body>"
        '</body></worldbody><equality><connect body1="coupler" body2="rocker" anchor="0.3 0 0"/></equality>'
        '<keyframe><key name="home" qpos="0.2 -0.2 0.2"/></keyframe></mujoco>'
    )
    (tmp_path / "loop.xml").write_text(text, encoding="utf-8")
    conversion = convert(tmp_path / "loop.xml", Options(tmp_path / "out", formats=("sdf",), base="fixed"))
    assert not conversion.diagnostics.has_errors, list(conversion.diagnostics)
    assert any(one.message.startswith("SDFormat: loops must close at q = 0") for one in conversion.diagnostics)


def test_mass_that_sdformat_computes_is_an_error(tmp_path: Path) -> None:
    """The default of 1 kg would be wrong: since SDFormat 1.11, `auto` computes mass properties from the collisions."""
    path = tmp_path / "box.sdf"
    path.write_text(
        '<sdf version="1.11"><model name="box"><link name="body"><inertial auto="true"/>'
        '<collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link></model></sdf>',
        encoding="utf-8",
    )
    found = convert(path, Options(tmp_path / "out")).diagnostics
    assert [one.code for one in found if one.severity == "error"] == ["SB823"]
    assert "link 'body': mass properties" in str(next(iter(found)))


def test_several_bases_on_the_world_stay_where_they_are(tmp_path: Path) -> None:
    """Two bases that a model fixes to the world are one robot, with the world as its root."""
    path = tmp_path / "cell.sdf"
    body = "<inertial><mass>1</mass></inertial>"
    bases = "".join(
        f'<link name="base_{n}"><pose>0 {n} 0.2 0 0 0.3</pose>{body}</link><link name="arm_{n}">'
        f'<pose relative_to="base_{n}">0 0 0.1 0 0 0</pose>{body}</link>'
        f'<joint name="held_{n}" type="fixed"><parent>world</parent><child>base_{n}</child></joint>'
        f'<joint name="turn_{n}" type="revolute"><parent>base_{n}</parent><child>arm_{n}</child><axis><xyz>0 1 0</xyz>'
        "<limit><lower>-1</lower><upper>1</upper></limit></axis></joint>"
        for n in range(2)
    )
    path.write_text(f'<sdf version="1.9"><model name="cell">{bases}</model></sdf>', encoding="utf-8")
    conversion = convert(path, Options(tmp_path / "out", formats=("urdf", "sdf", "mjcf")))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    assert not conversion.report.failed
    assert conversion.robot is not None
    X = link_poses(conversion.robot, {})
    assert (X["base_0"].inverse() @ X["base_1"]).position == pytest.approx((np.sin(0.3), np.cos(0.3), 0.0))


_OBJECT = '<model name="can"><pose>2 0 0 0 0 0</pose><link name="can"/></model>'
_FLOOR = '<model name="floor"><static>true</static><link name="ground"/></model>'


def test_robot_of_a_world_is_the_model_with_joints(rig: Path, tmp_path: Path) -> None:
    """What lies around a robot is not converted, and is reported."""
    model = RIG.partition("<model")[2].rpartition("</sdf>")[0]
    world = f'<sdf version="1.11"><world name="w">{_FLOOR}{_OBJECT}<model{model}</world></sdf>'
    rig.write_text(world, encoding="utf-8")
    conversion = convert(rig, Options(tmp_path / "out", formats=("sdf",)))
    assert not conversion.diagnostics.has_errors, list(map(str, conversion.diagnostics))
    assert conversion.robot is not None
    assert {joint.name for joint in conversion.robot.joints if joint.kind != "fixed"} == {"rail", "wrist", "hand_grip"}
    assert "<model> in <world>: not converted (2 times)" in {one.message for one in conversion.diagnostics}


def test_world_of_two_robots_names_both(rig: Path) -> None:
    """One of them declared static is part of the surroundings, as a floor is."""
    arm = RIG.partition("<model")[2].rpartition("</sdf>")[0]
    two = f'<sdf version="1.11"><world name="w"><model{arm}<model{arm.replace("rig", "other", 1)}</world></sdf>'
    rig.write_text(two, encoding="utf-8")
    with pytest.raises(EngineCannotRead, match=r"'rig', 'other'.*<static>true</static>"):
        describe(str(rig), "sdf")
    rig.write_text(two.replace('name="other">', 'name="other"><static>true</static>'), encoding="utf-8")
    assert len(describe(str(rig), "sdf").observation.joints) == 3
