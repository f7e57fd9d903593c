"""Where modules are attached, by hand-made poses, and what their files are called."""

import json
import re
from collections.abc import Callable, Mapping
from math import pi
from pathlib import Path

import mujoco
import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Pose
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.pipeline.differences import differing_sidecars
from stepbot.pipeline.stages import convert
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.model import Base, Robot
from stepbot.runtime.cache import Cache
from tests.command_line import stepbot

from .described import ARM, box, composing, joint, link, urdf

Compose = Callable[[Mapping[str, str], Diagnostics], Robot]
Write = Callable[[Mapping[str, str]], None]

TOOL = urdf(
    "tool",
    link("body"),
    link("plate"),
    link("jaw"),
    joint("fixed", "body", "plate", "fixed", xyz="0 0 0.1", rpy="0 1.5707963267948966 0"),
    joint("jaw", "plate", "jaw", "prismatic", axis="1 0 0"),
)


def test_attached_by_a_link_that_is_fixed_to_the_root(composed: Compose) -> None:
    """`by` the plate, 0.1 m above the body and turned by 90 degrees, puts the body beside the arm's tip."""
    files = {
        "r.robot.yaml": composing(
            "arm: {file: arm.urdf, prefix: ''}", "tool: {file: tool.urdf, at: arm/tip, by: plate}"
        )
    }
    robot = composed({**files, "arm.urdf": ARM, "tool.urdf": TOOL}, Diagnostics())
    poses = link_poses(robot, {})
    assert poses["tool_plate"].distance_to(poses["tip"]) == pytest.approx((0.0, 0.0), abs=1e-12)
    turned = Pose.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, -pi / 2, 0.0)) @ Pose.from_xyz_rpy((0.0, 0.0, -0.1), (0, 0, 0))
    assert poses["tool_body"].distance_to(poses["tip"] @ turned) == pytest.approx((0.0, 0.0), abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("q", [0.0, 0.4, -0.9])
def test_a_joint_turns_about_its_port(q: float, composed: Compose) -> None:
    """A joint whose child is a port beside the root link: the port stays, and everything turns about its axis."""
    more = "joints: {swing: {type: revolute, parent: arm/tip, child: tool/plate, axis: x, "
    more += "limits: {lower: -1, upper: 1, effort: 9, velocity: 1}}}\n"
    files = {"r.robot.yaml": composing("arm: {file: arm.urdf, prefix: ''}", "tool: {file: tool.urdf}", more=more)}
    robot = composed({**files, "arm.urdf": ARM, "tool.urdf": TOOL}, Diagnostics())
    poses = link_poses(robot, {"swing": q, "tool_jaw": 0.25})
    X_PlateBody = (Pose.from_xyz_rpy((0.0, 0.0, 0.1), (0.0, pi / 2, 0.0))).inverse()
    turn = poses["tip"] @ Pose.from_xyz_rpy((0.0, 0.0, 0.0), (q, 0.0, 0.0))
    expected = {"tool_plate": turn, "tool_jaw": turn @ Pose.from_xyz_rpy((0.25, 0.0, 0.0), (0.0, 0.0, 0.0))}
    for name, pose in expected.items():
        assert poses[name].distance_to(pose) == pytest.approx((0.0, 0.0), abs=1e-9), name
    # The frame of the body is moved onto the axis; its mass stays where it was.
    body = robot.link_by_name["tool_body"].mass_properties
    com = poses["tool_body"].apply(np.array([body.com]))[0]
    assert com == pytest.approx((turn @ X_PlateBody).apply(np.array([[0.01, 0.02, 0.03]]))[0], abs=1e-9)


def test_a_frame_relative_to_another_module(composed: Compose) -> None:
    """A tool centre on the arm, measured from the hand that is fixed to it; beyond a joint it is an error."""
    modules = ("arm: {file: arm.urdf, prefix: ''}", "tool: {file: tool.urdf, at: arm/tip, offset: {xyz: [1, 2, 3]}}")
    more = "frames: {tcp: {link: arm/tip, origin: {xyz: [0, 0, 0.5], relative_to: tool/plate}}}\n"
    files = {"arm.urdf": ARM, "tool.urdf": TOOL}
    robot = composed({"r.robot.yaml": composing(*modules, more=more), **files}, Diagnostics())
    (tcp,) = [frame for frame in robot.frames if frame.name == "tcp"]
    assert tcp.link == "tip"
    assert tcp.X_LF.p == pytest.approx((1.5, 2.0, 3.1), abs=1e-12)  # z of the plate is x of the tip


@pytest.mark.parametrize(
    ("more", "error"),
    [
        ("frames: {f: {link: arm/tip, origin: {relative_to: tool/jaw}}}", "'tool/jaw' moves relative to 'arm/tip'"),
        ("  pin: {file: arm.urdf, at: f}\nframes: {f: {link: arm/tip, origin: {relative_to: tool/body}}}", "attached"),
    ],
)
def test_a_frame_that_nothing_places(more: str, error: str, errors: Callable[..., list[str]]) -> None:
    """A frame relative to what moves, and a port that is relative to a part that is not yet placed."""
    modules = ("arm: {file: arm.urdf, prefix: ''}", "tool: {file: tool.urdf, at: arm/tip}")
    files = {"r.robot.yaml": composing(*modules, more=more + "\n"), "arm.urdf": ARM, "tool.urdf": TOOL}
    (line,) = errors(files, Diagnostics())
    assert line.startswith("SB154")
    assert error in line


@pytest.mark.parametrize("scale", [1.0, 1.1])
def test_expected_values_of_modules(scale: float, composed: Compose) -> None:
    """`expect` names links and frames of modules by their paths, as all of the sidecar does."""
    inner = composing("arm: {file: arm.urdf, prefix: a-}", "tool: {file: tool.urdf, at: arm/tip}")
    # the plate is 0.1 m above the tip, and its slide points down: by 2 m, past the tip, or by -1 m
    expect = f"""expect:
  links:
    cell/arm/base: {{mass: {{value: {2.0 * scale} kg, within: 1 g}}}}
    cell: {{mass: {{value: 2 kg, within: 1 g}}}}
  reach: {{value: {1.9 * scale}, within: 1 um, to: cell/tool/jaw, start: cell/arm/tip}}
"""
    files = {"r.robot.yaml": composing("cell: {file: inner.robot.yaml}", more=expect), "inner.robot.yaml": inner}
    diagnostics = Diagnostics()
    composed({**files, "arm.urdf": ARM, "tool.urdf": TOOL}, diagnostics)
    faults = [one.message for one in diagnostics if one.code == "SB525"]
    assert len(faults) == (2 if scale > 1.0 else 0), faults


def test_a_narrow_expectation_shows_what_differs(composed: Compose) -> None:
    """Values and shares have the digits that the tolerance needs: neither is `2 kg, 2 kg expected`, nor 0 %."""
    expect = "expect: {links: {arm/base: {mass: {value: 2.00001 kg, within: 0.0001 %}}}}\n"
    diagnostics = Diagnostics()
    composed({"r.robot.yaml": composing("arm: {file: arm.urdf}", more=expect), "arm.urdf": ARM}, diagnostics)
    (fault,) = (one.message for one in diagnostics if one.code == "SB525")
    assert fault.endswith("is 2 kg, 2.00001 kg expected: -0.0005%, 0.0001% allowed")


@pytest.mark.parametrize("kind", ["joint", "frame", "link", "of the file"])
def test_the_joint_of_a_module_takes_no_name(kind: str, tmp_path: Path, write: Write) -> None:
    """A module may have a port or joint that is called `mount`, and the file a joint: all keep their names."""
    names = {"joint": ("plate", "mount"), "link": ("mount", "fixed")}.get(kind, ("plate", "fixed"))
    plate = joint(names[1], "body", names[0], "fixed", xyz="0 0 0.1")
    limits = "limits: {lower: -1, upper: 1, effort: 9, velocity: 1}"
    swing = f"joints: {{tool_mount: {{type: revolute, parent: arm/base, child: hand, {limits}}}}}\n"
    more = {
        "frame": "frames: {tool_mount: {link: tool/plate, origin: {relative_to: tool/plate}}}\n",
        "of the file": swing,
    }
    modules = ["arm: {file: arm.urdf, prefix: ''}", "tool: {file: tool.urdf, at: arm/tip}"]
    modules += ["hand: {file: arm.urdf}"] if kind == "of the file" else []
    tool = urdf("tool", link("body"), link(names[0]), plate)
    write({"r.robot.yaml": composing(*modules, more=more.get(kind, "")), "arm.urdf": ARM, "tool.urdf": tool})
    run = stepbot("convert", "r.robot.yaml", "-o", "out", "-f", "urdf,mjcf", "--no-verify", "--no-cache", cwd=tmp_path)
    assert run.code == 0, run.err
    assert "SB761" not in run.err
    text = (tmp_path / "out" / "whole.urdf").read_text(encoding="utf-8")
    assert {'name="tool_mount"', 'name="tool_mount_joint"'} <= set(re.findall(r'name="tool_mount\w*"', text))


def test_the_world_of_a_module_is_dropped(composed: Compose) -> None:
    """A URDF whose root is a massless `world` brings neither a second world nor its joint."""
    standing = urdf("w", '<link name="world"/>', link("base"), joint("stand", "world", "base", "fixed", xyz="0 0 1"))
    files = {"r.robot.yaml": composing("arm: {file: arm.urdf}", "tool: {file: w.urdf, at: arm/tip}"), "arm.urdf": ARM}
    robot = composed({**files, "w.urdf": standing}, Diagnostics())
    assert [one.name for one in robot.links] == ["arm_base", "arm_tip", "tool_base"]


def test_names_that_formats_do_not_like(composed: Compose) -> None:
    """Instances and prefixes with spaces, `$` and letters of other languages are kept as they are."""
    modules = ("'dö $x': {file: arm.urdf}", "b: {file: arm.urdf, at: 'dö $x/tip', prefix: 'ä $ '}")
    robot = composed({"r.robot.yaml": composing(*modules), "arm.urdf": ARM}, Diagnostics())
    assert [one.name for one in robot.links] == ["dö $x_base", "dö $x_tip", "ä $ base", "ä $ tip"]


CUBE = "".join(f"v {i & 1} {i >> 1 & 1} {i >> 2}\n" for i in range(8)) + "".join(
    f"f {a} {b} {d}\nf {a} {d} {c}\n"
    for a, b, c, d in [(1, 3, 2, 4), (5, 6, 7, 8), (1, 2, 5, 6), (3, 7, 4, 8), (1, 5, 3, 7), (2, 4, 6, 8)]
)
"""A cube of 1 m as a mesh."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "place", "expected"),
    [
        ("mesh", "at: a, offset: {xyz: [0, 0, 1]}", ""),
        ("mesh", "at: a, offset: {xyz: [0.5, 0, 0.99]}", "SB166:overlap 'b_cube' of link 'b_cube' shares 5e+03 cm^3"),
        (
            "mesh",
            "at: a, offset: {xyz: [1.2, 0.3, 0], rpy: [0, 0, 90 deg]}",
            "SB166:overlap 'b_cube' shares 5.6e+05 cm^3",
        ),
        ("mesh", "at: a, offset: {xyz: [0.5, 0.9995, 0]}", ""),  # less than a thousandth of it
        ("open mesh", "at: a, offset: {xyz: [0.5, 0, 0.9]}", ""),
        ("mesh", "at: a", "SB166:part 'b_cube' of link 'b_cube'"),
        ("box", "at: a", "SB166:part 'b_cube' of link 'b_cube'"),
        ("box", "at: a, offset: {xyz: [0.5, 0, 0]}", ""),
        ("mesh", "joint", ""),  # what moves can be in contact, which engines report
    ],
)
def test_what_is_inside_its_neighbour_is_reported(
    shape: str, place: str, expected: str, tmp_path: Path, composed: Compose
) -> None:
    """The common volume is that of two boxes; what only touches, is no solid, or moves, is none."""
    (tmp_path / "cube.obj").write_text(CUBE if shape == "mesh" else CUBE.rpartition("f")[0], encoding="utf-8")
    geometry = '<box size="1 1 1"/>' if shape == "box" else '<mesh filename="cube.obj"/>'
    more = "joints: {turn: {type: continuous, parent: a, child: b}}\n" if place == "joint" else ""
    modules = (
        "root: {file: root.urdf}",
        "a: {file: m.urdf, at: root, offset: {xyz: [5, 0, 0], rpy: [0, 0, 30 deg]}}",
        f"b: {{file: m.urdf, {place if not more else ''}}}",
        "c: {file: m.urdf, at: b, offset: {xyz: [0, 0, 7]}}",  # each body has parts of several modules
    )
    twice = link("box", 1.0, 2 * box(1, 1, 1))
    files = {
        "r.robot.yaml": composing(*modules, more=more),
        "root.urdf": urdf("root", twice),
        "m.urdf": urdf("m", link("cube", 1.0, f'<visual name="cube"><geometry>{geometry}</geometry></visual>')),
    }
    diagnostics = Diagnostics()
    composed(files, diagnostics)
    texts = [f"{one.code} {one.message}" for one in diagnostics if one.code.startswith("SB166")]
    if not expected:
        assert not texts
    else:
        (text,) = texts
        code, _, rest = expected.partition(" ")
        part, _, volume = rest.partition(" shares ")
        assert text.startswith(f"{code} module 'b': ")
        assert part in text
        assert text.endswith(volume)


def test_shapes_of_two_kinds_are_not_one_part(composed: Compose) -> None:
    """A ball of a diameter of 1 m is not a cube of 1 m, though their boxes are equal."""
    ball = '<visual><geometry><sphere radius="0.5"/></geometry></visual>'
    files = {
        "r.robot.yaml": composing("a: {file: cube.urdf}", "b: {file: ball.urdf, at: a}"),
        "cube.urdf": urdf("cube", link("cube", 1.0, box(1, 1, 1))),
        "ball.urdf": urdf("ball", link("ball", 1.0, ball)),
    }
    diagnostics = Diagnostics()
    composed(files, diagnostics)
    assert not [one for one in diagnostics if one.code.startswith("SB166")]


@pytest.mark.slow
@pytest.mark.parametrize(("port", "codes"), [("tool0", set()), ("flange", {"SB166:overlap"})])
def test_a_hand_on_the_flange_is_inside_the_wrist(port: str, codes: set[str], composed: Compose) -> None:
    """REP 199's `flange` has x outwards: the hand sticks out sideways, through the last link."""
    text = composing('arm: {file: "library:ur5e"}', f'hand: {{file: "library:2f85", at: arm/{port}}}')
    diagnostics = Diagnostics()
    composed({"r.robot.yaml": text}, diagnostics)
    assert {one.code for one in diagnostics if one.code.startswith("SB166")} == codes


@pytest.mark.parametrize("first", ["a", "z"])
def test_meshes_are_written_in_the_order_of_their_names(first: str, tmp_path: Path, composed: Compose) -> None:
    """Whichever module comes first."""
    second = {"a": "z", "z": "a"}[first]
    files = {"r.robot.yaml": composing(f"m: {{file: {first}.urdf}}", f"n: {{file: {second}.urdf, at: m}}")}
    for name in "az":
        (tmp_path / f"{name}.obj").write_text(CUBE.replace("v 1", f"v 1.{ord(name)}"), encoding="utf-8")
        shape = f'<visual><geometry><mesh filename="{name}.obj"/></geometry></visual>'
        files[f"{name}.urdf"] = urdf(name, link("body", 1.0, shape))
    assert [one.name for one in composed(files, Diagnostics()).meshes] == ["a", "z"]


@pytest.mark.slow
def test_meshes_of_one_name_with_other_bytes(tmp_path: Path, write: Write) -> None:
    """Each module has its own `part.obj`; MuJoCo loads the right size for both, and no third file."""
    files = {
        "r.robot.yaml": composing(
            "a: {file: a/m.urdf}", "b: {file: b/m.urdf, at: a/base}", "c: {file: a/m.urdf, at: b/base}"
        )
    }
    shape = "<visual><geometry><mesh filename='part.obj'/></geometry></visual>"
    write(files)
    for folder, size in (("a", 1.0), ("b", 3.0)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "m.urdf").write_text(urdf("m", link("base", 1.0, shape)), encoding="utf-8")
        points = "".join(f"v {x} {y} {z}\n" for x, y, z in [(0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size)])
        faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
        (tmp_path / folder / "part.obj").write_text(points + faces, encoding="utf-8")
    made = _converted(tmp_path / "r.robot.yaml", ("mjcf",))
    assert len([path for path in made.files if path.startswith("meshes/")]) == 2
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "whole.xml"))
    volumes = {model.body(model.geom_bodyid[i]).name: model.geom_aabb[i][3:].max() * 2 for i in range(model.ngeom)}
    assert volumes["b_base"] == pytest.approx(3.0 * volumes["a_base"], rel=1e-6)
    assert volumes["c_base"] == volumes["a_base"]


