"""stepbot's SDFormat parser against the specification: frames, defaults, units, errors."""

from math import inf, pi
from pathlib import Path

import numpy as np
import pytest

from stepbot.engines.observation import EngineCannotRead, EngineRefused, Observation, Quantity, Request
from stepbot.engines.sdformat_reader import observer as reader
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Limit, Mimic
from stepbot.runtime.worker import RemoteError
from tests.processes import call_isolated

LINK = "<inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia></inertial>"


def read(tmp_path: Path, model: str, version: str = "1.9", **request: object) -> Observation:
    """The observation of a model by the parser."""
    file = tmp_path / "model.sdf"
    file.write_text(f'<sdf version="{version}"><model name="m">{model}</model></sdf>', encoding="utf-8")
    return reader.observe(Request(str(file), "sdf", **request))  # type: ignore[arg-type]


def close(X: Pose | None, Y: Pose) -> bool:
    """Whether two poses agree to 1e-12."""
    return X is not None and max(X.distance_to(Y)) < 1e-12


def joint(name: str, parent: str, child: str, inside: str = "", kind: str = "revolute") -> str:
    """A joint about z."""
    return (
        f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>{inside}'
        "<axis><xyz>0 0 1</xyz></axis></joint>"
    )


def test_poses_relative_to_frames(tmp_path: Path) -> None:
    """``relative_to`` accepts links, joints and frames in any order; angles in degrees; quaternions with w last."""
    seen = read(
        tmp_path,
        f'<link name="a"><pose degrees="true">1 0 0 0 0 90</pose>{LINK}</link>'
        f'<link name="b"><pose relative_to="mark">0 0 1 0 0 0</pose>{LINK}</link>'
        '<frame name="mark" attached_to="a"><pose>0 2 0 0 0 0</pose></frame>'
        f'<link name="c"><pose relative_to="j" rotation_format="quat_xyzw">0 0 0 1 0 0 0</pose>{LINK}</link>'
        '<joint name="j" type="fixed"><pose relative_to="b">0 0 3 0 0 0</pose>'
        "<parent>b</parent><child>c</child></joint>" + joint("k", "a", "b"),
        configurations=({},),
    )
    (poses,) = seen.poses
    assert close(poses["b"], Pose.of(position=(0, 2, 1)))
    assert close(poses["c"], Pose.from_xyz_rpy((0, 2, 4), (pi, 0, 0)))
    assert (seen.frames or {})["mark"][0] == "a"
    assert close((seen.frames or {})["mark"][1], Pose.of(position=(0, 2, 0)))


def test_a_joint_beside_its_link_turns_about_itself(tmp_path: Path) -> None:
    """The pose of a joint is in its child; the link rotates about it."""
    offset = "<pose>0.5 0 0 0 0 0</pose>"
    seen = read(
        tmp_path,
        f'<link name="a">{LINK}</link><link name="b"><pose>1 0 0 0 0 0</pose>{LINK}</link>'
        + joint("j", "a", "b", offset),
        configurations=({"j": pi / 2},),
    )
    assert close(seen.poses[0]["b"], Pose.from_xyz_rpy((1.5, -0.5, 0), (0, 0, pi / 2)))
    gravity = seen.dynamics[0].gravity
    assert gravity is not None
    np.testing.assert_allclose(gravity, [0.0], atol=1e-15)
    np.testing.assert_allclose(seen.dynamics[0].mass_matrix, [[2.5 + 2 * 0.25]])


@pytest.mark.parametrize(
    ("axis", "expected"),
    [
        ("<xyz>0 0 2</xyz>", (0.0, 0.0, 1.0)),
        ('<xyz expressed_in="__model__">0 0 1</xyz>', (0.0, 1.0, 0.0)),
        ('<xyz expressed_in="a">1 0 0</xyz>', (1.0, 0.0, 0.0)),
        ("<xyz>0 0 1</xyz><use_parent_model_frame>1</use_parent_model_frame>", (0.0, 1.0, 0.0)),
        ("", (0.0, 0.0, 1.0)),
    ],
)
def test_axes_in_other_frames(tmp_path: Path, axis: str, expected: tuple[float, float, float]) -> None:
    """An axis is in the joint's frame unless it names another; b is rotated about x by 90 degrees."""
    seen = read(
        tmp_path,
        f'<link name="a">{LINK}</link><link name="b"><pose degrees="true">0 0 0 90 0 0</pose>{LINK}</link>'
        f'<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis>{axis}</axis></joint>',
    )
    np.testing.assert_allclose(seen.joints[0].axis or (), expected, atol=1e-15)


