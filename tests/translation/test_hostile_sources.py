"""Sources that could read or write what they must not: the rules of `verify` hold for conversions, too."""

import os
from pathlib import Path

import pytest

from stepbot.engines.description.statements import statements
from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Options

BARE = "<link name='base'/>"
CASES = {
    "entity": (
        "SB820",
        "robot.urdf",
        f"<!DOCTYPE robot [<!ENTITY x SYSTEM 'file:///etc/passwd'>]><robot name='r'>{BARE}&x;</robot>",
    ),
    "include from above": (
        "SB820",
        "robot.xml",
        "<mujoco><include file='../secret.xml'/><worldbody><body/></worldbody></mujoco>",
    ),
    "pipe": (
        "SB820",
        "robot.sdf",
        "<sdf version='1.9'><model name='r'><link name='a'><visual name='v'><geometry><mesh><uri>pipe.obj</uri></mesh>"
        "</geometry></visual></link></model></sdf>",
    ),
    "broken XML": ("SB814", "robot.urdf", "<robot name='r'>"),
}


@pytest.mark.parametrize("case", CASES)
def test_dangerous_sources_are_refused(case: str, tmp_path: Path) -> None:
    """Entities, includes from above, pipes and broken XML end in a diagnostic; nothing is written."""
    code, name, text = CASES[case]
    source = tmp_path / "in" / name
    source.parent.mkdir()
    source.write_text(text, encoding="utf-8")
    (tmp_path / "secret.xml").write_text("<mujocoinclude/>", encoding="utf-8")
    os.mkfifo(source.parent / "pipe.obj")
    conversion = convert(source, Options(tmp_path / "out", timeout=20.0, verify=False))
    assert [one.code for one in conversion.diagnostics if one.severity == "error"] == [code]
    assert not (tmp_path / "out").exists()