def _converted(sidecar: Path, formats: tuple[str, ...]) -> Conversion:
    made = convert(sidecar, Options(sidecar.parent / "out", formats=formats, verify=False))
    assert not made.diagnostics.has_errors, list(made.diagnostics)
    return made


def test_a_massless_root_stays_massless(tmp_path: Path, write: Write) -> None:
    """PyBullet, which gives links without inertia 1 kg, loads the mass of the modules."""
    light = urdf("light", '<link name="base_link"/>', link("base", 2.0), joint("f", "base_link", "base", "fixed"))
    files = {"r.robot.yaml": composing("arm: {file: arm.urdf}", "tool: {file: light.urdf, at: arm/tip}")}
    write({**files, "arm.urdf": ARM, "light.urdf": light})
    _converted(tmp_path / "r.robot.yaml", ("urdf", "mjcf"))
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out/whole.xml"))
    assert model.body_mass.sum() == pytest.approx(5.0)
    pybullet = pytest.importorskip("pybullet")
    client = pybullet.connect(pybullet.DIRECT)
    try:
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE | pybullet.URDF_MERGE_FIXED_LINKS
        body = pybullet.loadURDF(str(tmp_path / "out/whole.urdf"), flags=flags, physicsClientId=client)
        joints = pybullet.getNumJoints(body, physicsClientId=client)
        masses = [pybullet.getDynamicsInfo(body, i, physicsClientId=client)[0] for i in range(-1, joints)]
    finally:
        pybullet.disconnect(client)
    assert sum(masses) == pytest.approx(5.0)


