"""Two files that differ in one place: what makes another robot is never called equal, and other words are."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.mutation.pairs import differences

_URDF = """<robot name="arm">
  <link name="base"><inertial><mass value="2"/>
    <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial>
    <collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
  <link name="tip"><inertial><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
    <collision><origin xyz="0 0 0.1" rpy="0.3 0.2 -3"/>
      <geometry><cylinder radius="0.05" length="0.1"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="tip"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
  <gazebo reference="tip"><mu1>0.62</mu1></gazebo>
</robot>"""
_SDF = """<sdf version="1.9"><model name="arm"><pose>0 0 0.5 0 0 0</pose>
  <link name="base"><inertial><mass>2</mass>
    <inertia><ixx>0.02</ixx><iyy>0.02</iyy><izz>0.02</izz></inertia></inertial></link>
  <link name="tip"><inertial><mass>1</mass>
    <inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
    <visual name="v"><geometry><box><size>0.1 0.2 0.3</size></box></geometry></visual>
    <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry>
      <surface><friction><ode><mu>0.8</mu></ode></friction></surface></collision></link>
  <joint name="turn" type="revolute"><parent>base</parent><child>tip</child>
    <axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>
</model></sdf>"""
_MJCF = """<mujoco model="arm">
  <option timestep="0.002" integrator="implicitfast"/>
  <worldbody><body name="base"><inertial pos="0 0 0" mass="2" diaginertia="0.02 0.02 0.02"/>
    <geom name="shell" type="box" size="0.1 0.1 0.05"/><geom name="plate" type="box" size="0.1 0.1 0.01"/>
    <geom name="pad" class="rubber" type="sphere" size="0.02"/>
    <geom name="rod" type="capsule" fromto="0 0 0 0.1 0.2 0.3" size="0.01"/>
    <geom name="bar" type="box" fromto="0 0 0 0.1 0.2 0.3" size="0.01 0.02 0.03"/>
    <body name="tip" pos="0 0 0.1" quat="0.5 0.5 0 0"><inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
      <joint name="turn" axis="0 0 1" range="-1 1"/></body></body></worldbody>
  <compiler autolimits="true"/>
  <default><default class="rubber"><geom friction="0.8 0.01 0.001"/></default></default>
  <tendon><fixed name="cable"><joint joint="turn" coef="0.5"/></fixed></tendon>
  <actuator><motor name="pull" tendon="cable" gear="2"/></actuator>
  <sensor><jointpos name="angle" joint="turn" noise="0.01" cutoff="5"/></sensor>
</mujoco>"""
_FILES = {"urdf": _URDF, "sdf": _SDF, "mjcf": _MJCF}

ANOTHER_ROBOT = {
    "a number with a decimal comma": ("urdf", "<mu1>0.62<", "<mu1>0,62<"),
    "another name": ("urdf", 'robot name="arm"', 'robot name="Arm"'),
    "a box in place of a cylinder": ("urdf", '<cylinder radius="0.05" length="0.1"/>', '<box size="0.1 0.1 0.1"/>'),
    "a model that does not move": ("sdf", '<model name="arm">', '<model name="arm"><static>true</static>'),
    "another integrator": ("mjcf", '"implicitfast"', '"RK4"'),
    "the default integrator": ("mjcf", ' integrator="implicitfast"', ""),
    "a box whose ends are swapped": (
        "mjcf",
        'type="box" fromto="0 0 0 0.1 0.2 0.3"',
        'type="box" fromto="0.1 0.2 0.3 0 0 0"',
    ),
    "a model elsewhere": ("sdf", "<pose>0 0 0.5 0 0 0</pose>", ""),
    "a model higher up, about a longer axis": (
        "sdf",
        *("<pose>0 0 0.5 0 0 0</pose>", "<pose>0 0 0.6 0 0 0</pose>"),
        *("<xyz>0 0 1</xyz>", "<xyz>0 0 2.5</xyz>"),
    ),
    "no friction in Gazebo": ("sdf", "<mu>0.8</mu>", ""),
    "no friction of a link": ("urdf", "<mu1>0.62</mu1>", ""),
    "no friction in MuJoCo": ("mjcf", ' class="rubber" type', " type"),
    "no gear of a tendon": ("mjcf", ' gear="2"', ""),
    "a rest without a spring": ("mjcf", 'name="turn" axis', 'name="turn" springref="0.4" axis'),
    "no noise": ("mjcf", ' noise="0.01"', ""),
    "no cutoff": ("mjcf", ' cutoff="5"', ""),
    "a cylinder turned about its axis": ("urdf", 'rpy="0.3 0.2 -3"', 'rpy="0.3 0.2 -2.9"'),
    "a cylinder turned about its axis, beside a longer one": (
        "urdf",
        *('rpy="0.3 0.2 -3"', 'rpy="0.3 0.2 -2.9"', 'axis xyz="0 0 1"', 'axis xyz="0 0 2.5"'),
    ),
    "a shape that touches others": ("mjcf", 'name="plate"', 'contype="2" name="plate"'),
}
THE_SAME_ROBOT = {
    "a longer axis": ("urdf", 'axis xyz="0 0 1"', 'axis xyz="0 0 2.5"'),
    "a longer quaternion": ("mjcf", 'quat="0.5 0.5 0 0"', 'quat="1 1 0 0"'),
    "friction without a class": ("mjcf", ' class="rubber" type', ' friction="0.8 0.01 1e-3" type'),
    "a turn more": ("urdf", 'rpy="0.3 0.2 -3"', 'rpy="0.3 0.2 3.2831853071795862"'),
    "the other angles": ("urdf", 'rpy="0.3 0.2 -3"', 'rpy="3.441592653589793 2.941592653589793 0.14159265358979312"'),
    "the opposite quaternion": ("mjcf", 'quat="0.5 0.5 0 0"', 'quat="-0.5 -0.5 0 0"'),
    "a capsule from its other end": (
        "mjcf",
        'type="capsule" fromto="0 0 0 0.1 0.2 0.3"',
        'type="capsule" fromto="0.1 0.2 0.3 0 0 0"',
    ),
    "a default": ("mjcf", ' timestep="0.002"', ""),
    "a number for false": ("sdf", '<model name="arm">', '<model name="arm"><static>0</static>'),
    "a model that moves": ("sdf", '<model name="arm">', '<model name="arm"><static>false</static>'),
}


def _differences(folder: Path, change: Sequence[str]) -> str:
    written_in, *words = change
    text = other = _FILES[written_in]
    for old, new in zip(words[::2], words[1::2], strict=True):
        assert old in other
        other = other.replace(old, new)
    paths = [folder / f"{name}.{written_in}" for name in ("first", "other")]
    paths[0].write_text(text)
    paths[1].write_text(other)
    return differences(*paths, written_in)


@pytest.mark.parametrize("change", ANOTHER_ROBOT.values(), ids=ANOTHER_ROBOT)
def test_another_robot_is_not_called_equal(change: Sequence[str], tmp_path: Path) -> None:
    """Whatever makes another robot is a difference, also if no engine reports it."""
    assert _differences(tmp_path, change) not in ("", "refused")


@pytest.mark.parametrize("change", THE_SAME_ROBOT.values(), ids=THE_SAME_ROBOT)
def test_other_words_are_the_same_robot(change: Sequence[str], tmp_path: Path) -> None:
    """Other words for the same are no difference."""
    assert not _differences(tmp_path, change)
