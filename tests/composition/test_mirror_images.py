"""Mirror images: limits, mimics, loops, screws and mesh files."""

from collections.abc import Callable, Mapping
from fnmatch import fnmatch
from math import inf, pi
from pathlib import Path

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.compose.mirroring import flipped, mirrored
from stepbot.compose.parts import image_name
from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.stages import convert, produce
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import JointKind, Robot
from stepbot.robot.posing import posed
from stepbot.runtime.cache import Cache

from .described import composing, joint, link, urdf

Compose = Callable[[Mapping[str, str], Diagnostics], Robot]
HAND = urdf(
    "hand",
    *(link(name) for name in ("palm", "finger", "thumb", "tail")),
    joint("finger_roll", "palm", "finger", xyz="0.1 0.2 0.3", axis="1 0 0", lower="-0.5", upper="2"),
    joint("thumb", "palm", "thumb", rpy="0.3 0.2 0.1", mimic='"finger_roll" multiplier="0.5" offset="0.1"'),
    joint("tail_roll", "thumb", "tail", axis="0.6 0 0.8", mimic='"finger_roll" multiplier="-2" offset="0.2"'),
)
M = np.diag([1.0, -1.0, 1.0])


def image_of(pose: np.ndarray) -> np.ndarray:
    """The mirror image of a frame (4, 4) through y = 0."""
    m = np.diag([1.0, -1.0, 1.0, 1.0])
    return np.asarray(m @ pose @ m)


@pytest.mark.parametrize("q", [-0.3, 0.0, 0.7])
@pytest.mark.parametrize("flip", ["", "finger_roll", "*_roll", "thumb", "*"])
def test_followers_are_at_their_images(flip: str, q: float, composed: Compose) -> None:
    """Whatever joints of a chain of mimics are reversed, all links are at the images when the leader is."""
    flips = f", flip: ['{flip}']" if flip else ""
    files = {
        "r.robot.yaml": composing("left: {file: hand.urdf}", "right: {mirror_of: left, at: left/palm" + flips + "}"),
        "hand.urdf": HAND,
    }
    robot = composed(files, Diagnostics())
    turned = -q if flip in ("finger_roll", "*_roll", "*") else q
    poses = link_poses(robot, {"left_finger_roll": q, "right_finger_roll": turned})
    for name in ("finger", "thumb", "tail"):
        expected = image_of(poses[f"left_{name}"].matrix)
        assert np.allclose(poses[f"right_{name}"].matrix, expected, rtol=0.0, atol=1e-12), name


@pytest.mark.slow
@pytest.mark.parametrize(
    ("of_arm", "of_hand"),
    [("", ""), ("*_lift", ""), ("*_roll", "*_turn"), ("", "*_turn"), ("*", "*"), ("*', '*_roll", "*_roll")],
)
@pytest.mark.parametrize("leader", ["left_arm_lift", "left_arm/finger_roll", "left_hand/finger_roll"])
def test_images_of_joints_follow_the_image_of_their_leader(
    leader: str, of_arm: str, of_hand: str, composed: Compose
) -> None:
    """A mimic of the composing file above a mirrored module: its leader is in a mirrored module, or above one."""
    limits = "limits: {lower: -9, upper: 9, effort: 1, velocity: 1}"
    above = f"""joints:
  left_arm_lift: {{type: revolute, parent: trunk/tip, child: left_arm, axis: [0.6, 0, 0.8], {limits}}}
  left_hand_turn:
    {{type: revolute, parent: left_arm/tail, child: left_hand, axis: [0, 0.6, 0.8], {limits},
     mimic: {{joint: {leader}, multiplier: 0.5, offset: 0.1}}}}
"""
    modules = ["trunk: {file: trunk.urdf}"]
    for name, flip in (("arm", of_arm), ("hand", of_hand)):
        flips = f", flip: ['{flip}']" if flip else ""
        modules += [f"left_{name}: {{file: hand.urdf}}", f"right_{name}: {{mirror_of: left_{name}{flips}}}"]
    trunk = urdf("trunk", link("tip"))
    files = {"r.robot.yaml": composing(*modules, more=above), "hand.urdf": HAND, "trunk.urdf": trunk}
    robot = composed(files, Diagnostics())
    q = {"left_arm_lift": 0.3, "left_arm_finger_roll": 0.7, "left_hand_finger_roll": -0.2}
    flips_of = {True: of_arm.split("', '"), False: of_hand.split("', '")}
    for name, position in list(q.items()):
        is_reversed = any(fnmatch(name, pattern) for pattern in flips_of["_arm_" in name])
        q[name.replace("left", "right")] = -position if is_reversed else position
    poses = link_poses(robot, q)
    for name in ("arm_tail", "hand_palm", "hand_tail"):
        expected = image_of(poses[f"left_{name}"].matrix)
        assert np.allclose(poses[f"right_{name}"].matrix, expected, rtol=0.0, atol=1e-12), name
    followed = robot.joint_by_name["right_hand_turn"].mimic
    assert followed is not None
    assert followed.joint == leader.replace("left", "right").replace("/", "_")