def test_an_arm_on_a_floating_base_stands_on_the_floor(tmp_path: Path, write: Write) -> None:
    """`home` has 7 numbers for the base and one for each joint, and the lowest point of the whole is at z = 0."""
    cart = urdf("cart", link("chassis", 9.0, box(0.4, 0.4, 0.2)))
    sidecar = composing(
        "cart: {file: cart.urdf, prefix: ''}", "arm: {file: arm.urdf, at: cart/chassis, home: {lift: 0.5}}"
    )
    write({"r.robot.yaml": sidecar.replace("base: fixed", "base: floating"), "cart.urdf": cart, "arm.urdf": ARM})
    made = _converted(tmp_path / "r.robot.yaml", ("mjcf",))
    assert made.robot is not None
    assert made.robot.base is Base.FLOATING
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out/whole.xml"))
    assert (model.nkey, model.nq) == (1, 8)
    assert model.key_qpos[0] == pytest.approx([0, 0, 0.1, 1, 0, 0, 0, 0.5])
    report = json.loads((tmp_path / "out/report.json").read_text(encoding="utf-8"))
    assert report["robot"]["standing_height"] == pytest.approx(0.1)


def test_devices_keep_their_order(tmp_path: Path, write: Write) -> None:
    """Actuators are in the order of the modules, own ones first, whatever sensors and frames are added."""
    drives = "actuators: {own: {joint: b/lift, kind: motor}, other: {joint: a/lift, kind: motor}}\n"
    more = "sensors: {imu: {type: imu, link: a/tip}}\nframes: {tcp: {link: b/tip, origin: {relative_to: b/tip}}}\n"
    modules = ("a: {file: arm.urdf}", "b: {file: arm.urdf, at: a/tip}")
    orders = []
    for text in (drives, drives + more):
        write({"r.robot.yaml": composing(*modules, more=text), "arm.urdf": ARM})
        _converted(tmp_path / "r.robot.yaml", ("mjcf",))
        model = mujoco.MjModel.from_xml_path(str(tmp_path / "out/whole.xml"))
        orders.append([model.actuator(i).name for i in range(model.nu)])
    assert orders == [["own", "other"]] * 2