def test_what_is_left_out_has_the_specified_default(tmp_path: Path) -> None:
    """Defaults are 1 kg, unit inertia and no limits; 1e16 and negative speeds mean unlimited."""
    seen = read(
        tmp_path,
        '<link name="a"/><link name="b"/>'
        '<joint name="j" type="prismatic"><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz><limit>'
        "<lower>-1e16</lower><upper>0.5</upper><velocity>-1</velocity></limit></axis></joint>",
    )
    assert seen.links[0].mass == 1.0
    assert seen.links[0].inertia == ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    assert seen.joints[0].limit == Limit(-inf, 0.5)
    assert seen.base == "floating"


def test_inertia_turns_with_its_pose(tmp_path: Path) -> None:
    """The inertia tensor is along the axes of the inertial frame."""
    inertial = LINK.replace("<mass>", '<pose degrees="true">0 0 1 0 0 90</pose><mass>')
    seen = read(tmp_path, f'<link name="a">{inertial}</link>')
    np.testing.assert_allclose(seen.links[0].inertia, np.diag([2, 1, 2.5]), atol=1e-15)
    assert seen.links[0].com == (0.0, 0.0, 1.0)


def test_mimic_with_a_reference(tmp_path: Path) -> None:
    """follower = multiplier (leader - reference) + offset."""
    mimic = '<mimic joint="one"><multiplier>2</multiplier><offset>5</offset><reference>3</reference></mimic>'
    seen = read(
        tmp_path,
        f'<link name="a">{LINK}</link><link name="b">{LINK}</link><link name="c">{LINK}</link>'
        + joint("one", "a", "b")
        + joint("two", "b", "c").replace("</axis>", f"{mimic}</axis>"),
    )
    assert seen.joints[1].mimic == Mimic("one", 2.0, -1.0)


def test_a_second_joint_to_a_link_closes_a_loop(tmp_path: Path) -> None:
    """The later of two joints to a link closes a loop, also if it would form a cycle without a root."""
    links = "".join(f'<link name="{name}">{LINK}</link>' for name in "abc")
    seen = read(tmp_path, links + joint("ab", "a", "b") + joint("ac", "a", "c") + joint("bc", "b", "c"))
    assert [one.name for one in seen.joints] == ["ab", "ac"]
    assert [one.name for one in seen.closures or ()] == ["bc"]
    seen = read(tmp_path, links + joint("ab", "a", "b") + joint("bc", "b", "c") + joint("ca", "c", "a"))
    assert [one.name for one in seen.closures or ()] == ["ca"]


def test_the_root_may_stand_anywhere_in_its_model(tmp_path: Path) -> None:
    """Poses are relative to the root link; gravity acts along the world's z."""
    turned = "<pose>7 8 9 1.5707963267948966 0 0</pose>"
    seen = read(
        tmp_path,
        f'<link name="a">{turned}{LINK}</link><link name="b">{turned}{LINK}</link>'
        '<joint name="w" type="fixed"><parent>world</parent><child>a</child></joint>'
        '<joint name="j" type="prismatic"><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz></axis></joint>',
        configurations=({"j": 0.25},),
    )
    assert seen.base == "fixed"
    assert close(seen.poses[0]["b"], Pose.of(position=(0, 0.25, 0)))
    np.testing.assert_allclose(seen.dynamics[0].gravity, [2 * 9.81])  # y of the link is up in the world