TORSO = urdf("torso", link("torso"))
ON_TORSO = "offset: {xyz: [0.1, 0.2, 0.3], rpy: [0.3, 0.2, 0.1]}"
Q = {"finger_roll": 0.7}


def positions(*modules: str) -> dict[str, float]:
    """The same positions of the joints of several modules of HAND."""
    return {f"{module}_{name}": q for module in modules for name, q in Q.items()}


def reflected(pose: np.ndarray, plane: str, frame: str) -> np.ndarray:
    """A frame (4, 4) reflected in the world through a plane, with its own axes reflected through another one."""
    m, of_frame = (np.diag([*(-1.0 if axis == normal else 1.0 for axis in "xyz"), 1.0]) for normal in (plane, frame))
    return np.asarray(m @ pose @ of_frame)


@pytest.mark.slow
@pytest.mark.parametrize("plane", ["x", "y", "z"])
@pytest.mark.parametrize("hand_plane", ["x", "y", "z"])
@pytest.mark.parametrize("at", ["spot", "left_arm/tail", "left_arm/finger"])
def test_what_is_on_a_mirrored_module_is_on_its_image(at: str, plane: str, hand_plane: str, composed: Compose) -> None:
    """By a frame of the composing file or a link of the module, and if another plane of its own frame is mirrored."""
    modules = (
        "torso: {file: torso.urdf, prefix: ''}",
        f"left_arm: {{file: hand.urdf, at: torso, {ON_TORSO}}}",
        f"left_hand: {{file: hand.urdf, at: {at}, offset: {{xyz: [0.3, 0.1, 0.2], rpy: [0.1, 0.5, 0.9]}}}}",
        f"right_arm: {{mirror_of: left_arm, mirror: {plane}}}",
        f"right_hand: {{mirror_of: left_hand, mirror: {hand_plane}}}",
    )
    spot = "{link: left_arm/tail, origin: {xyz: [0.1, 0, 0.2], rpy: [0.2, 0.4, 0.6], relative_to: left_arm/tail}}"
    files = {"r.robot.yaml": composing(*modules, more=f"frames: {{spot: {spot}}}\n")}
    robot = composed({**files, "hand.urdf": HAND, "torso.urdf": TORSO}, Diagnostics())
    poses = link_poses(robot, positions("left_arm", "left_hand", "right_arm", "right_hand"))
    for part, of_frame in (("arm", plane), ("hand", hand_plane)):
        for name in ("palm", "finger", "thumb", "tail"):
            expected = reflected(poses[f"left_{part}_{name}"].matrix, plane, of_frame)
            assert np.allclose(poses[f"right_{part}_{name}"].matrix, expected, rtol=0.0, atol=1e-12), (part, name)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "second"), [("", ""), ("*_roll", ""), ("", "*_roll"), ("*", "*_roll"), ("*", "*")])