@pytest.mark.slow
def test_a_batch_takes_modules_and_the_robots_of_them(tmp_path: Path, write: Write) -> None:
    """Every sidecar of a folder is converted, in any order of names; one whose module is missing fails alone."""
    inner = composing("arm: {file: arm.urdf}").replace("robot: whole", "robot: inner")
    files = {"z.robot.yaml": inner, "arm.urdf": ARM}
    for name in ("a", "zz"):
        files[f"{name}.robot.yaml"] = composing("m: {file: z.robot.yaml}").replace("robot: whole", f"robot: {name}")
    variants = "variants: {gone: {modules: {m: {file: missing.urdf}}}}\n"
    files["b.robot.yaml"] = composing("m: {file: arm.urdf}", more=variants).replace("robot: whole", "robot: b")
    write(files)
    options = ("--no-verify", "-f", "urdf", "--no-cache", "--json", "-j", "1")
    run = stepbot("batch", ".", "-o", "out", *options, cwd=tmp_path)
    status = {one["name"]: one["status"] for one in json.loads(run.out)["robots"]}
    assert status == {**dict.fromkeys(("a", "b", "z", "zz"), "converted"), "b_gone": "failed"}, run.out
    assert run.code == 1


def test_an_arm_on_a_slide_moves_as_its_mass(tmp_path: Path, write: Write) -> None:
    """Prismatic mount: the mass matrix has the mass of all that slides, and the coupling with the tool's own slide."""
    more = "joints: {axis: {type: prismatic, parent: arm/tip, child: tool, axis: x, "
    more += "limits: {lower: 0, upper: 1, effort: 9, velocity: 1}}}\n"
    write({"r.robot.yaml": composing("arm: {file: arm.urdf, prefix: ''}", "tool: {file: tool.urdf}", more=more)})
    write({"arm.urdf": ARM, "tool.urdf": TOOL})
    _converted(tmp_path / "r.robot.yaml", ("mjcf",))
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out/whole.xml"))
    data = mujoco.MjData(model)
    data.qpos[:] = 0.1, 0.2, 0.3
    mujoco.mj_forward(model, data)
    matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, matrix)
    slide, jaw = (model.joint(name).dofadr[0] for name in ("axis", "tool_jaw"))
    assert matrix[slide, slide] == pytest.approx(3.0, rel=1e-12)
    assert matrix[jaw, jaw] == pytest.approx(1.0, rel=1e-12)
    assert matrix[slide, jaw] == pytest.approx(0.0, abs=1e-12)  # the plate is turned by 90 degrees