def test_boxes_of_shapes_and_missing_meshes(tmp_path: Path) -> None:
    """Sizes of a scaled OBJ and a primitive are read; a missing file is reported."""
    (tmp_path / "part.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n", encoding="utf-8")
    mesh = "<geometry><mesh><uri>{}</uri><scale>0.1 0.1 1</scale></mesh></geometry>"
    seen = read(
        tmp_path,
        f'<link name="a">{LINK}<visual name="v"><pose>0 0 1 0 0 0</pose>{mesh.format("part.obj")}</visual>'
        "<collision name='c'><geometry><sphere><radius>0.5</radius></sphere></geometry></collision></link>"
        f'<link name="b">{LINK}<visual name="v">{mesh.format("model://m/no.obj")}</visual></link>'
        + joint("j", "a", "b"),
    )
    np.testing.assert_allclose(seen.links[0].visual_bounds or (), ((0, 0, 1), (0.1, 0.2, 1)))
    assert seen.links[0].collision_bounds == ((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    assert seen.links[1].visual_bounds is None
    assert seen.missing_meshes == ("model://m/no.obj",)


def test_joints_without_kinematics_are_read_and_poses_not_run(tmp_path: Path) -> None:
    """A gearbox joint is read; poses are not run, with the reason."""
    seen = read(
        tmp_path,
        f'<link name="a">{LINK}</link><link name="b">{LINK}</link>'
        '<joint name="j" type="gearbox"><parent>a</parent><child>b</child></joint>',
        configurations=({},),
    )
    assert seen.joints[0].kind == "gearbox"
    assert seen.not_run[Quantity.POSES] == "stepbot has no kinematics for gearbox joints"


SHAPE = '<link name="a"><visual name="v"><geometry>{}</geometry></visual></link>'


@pytest.mark.parametrize(
    ("model", "message"),
    [
        ('<link name="a"><pose>0 0</pose></link>', "a pose with 2 numbers, 6 expected"),
        ('<link name="a"><pose>0 0 nan 0 0 0</pose></link>', "'0 0 nan 0 0 0' is not a list of finite numbers"),
        (SHAPE.format("<box><size>1 2</size></box>"), "<size> is '1 2', three numbers expected"),
        (SHAPE.format("<box><size>1 2 inf</size></box>"), "'1 2 inf' is not a list of finite numbers"),
        (SHAPE.format("<sphere><radius>1 2</radius></sphere>"), "<radius> is '1 2', not a number"),
        (SHAPE.format("<sphere><radius/></sphere>"), "<radius> is '', not a number"),
        (SHAPE.format("<mesh><uri>a.stl</uri><scale>1</scale></mesh>"), "<scale> is '1', three numbers expected"),
        ('<link name="a"><inertial><mass>nan</mass></inertial></link>', "<mass> is 'nan', not a number"),
        ('<link name="a"><inertial><mass>heavy</mass></inertial></link>', "<mass> is 'heavy', not a number"),
        (
            '<link name="a"/><link name="b"><pose relative_to="nowhere"/></link>' + joint("j", "a", "b"),
            "no frame 'nowhere'",
        ),
        ('<link name="a"/>' + joint("j", "a", "b"), "no link or frame 'b'"),
        (
            '<link name="a"/><link name="b"><pose relative_to="c">0 0 0 0 0 0</pose></link>'
            '<link name="c"><pose relative_to="b">0 0 0 0 0 0</pose></link>'
            + joint("j", "a", "b")
            + joint("k", "a", "c"),
            "is relative to itself",
        ),
    ],
)
def test_faults_are_refused_with_the_reason(tmp_path: Path, model: str, message: str) -> None:
    """A file that contradicts the specification is rejected with the reason."""
    with pytest.raises(EngineRefused, match=message):
        read(tmp_path, model, configurations=({},))


def test_what_it_does_not_know_is_not_called_wrong(tmp_path: Path) -> None:
    """A file that the parser does not support is reported as unsupported, not as invalid."""
    with pytest.raises(EngineCannotRead, match="2 root links"):
        read(tmp_path, '<link name="a"/><link name="b"/>', configurations=({},))


def test_closing_joints_that_come_first(tmp_path: Path) -> None:
    """A joint from a link to one above it closes the loop, wherever it is in the file."""
    links = "".join(f'<link name="{name}">{LINK}</link>' for name in "abcd")
    joints = joint("loop", "d", "b"), joint("i", "a", "b"), joint("k", "c", "d"), joint("j", "b", "c")
    seen = read(tmp_path, links + "".join(joints), configurations=({},))
    assert {one.name for one in seen.joints} == {"i", "j", "k"}
    assert [one.name for one in seen.closures or ()] == ["loop"]


def test_models_placed_by_a_frame(tmp_path: Path) -> None:
    """The pose of a nested model with ``placement_frame`` is that of this frame, of a link or of a frame of its own."""
    grip = (
        f"<link name='palm'><pose>1 0 0 0 0 0</pose>{LINK}</link><frame name='f' attached_to='palm'><pose>0 1 0 0 0 0"
    )
    for frame, y in (("palm", 0.0), ("f", -1.0)):
        pose = "<pose relative_to='a'>0 0 2 0 0 0</pose>"
        inner = f"<model name='grip' placement_frame='{frame}'>{pose}{grip}</pose></frame>"
        seen = read(
            tmp_path,
            f'<link name="a">{LINK}</link>{inner}</model>' + joint("j", "a", "grip::palm"),
            configurations=({},),
        )
        assert close(seen.poses[0]["grip::palm"], Pose.of(position=(0, y, 2)))


def test_text_that_is_not_xml_is_refused(tmp_path: Path) -> None:
    """Text that is not XML is rejected, in a worker too."""
    file = tmp_path / "model.sdf"
    file.write_text("<sdf><model", encoding="utf-8")
    with pytest.raises(RemoteError, match="not XML") as caught:
        call_isolated("stepbot.engines.sdformat_reader.observer:observe", Request(str(file), "sdf"))
    assert caught.value.kind == "EngineRefused"