@pytest.mark.parametrize(("of", "plane"), [("y", "y"), ("x", "y"), ("z", "x")])
def test_the_image_of_an_image(of: str, plane: str, first: str, second: str, composed: Compose) -> None:
    """Its links are at the images of the mirrored module's; through the same plane, they are those of the file."""
    flips = [f", flip: ['{flip}']" if flip else "" for flip in (first, second)]
    modules = (
        "torso: {file: torso.urdf, prefix: ''}",
        f"left: {{file: hand.urdf, at: torso, mirror: {of}, {ON_TORSO}{flips[0]}}}",
        f"right: {{mirror_of: left, mirror: {plane}{flips[1]}}}",
    )
    files = {"r.robot.yaml": composing(*modules), "hand.urdf": HAND, "torso.urdf": TORSO}
    diagnostics = Diagnostics()
    robot = composed(files, diagnostics)
    assert "SB803" not in {one.code for one in diagnostics}
    q = {"left_finger_roll": 0.7, "right_finger_roll": -0.7 if second else 0.7}
    poses = link_poses(robot, q)
    for name in ("palm", "finger", "thumb", "tail"):
        expected = reflected(poses[f"left_{name}"].matrix, plane, plane)
        assert np.allclose(poses[f"right_{name}"].matrix, expected, rtol=0.0, atol=1e-12), name
    (module,) = [one for one in robot.modules if one.name == "right"]
    assert module.mirror == ("" if of == plane else "".join(sorted(of + plane)))
    alone = composed(
        {"r.robot.yaml": composing("hand: {file: hand.urdf, prefix: right_}"), "hand.urdf": HAND}, diagnostics
    )
    for link_alone in alone.links if of == plane else ():
        assert robot.link_by_name[link_alone.name].mass_properties == link_alone.mass_properties


LEGS = (
    "torso: {file: torso.urdf, prefix: ''}",
    f"front_left: {{file: hand.urdf, at: torso, {ON_TORSO}}}",
    "front_left_foot: {file: torso.urdf, at: front_left/tail, offset: {xyz: [0, 0.1, 0.2]}}",
    "front_right: {mirror_of: front_left}",
    "rear_left: {mirror_of: front_left, mirror: x}",
)


def test_a_foot_is_on_the_image_through_its_plane(composed: Compose) -> None:
    """Of several images of a leg, the foot's image is on the one through the same plane."""
    feet = ("rear_left_foot: {mirror_of: front_left_foot, mirror: x}", "other_foot: {mirror_of: front_left_foot}")
    files = {"r.robot.yaml": composing(*LEGS, *feet), "hand.urdf": HAND, "torso.urdf": TORSO}
    robot = composed(files, Diagnostics())
    above = {joint.child: joint.parent for joint in robot.joints}
    assert above["rear_left_foot_torso"] == "rear_left_tail"
    assert above["other_foot_torso"] == "front_right_tail"


@pytest.mark.slow
def test_a_foot_between_two_legs(errors: Callable[..., list[str]], composed: Compose) -> None:
    """Two legs through one plane: the names decide, and if they do not, it is an error."""
    second = ("far_right: {mirror_of: front_left, at: torso, offset: {xyz: [1, 0, 0]}}",)
    named = composing(*LEGS, *second, "far_right_foot: {mirror_of: front_left_foot}")
    files = {"hand.urdf": HAND, "torso.urdf": TORSO}
    robot = composed({"r.robot.yaml": named, **files}, Diagnostics())
    (mount,) = [joint for joint in robot.joints if joint.child == "far_right_foot_torso"]
    assert mount.parent == "far_right_tail"
    unnamed = composing(*LEGS, *second, "boot: {mirror_of: front_left_foot}")
    (line,) = errors({"r.robot.yaml": unnamed, **files}, diagnostics := Diagnostics())
    assert line.startswith("SB154 11:21 module 'boot': mirror_of: 'front_left_foot' is on 'front_left', which has")
    (help,) = [one.help for one in diagnostics if one.severity == "error"]
    assert help == ("give `at`: a port of 'front_right' or 'far_right'",)