@pytest.mark.slow
def test_a_hand_is_left_out(composed: Compose) -> None:
    """YuMi without its right gripper: its links, joints and drive are gone with their mass, and the left one stays."""
    whole, bare = (
        composed({"r.robot.yaml": composing(f"yumi: {{file: 'library:yumi', prefix: ''{less}}}")}, Diagnostics())
        for less in ("", ", without: [gripper_r_base]")
    )
    gone = {one.name for one in whole.links} - {one.name for one in bare.links}
    assert "gripper_r_base" in gone
    assert len(gone) == 3
    assert all(name.startswith("gripper_r") for name in gone)
    assert len(whole.joints) - len(bare.joints) == 3
    assert len(whole.actuators) - len(bare.actuators) == 1
    masses = [sum(one.mass_properties.mass for one in robot.links) for robot in (whole, bare)]
    assert masses[0] - masses[1] == pytest.approx(sum(whole.link_by_name[one].mass_properties.mass for one in gone))
    for name, link_of_both in bare.link_by_name.items():
        assert link_of_both.mass_properties == whole.link_by_name[name].mass_properties, name


@pytest.mark.slow
def test_a_module_that_is_mounted_elsewhere_is_one_difference(tmp_path: Path, write: Write) -> None:
    """Its links, and what is fixed to it, are compared within it: one changed limit is the only other difference."""
    whole = """
        version: 1
        robot: both
        modules:
          arm: {file: arm.urdf, prefix: ""}
          hand: {file: arm.urdf, at: arm/tip, offset: {rpy: [0, 0, ANGLE deg]}}
          tool: {file: arm.urdf, at: hand/tip, set: {joints: {lift: {limits: {upper: UPPER}}}}}
        """
    files = {f"{angle}.robot.yaml": whole.replace("ANGLE", angle).replace("UPPER", "0.7") for angle in ("0", "30")}
    changed = whole.replace("ANGLE", "30").replace("UPPER", "0.6")
    one_less = whole.replace("ANGLE", "0").partition("          tool:")[0]
    base = whole.replace("at: arm/tip", "at: arm/base").replace("ANGLE", "30").replace("UPPER", "0.7")
    swapped = whole.replace("ANGLE", "0").replace("UPPER", "0.7").replace("at: hand/tip", "at: arm/tip")
    swapped = swapped.replace("hand: {file: arm.urdf, at: arm/tip", "hand: {file: arm.urdf, at: tool/tip")
    files |= {"base.robot.yaml": base, "swapped.robot.yaml": swapped}
    write({"arm.urdf": ARM, **files, "limit.robot.yaml": changed, "less.robot.yaml": one_less})
    options = Options(tmp_path / "out", cache=Cache(tmp_path / "cache"))

    def rows(old: str, new: str) -> list[tuple[str, str, str]]:
        diagnostics = Diagnostics()
        made = differing_sidecars(tmp_path / f"{old}.robot.yaml", tmp_path / f"{new}.robot.yaml", options, diagnostics)
        assert made is not None, list(diagnostics)
        return [(row.kind, row.name, row.detail) for row in made.rows]

    turned = ("modules", "module 'hand' on link 'tip'", "turned by 30 deg")
    assert rows("0", "0") == []
    assert rows("0", "30") == [turned]
    other = ("modules", "module 'hand'", "on link 'base', formerly on 'tip'")
    assert rows("30", "base") == [other]
    assert rows("base", "0") == [(*other[:2], "on link 'tip', formerly on 'base'")]
    swapped = rows("0", "swapped")  # the tool carries the hand
    assert ("modules", "module 'tool'", "on link 'tip', formerly on 'hand_tip'") in swapped
    assert ("modules", "module 'hand'", "on link 'tool_tip', formerly on 'tip'") in swapped
    limits = rows("0", "limit")
    assert limits[0] == turned
    assert {kind for kind, _, _ in limits[1:]} <= {"limits", "actuators"}
    assert any("tool_lift" in name for _, name, _ in limits[1:])
    assert rows("less", "0")[0] == ("modules", "module 'tool'", "added")
    assert rows("0", "less")[0] == ("modules", "module 'tool'", "removed")