_MASS = "<inertial><mass>1</mass></inertial>"
WRONG = {
    "colour that is no number": (
        "robot.sdf",
        "<sdf version='1.9'><model name='r'><link name='a'><visual name='v'><geometry><box><size>1 1 1</size></box>"
        "</geometry><material><diffuse>0.5 nan 0 1</diffuse></material></visual></link></model></sdf>",
        "'0.5 nan 0 1' is not a list of finite numbers",
    ),
    "joint between links that do not exist": (
        "robot.sdf",
        "<sdf version='1.9'><model name='r'><link name='a'/><joint name='j' type='fixed'><parent>no</parent>"
        "<child>a</child></joint></model></sdf>",
        "no link or frame 'no'",
    ),
    "joint to a frame of its own child": (
        "robot.sdf",
        f"<sdf version='1.9'><model name='r'><link name='a'>{_MASS}</link><link name='b'>{_MASS}</link>"
        "<frame name='f' attached_to='b'/><joint name='j' type='revolute'><parent>f</parent><child>b</child>"
        "<axis><xyz>0 0 1</xyz></axis></joint></model></sdf>",
        "2 root links, one expected: a, b",
    ),
    "colour in bytes": (
        "robot.urdf",
        "<robot name='r'><link name='a'><visual><geometry><box size='1 1 1'/></geometry>"
        "<material name='m'><color rgba='255 128 0 1'/></material></visual></link></robot>",
        "'rgba' of <color> is '255 128 0 1', not numbers from 0 to 1; divide by 255",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_values_are_named(case: str, tmp_path: Path) -> None:
    """Values and names that no reader can use end in a diagnostic that names them."""
    name, text, message = WRONG[case]
    (tmp_path / name).write_text(text, encoding="utf-8")
    conversion = convert(tmp_path / name, Options(tmp_path / "out", verify=False))
    (error,) = [one for one in conversion.diagnostics if one.severity == "error"]
    assert error.code == "SB823"
    assert message in error.message


@pytest.mark.parametrize("bound", ["inf", "-inf"])
def test_equal_infinite_limits_are_no_position(bound: str, tmp_path: Path) -> None:
    """Equal limits fix a joint at their value, unless this is infinite."""
    source = tmp_path / "robot.sdf"
    source.write_text(
        f"<sdf version='1.9'><model name='r'><link name='a'>{_MASS}</link><link name='b'>{_MASS}</link>"
        "<joint name='j' type='revolute'><parent>a</parent><child>b</child>"
        f"<axis><limit><lower>{bound}</lower><upper>{bound}</upper></limit></axis></joint></model></sdf>",
        encoding="utf-8",
    )
    conversion = convert(source, Options(tmp_path / "out", verify=False))
    (error,) = [one for one in conversion.diagnostics if one.severity == "error"]
    assert error.code == "SB414"
    assert "joint 'j': a number is not finite" in error.message


@pytest.mark.parametrize("moment", ["inf", "1e200"])
def test_moments_that_are_no_numbers_are_rejected(moment: str, tmp_path: Path) -> None:
    """Their eigenvalues need not converge."""
    source = tmp_path / "robot.sdf"
    inertia = f"<inertia><ixx>{moment}</ixx><iyy>1</iyy><izz>1</izz><ixy>{moment}</ixy></inertia>"
    link = f"<link name='a'><inertial><mass>1</mass>{inertia}</inertial></link>"
    source.write_text(f"<sdf version='1.9'><model name='r'>{link}</model></sdf>", encoding="utf-8")
    conversion = convert(source, Options(tmp_path / "out", verify=False))
    assert {one.code for one in conversion.diagnostics if one.severity == "error"} & {"SB414", "SB509", "SB823"}


def test_a_lidar_with_millions_of_rays_is_not_written(tmp_path: Path) -> None:
    """MJCF has an element for each ray: one number in a file must not decide how long a conversion takes."""
    sensor = (
        "<sensor name='scan' type='gpu_lidar'><lidar><scan><horizontal><samples>9000000</samples><min_angle>-1"
        "</min_angle><max_angle>1</max_angle></horizontal></scan><range><min>0.1</min><max>9</max></range></lidar>"
    )
    text = f"<sdf version='1.9'><model name='r'><link name='a'>{_MASS}{sensor}</sensor></link></model></sdf>"
    (tmp_path / "robot.sdf").write_text(text, encoding="utf-8")
    conversion = convert(tmp_path / "robot.sdf", Options(tmp_path / "out", formats=("mjcf",), verify=False))
    (message,) = [one.message for one in conversion.diagnostics if one.code == "SB863"]
    assert message == "sensor 'scan': 9000000 rays, more than 100000: not converted"
    assert (tmp_path / "out" / "r.xml").stat().st_size < 10_000


def test_a_camera_without_pixels_is_not_written(tmp_path: Path) -> None:
    """The vertical field of view in MJCF follows from the ratio of rows and columns."""
    image = "<image><width>0</width><height>240</height></image>"
    sensor = f"<sensor name='eye' type='camera'><camera><horizontal_fov>1</horizontal_fov>{image}</camera></sensor>"
    text = f"<sdf version='1.9'><model name='r'><link name='a'>{_MASS}{sensor}</link></model></sdf>"
    (tmp_path / "robot.sdf").write_text(text, encoding="utf-8")
    conversion = convert(tmp_path / "robot.sdf", Options(tmp_path / "out", formats=("mjcf",), verify=False))
    (message,) = [one.message for one in conversion.diagnostics if one.code == "SB863"]
    assert message == "sensor 'eye': 0 x 240 pixels or rays: not converted"


def test_places_of_deeply_nested_elements_are_bounded(tmp_path: Path) -> None:
    """Each place names those above it: together they must not grow with the square of the depth; all differ."""
    (tmp_path / "robot.xml").write_text("<mujoco>" + "<geom size='1'>" * 2000 + "</geom>" * 2000 + "</mujoco>")
    places = [one.place for one in statements(tmp_path / "robot.xml", "mjcf")]
    assert len(set(places)) == 2000
    assert max(map(len, places)) < 1100


def test_names_of_a_source_are_no_paths(tmp_path: Path) -> None:
    """A robot and a mesh named like paths elsewhere are written into the output folder."""
    source = tmp_path / "in" / "robot.urdf"
    source.parent.mkdir()
    mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    (source.parent / "..part.obj").write_text(mesh, encoding="utf-8")
    visual = "<visual name='../../v'><geometry><mesh filename='..part.obj'/></geometry></visual>"
    source.write_text(f"<robot name='../../evil'><link name='world'>{visual}</link></robot>", encoding="utf-8")
    conversion = convert(source, Options(tmp_path / "out", formats=("urdf", "mjcf"), verify=False))
    assert conversion.diagnostics.exit_code == 0
    assert sorted(conversion.files) == [
        "_.._evil.scene.xml",
        "_.._evil.urdf",
        "_.._evil.xml",
        "meshes/part.obj",
        "report.json",
    ]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["in", "out"]


_FOLLOWER = """<robot name='r'>
<link name='a'/>
<link
  name='b'/>
<joint
 type='continuous'
 name='j'><parent link='a'/><child link='b'/><mimic joint='j'/></joint></robot>"""
_MESH = "<mesh\nfilename='a &amp; b.stl'/>"


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("<robot name='r'>\n<link name='a'/>\n<link name='a'/></robot>", 3, "duplicate link 'a'"),
        (_FOLLOWER, 5, "joint 'j' mimics 'j', which does not move by itself"),
        (
            f"<robot name='r'>\n<link name='a'>\n<visual><geometry>{_MESH}</geometry></visual></link></robot>",
            4,
            "mesh 'a & b.stl' is missing or of an unsupported type",
        ),
    ],
)
def test_errors_name_the_line(text: str, line: int, message: str, tmp_path: Path) -> None:
    """Of what the parser refuses, and of what the model cannot hold."""
    (tmp_path / "robot.urdf").write_text(text, encoding="utf-8")
    conversion = convert(tmp_path / "robot.urdf", Options(tmp_path / "out", verify=False))
    error = next(one for one in conversion.diagnostics if one.severity == "error")
    assert (error.span.line, error.message) == (line, message)


def test_a_planar_joint_below_the_world_fixes_the_base(tmp_path: Path) -> None:
    """The root is the world, so that nothing about the base is assumed."""
    text = (
        "<robot name='r'><link name='world'/><link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'"
        " ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='j' type='planar'><parent link='world'/>"
        "<child link='a'/><axis xyz='0 0 1'/></joint></robot>"
    )
    (tmp_path / "robot.urdf").write_text(text, encoding="utf-8")
    conversion = convert(tmp_path / "robot.urdf", Options(tmp_path / "out", verify=False))
    assert not [one for one in conversion.diagnostics if one.code.startswith("SB874")]