BODY = urdf(
    "body",
    *(link(name) for name in ("torso", "left", "right", "low")),
    joint("left_turn", "torso", "left", xyz="0 0.2 0.3"),
    joint("right_turn", "torso", "right", xyz="0 -0.2 0.3"),
    joint("low_turn", "torso", "low", xyz="0 -0.2 0"),
)
PAIR = ("left_arm: {file: hand.urdf, at: body/left}", "right_arm: {mirror_of: left_arm, at: body/right}")
ON_LEFT = "left_hand: {file: hand.urdf, at: left_arm/finger, offset: {xyz: [0.1, 0.2, 0]}}"
ON_CART = (
    "cart: {file: torso.urdf, at: body/low}",
    "left_hand: {file: hand.urdf, at: body/torso, offset: {xyz: [0, 0.2, 0]}}",
)
PLATE = ("plate: {file: torso.urdf, at: body/torso, offset: {xyz: [0, -0.5, 0]}}", ON_CART[1])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("modules", "off"),
    [
        (PAIR, ""),
        ((PAIR[0], "right_arm: {mirror_of: left_arm, at: body/low}"), "300 mm, 0 deg"),
        ((*PAIR, ON_LEFT, "right_hand: {mirror_of: left_hand}"), None),
        (
            (*PAIR, ON_LEFT, "right_hand: {mirror_of: left_hand, at: right_arm/finger, offset: {xyz: [0.1, -0.2, 0]}}"),
            "",
        ),
        (
            (*PAIR, ON_LEFT, "right_hand: {mirror_of: left_hand, at: right_arm/finger, offset: {xyz: [0.1, 0.2, 0]}}"),
            "400 mm, 0 deg",
        ),
        (
            (*PAIR, ON_LEFT, "right_hand: {mirror_of: left_hand, at: right_arm/thumb}"),
            "on link 'right_arm_thumb' instead of 'right_arm_finger'",
        ),
        ((*ON_CART, "right_hand: {mirror_of: left_hand, at: cart}"), "on link 'cart_torso' instead of 'body_torso'"),
        ((*PLATE, "right_hand: {mirror_of: left_hand, at: plate, offset: {xyz: [0, 0.3, 0]}}"), ""),
        ((*PLATE, "right_hand: {mirror_of: left_hand, at: plate, offset: {xyz: [0, 0.2, 0]}}"), "100 mm, 0 deg"),
        (
            (
                PAIR[0],
                "right_arm: {file: hand.urdf, at: body/right}",
                ON_LEFT,
                "right_hand: {mirror_of: left_hand, at: right_arm/finger}",
            ),
            "",
        ),
    ],
)
def test_a_place_on_another_link(modules: tuple[str, ...], off: str | None, composed: Compose) -> None:
    """Two links of one part are compared as drawn, a place on an image with its link; welded parts are one body."""
    files = {"r.robot.yaml": composing("body: {file: body.urdf}", *modules)}
    composed({**files, "body.urdf": BODY, "hand.urdf": HAND, "torso.urdf": TORSO}, diagnostics := Diagnostics())
    notes = [one.message.rpartition(": ")[2] for one in diagnostics if one.code == "SB168:place"]
    assert notes == ([off] if off else [])


@pytest.mark.parametrize(
    ("joint", "of", "name", "image"),
    [
        ("left_roll", "left_arm", "right_arm", "right_roll"),
        ("left_arm_lift", "left_arm", "right_arm", "right_arm_lift"),
        ("roll_l", "leg_l", "leg_r", "roll_r"),
        ("front_left_hip", "front_left", "front_right", "front_right_hip"),
        ("shoulder", "left_arm", "right_arm", "right_arm_shoulder"),
        ("leftmost_roll", "left_arm", "right_arm", "right_arm_leftmost_roll"),
        ("shoulder_pan", "a", "b", "b_shoulder_pan"),
        ("LeftLegRoll", "LeftLeg", "RightLeg", "RightLegRoll"),
        ("leg10_hip", "leg1", "leg2", "leg2_leg10_hip"),
    ],
)
def test_the_image_of_a_joint_has_the_side_of_its_module(joint: str, of: str, name: str, image: str) -> None:
    """A joint that is not named after the module gets the module's name in front."""
    assert image_name(joint, of, name) == image