@pytest.mark.parametrize("ends", ["link_a: k/b, link_b: far", "link_a: far, link_b: k/b"])
def test_frames_of_a_closure_between_modules_coincide(ends: str, composed: Compose) -> None:
    """Bars whose ends meet at an angle: formats that state one frame of a revolute closure have the other from it.

    So are they in a module whose root turns about another frame, where sensors and frames stay at their places, too.
    """
    bar = urdf("bar", link("a"), link("b"), joint("end", "a", "b", "fixed", xyz="0.2 0 0"))
    turned = "{type: revolute, axis: z, parent: %s, child: %s, origin: {offset: {rpy: [0, 0, %s deg]}}, %s}"
    limits = "limits: {lower: -1, upper: 1, effort: 1, velocity: 1}"
    more = f"""frames:
  far: {{link: g/a, origin: {{xyz: [0.2, 0, 0], relative_to: g/a}}}}
  hinge: {{link: g/a, origin: {{xyz: [0.1, 0.05, 0], rpy: [0, 0, 20 deg], relative_to: g/a}}}}
joints:
  p1: {turned % ("g/a", "c/a", 60, limits)}
  p2: {turned % ("c/b", "k/a", -120, limits)}
sensors: {{imu: {{type: imu, link: g/a, origin: {{xyz: [0.2, 0, 0], relative_to: g/a}}}}}}
closures: {{pin: {{type: revolute, {ends}, axis: z, origin: {{offset: {{xyz: [0, 0, 5 mm]}}}}}}}}
"""
    triangle = composing(*(f"{name}: {{file: bar.urdf}}" for name in "gck"), more=more)
    whole = composing(
        "base: {file: bar.urdf}",
        "triangle: {file: triangle.robot.yaml}",
        more=f"joints: {{turn: {turned % ('base/b', 'triangle/hinge', 0, limits)}}}",
    )
    files = {"triangle.robot.yaml": triangle, "bar.urdf": bar}
    for one in (files, {"r.robot.yaml": whole, **files}):
        robot = composed(one, Diagnostics())
        (pin,), (imu,) = robot.closures, robot.sensors
        far = next(one for one in robot.frames if one.name.endswith("far"))
        X = link_poses(robot, initial_configuration(robot))
        X_A, X_B = X[pin.link_a] @ pin.X_AF, X[pin.link_b] @ pin.X_BF
        assert X_A.distance_to(X_B) == pytest.approx((0.0, 0.0), abs=1e-9)
        assert (X_A.turn(pin.axis)[2], X_A.position[2]) == pytest.approx((1.0, 0.005))
        X_end = next(pose for name, pose in X.items() if name.endswith("g_b"))
        for there in (X[far.link] @ far.X_LF, X[imu.link] @ imu.X_LS):
            assert there.distance_to(X_end) == pytest.approx((0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize(
    ("first", "second", "follows", "expected"),
    [("0.003", "0.0005", "", 0.0005), ("0.003", "", "", 0.003), ("0.003", "", "'a'", 0.001), ("", "", "'a'", None)],
)
def test_the_time_step_is_one_that_all_modules_can_take(
    first: str, second: str, follows: str, expected: float | None, composed: Compose
) -> None:
    """The smallest of those stated; 1 ms beside a mimic where a module states none. So is the stiffness of loops."""
    mimic = {"mimic": follows} if follows else {}
    links = [link(name) for name in ("base", "one", "two")]
    arm = urdf("arm", *links, joint("a", "base", "one"), joint("b", "one", "two", **mimic))
    files = {"r.robot.yaml": composing("x: {file: x.robot.yaml}", "y: {file: y.robot.yaml, at: x/arm/two}")}
    for name, step in (("x", first), ("y", second)):
        stiffness = {"x": 0.5, "y": 0.25}[name]
        settings = f"simulation: {{closure_stiffness: {stiffness}{f', timestep: {step}' if step else ''}}}"
        files[f"{name}.robot.yaml"] = composing("arm: {file: arm.urdf}", more=settings)
    settings_of_all = composed({**files, "arm.urdf": arm}, Diagnostics()).simulation
    assert (settings_of_all.timestep, settings_of_all.closure_stiffness) == (expected, 0.25)