@pytest.mark.parametrize("plane", ["x", "y", "z"])
def test_the_upper_end_of_a_capsule_is_the_image_of_the_upper_end(plane: str, composed: Compose) -> None:
    """URDF has a sphere at each end, with a name."""
    capsule = "<geom type='capsule' size='0.1 0.3' pos='0.1 0.2 0.3' euler='10 20 30'/>"
    files = {
        "r.robot.yaml": composing(f"a: {{file: rod.xml, mirror: {plane}}}", "b: {file: rod.xml, at: a}"),
        "rod.xml": f"<mujoco><worldbody><body name='rod'>{capsule}</body></worldbody></mujoco>",
    }
    robot = composed(files, Diagnostics())
    image, own = (robot.link_by_name[name].collisions[0].X_LG.apply((0.0, 0.0, 0.3)) for name in ("a_rod", "b_rod"))
    assert np.allclose(image, own * [-1.0 if axis == plane else 1.0 for axis in "xyz"], rtol=0.0, atol=1e-12)


def test_flipped_twice_is_the_robot(composed: Compose) -> None:
    """Reversed twice, nothing has changed; a limit of one side is on the other side in between."""
    robot = composed({"r.robot.yaml": composing("hand: {file: hand.urdf}"), "hand.urdf": HAND}, Diagnostics())
    joints = tuple(replace(one, limit=replace(one.limit, lower=-inf, upper=1.0)) for one in robot.joints)
    robot = replace(robot, joints=joints)
    once = flipped(robot, ["*_roll"])
    limits = {one.name: (one.limit.lower, one.limit.upper) for one in once.joints}
    assert limits == {"hand_finger_roll": (-1.0, inf), "hand_thumb": (-inf, 1.0), "hand_tail_roll": (-1.0, inf)}
    assert once != robot
    assert flipped(once, ["*_roll"]) == robot


def test_a_mirrored_screw_advances_as_the_image(composed: Compose) -> None:
    """Its pitch is negated: the same angle moves the image by the same way. The comparison with the module agrees."""
    inertial = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
    links = f"<link name='a'>{inertial}</link><link name='b'><pose>0 1 0 0 0 0</pose>{inertial}</link>"
    pitch = 0.002
    screw = f"""<joint name="lift" type="screw"><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz></axis>
      <screw_thread_pitch>{2 * pi * pitch}</screw_thread_pitch></joint>"""
    files = {
        "r.robot.yaml": composing("left: {file: lift.sdf}", "right: {mirror_of: left, at: left/a}"),
        "lift.sdf": f'<sdf version="1.10"><model name="m">{links}{screw}</model></sdf>',
    }
    robot = composed(files, Diagnostics())
    pitches = {one.name: one.pitch for one in robot.joints if one.kind is JointKind.SCREW}
    assert pitches == pytest.approx({"left_lift": pitch, "right_lift": -pitch})
    poses = link_poses(robot, dict.fromkeys(pitches, 0.7))
    assert np.allclose(poses["right_b"].matrix, image_of(poses["left_b"].matrix), rtol=0.0, atol=1e-12)


@pytest.fixture(scope="module")
def gripper(robot_library: Path, cache: Cache, tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """The 2F-85, whose fingers are two loops."""
    options = Options(tmp_path_factory.mktemp("gripper"), formats=("mjcf",), verify=False, cache=cache)
    robot = produce(robot_library / "robotiq_2f85" / "2f85.robot.yaml", options).robot
    assert robot is not None
    return robot


@pytest.mark.slow
def test_mirrored_loops_close(gripper: Robot) -> None:
    """Over the range of the drive, both ends of each closure are at one point; all links are at their images."""
    image = mirrored(gripper, "y")
    for position in (0.05, 0.3, 0.55, 0.8):
        q = posed(image, {"finger_joint": position})
        assert q == pytest.approx(posed(gripper, {"finger_joint": position}), abs=1e-9)
        assert_image(gripper, image, q, q)


def assert_image(robot: Robot, image: Robot, q: Mapping[str, float], q_image: Mapping[str, float]) -> None:
    """The loops of the mirror image are closed, and its links are at the images of the robot's."""
    poses, others = link_poses(image, q_image), link_poses(robot, q)
    for closure in image.closures:
        a, b = poses[closure.link_a] @ closure.X_AF, poses[closure.link_b] @ closure.X_BF
        assert a.distance_to(b)[0] < 1e-6
    for name, pose in poses.items():
        assert np.allclose(pose.matrix, image_of(others[name].matrix), rtol=0.0, atol=1e-9), name


@pytest.mark.slow
def test_mirrored_loops_of_ball_joints_close(robot_library: Path, cache: Cache, tmp_path: Path) -> None:
    """A delta, over the range of its shoulders: yaw and roll of the ball joint above the platform change signs."""
    options = Options(tmp_path, formats=("mjcf",), verify=False, cache=cache)
    delta = produce(robot_library / "stepbot_delta" / "delta.robot.yaml", options).robot
    assert delta is not None
    image = mirrored(delta, "y")
    for shoulders in ((0.0, 0.0, 0.0), (0.3, 0.2, -0.1), (-0.2, 0.5, 0.4)):
        q = posed(
            delta,
            {
                f"shoulder_{i}": delta.joint_by_name[f"shoulder_{i}"].drawn_position + angle
                for i, angle in enumerate(shoulders, 1)
            },
        )
        assert max(abs(q[f"elbow_{i}_left_1"]) for i in (1, 2, 3)) > 0.0
        turned = {name: -value if name.endswith(("_yaw", "_roll")) else value for name, value in q.items()}
        assert_image(delta, image, q, turned)


@pytest.mark.slow
def test_files_of_a_mirrored_module(tmp_path: Path, cache: Cache, gripper: Robot) -> None:
    """No scale is negative; two equal modules share all mesh files; a second pair adds none; MuJoCo loads them."""
    pair = ("left: {file: 'library:2f85'}", "right: {mirror_of: left, at: left/robotiq_arg2f_base_link}")
    more = ("third: {file: 'library:2f85', at: left/robotiq_arg2f_base_link, offset: {xyz: [1, 0, 0]}}",)
    meshes = []
    for name, modules in (("pair", pair), ("three", (*pair, *more))):
        (tmp_path / f"{name}.robot.yaml").write_text(composing(*modules), encoding="utf-8")
        options = Options(tmp_path / name, formats=("urdf", "sdf", "mjcf", "usd"), verify=False, cache=cache)
        conversion = convert(tmp_path / f"{name}.robot.yaml", options)
        assert not conversion.diagnostics.has_errors
        meshes.append({path for path in conversion.files if path.startswith("meshes/")})
        for path, content in conversion.files.items():
            if path.endswith((".urdf", ".sdf", ".xml")):
                assert not [line for line in content.decode().splitlines() if "scale" in line and "-" in line], path
    assert meshes[0] == meshes[1]
    named = {Path(path).stem for path in meshes[0] if path.endswith(".obj")}
    assert {name for name in named if not name.endswith("_mirrored")} == {asset.name for asset in gripper.meshes}
    models = [mujoco.MjModel.from_xml_path(str(tmp_path / name / "whole.xml")) for name in ("pair", "three")]
    assert models[0].nmesh == models[1].nmesh
    assert models[1].body_mass.sum() == pytest.approx(3 * sum(one.mass_properties.mass for one in gripper.links))
    stages = [content.decode() for path, content in conversion.files.items() if path.endswith(".usda")]
    assert sum(stage.count('"PhysicsArticulationRootAPI"') for stage in stages) == 1
