"""Each number changed in a file is detected by every engine that reports its quantity."""

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.engines.observation import Observation, Quantity, Request
from tests.mutation.judge import question
from tests.robots import ROBOTS
from tests.simulators.conftest import Folder, failures, look, write

Q = Quantity

URDF = {
    "mass": ("two_link_arm", r'(<mass value=")([^"]*)', 1.001, {"mujoco", "pybullet", "yourdfpy"}, Q.MASS),
    "com": ("two_link_arm", r'(<origin xyz=")(0\.1[^ ]*)', 1.001, {"mujoco", "pybullet", "yourdfpy"}, Q.COM),
    "ixx": ("two_link_arm", r'(ixx=")([^"]*)', 1.001, {"mujoco", "pybullet", "yourdfpy"}, Q.INERTIA),
    "iyz": ("two_link_arm", r'(iyz=")([1-9][^"]*)', -1.0, {"mujoco", "pybullet", "yourdfpy"}, Q.INERTIA),
    "axis": ("two_link_arm", r'(<axis xyz="0 )(0.6)', 1.001, {"mujoco", "pybullet", "yourdfpy"}, Q.AXES),
    "lower": ("two_link_arm", r'(lower=")([^"]*)', 1.001, {"mujoco", "pybullet", "yourdfpy"}, Q.LIMITS),
    "effort": ("two_link_arm", r'(effort=")([^"]*)', 1.001, {"mujoco", "pybullet", "yourdfpy"}, Q.LIMITS),
    "velocity": ("two_link_arm", r'(velocity=")([^"]*)', 1.001, {"pybullet", "yourdfpy"}, Q.LIMITS),
    "damping": ("two_link_arm", r'(damping=")([^"]*)', 1.001, {"mujoco", "pybullet", "yourdfpy"}, Q.DYNAMICS),
    "friction": ("two_link_arm", r'(friction=")(0[^"]+)', 1.001, {"mujoco", "pybullet", "yourdfpy"}, Q.DYNAMICS),
    "place": ("two_link_arm", r'(<origin xyz=")(0.33333[^ ]*)', 1.001, {"mujoco", "pybullet", "yourdfpy"}, Q.POSES),
    "turn": (
        "two_link_arm",
        r'(<joint name="shoulder"[^$]*?rpy=")([^ ]*)',
        1.001,
        {"mujoco", "pybullet", "yourdfpy"},
        Q.POSES,
    ),
    "multiplier": ("gripper_with_mimic", r'(multiplier=")([^"]*)', 1.001, {"mujoco", "yourdfpy"}, Q.MIMIC),
    "offset": ("gripper_with_mimic", r'(<mimic[^>]*offset=")(0.1[^"]*)', 1.001, {"mujoco", "yourdfpy"}, Q.MIMIC),
    "box": ("primitives", r'(<collision name="box[^$]*?size=")([^ ]*)', 1.01, {"mujoco", "pybullet"}, Q.MESHES),
    "visual": ("primitives", r'(<visual name="cylinder[^$]*?length=")([^"]*)', 1.01, {"mujoco"}, Q.MESHES),
    "spring": ("equipped", r"(<springStiffness>)([^<]*)", 1.001, {"extensions"}, Q.DYNAMICS),
    "gain": ("equipped", r'(<param name="kp">)([^<]*)', 1.001, {"extensions"}, Q.ACTUATORS),
    "input": ("equipped", r'(<param name="max">)([^<]*)', 1.001, {"extensions"}, Q.ACTUATORS),
    "force": ("equipped", r'(<param name="max_effort">)([^<]*)', 1.001, {"extensions"}, Q.ACTUATORS),
    "reduction": ("equipped", r"(<mechanical_reduction>)([^<]*)", 1.001, {"extensions"}, Q.ACTUATORS),
    "rate": ("equipped", r"(<update_rate>)([^<]*)", 1.001, {"extensions"}, Q.SENSORS),
    "place of a sensor": (
        "equipped",
        r'(<joint name="imu_mount"[^$]*?xyz=")([^ ]*)',
        1.001,
        {"mujoco", "pybullet"},
        Q.POSES,
    ),
    "fov": ("equipped", r"(<horizontal_fov>)([^<]*)", 1.001, {"extensions"}, Q.SENSORS),
}
SDF = {
    "mass": ("two_link_arm", r"(<mass>)([^<]*)", 1.001, {"pybullet", "reader"}, Q.MASS),
    "com": ("two_link_arm", r"(<inertial>\s*<pose>)(0\.1[^ ]*)", 1.001, {"pybullet", "reader"}, Q.COM),
    "ixx": ("two_link_arm", r"(<ixx>)([^<]*)", 1.001, {"reader"}, Q.INERTIA),
    "axis": ("two_link_arm", r"(<xyz>0 )(0.6)", 1.001, {"pybullet", "reader"}, Q.AXES),
    "lower": ("two_link_arm", r"(<lower>)([^<]*)", 1.001, {"pybullet", "reader"}, Q.LIMITS),
    "effort": ("two_link_arm", r"(<effort>)([^<]*)", 1.001, {"pybullet", "reader"}, Q.LIMITS),
    "velocity": ("two_link_arm", r"(<velocity>)([^<]*)", 1.001, {"pybullet", "reader"}, Q.LIMITS),
    "damping": ("two_link_arm", r"(<damping>)([^<]*)", 1.001, {"pybullet", "reader"}, Q.DYNAMICS),
    "stiffness": ("slider", r"(<spring_stiffness>)([^<]*)", 1.001, {"reader"}, Q.DYNAMICS),
    "place": ("two_link_arm", r'(<link name="forearm">\s*<pose>)([^ ]*)', 1.001, {"pybullet", "reader"}, Q.POSES),
    "multiplier": ("gripper_with_mimic", r"(<multiplier>)(-[^<]*)", 1.001, {"reader"}, Q.MIMIC),
    "frame": ("two_link_arm", r"(<frame [^>]*>\s*<pose>)([^ ]*)", 1.001, {"reader"}, Q.FRAMES),
    "closure": ("four_bar", r'(<joint name="rocker_pin"[^$]*?<pose>)([^ ]*)', 1.001, {"reader"}, Q.CLOSURES),
    "box": ("primitives", r'(<collision name="box[^$]*?<size>)([^ ]*)', 1.01, {"reader"}, Q.MESHES),
    "visual": ("primitives", r'(<visual name="cylinder[^$]*?<length>)([^<]*)', 1.01, {"reader"}, Q.MESHES),
    "colour": ("two_link_arm", r"(<diffuse>)([^ ]*)", 0.9, {"drake"}, Q.SHAPES),
    "colour in the shade": ("two_link_arm", r"(<ambient>)([^ ]*)", 0.9, {"drake"}, Q.SHAPES),
    "gain": ("equipped", r"(<p_gain>)([^<]*)", 1.001, {"reader"}, Q.ACTUATORS),
    "force": ("equipped", r"(<cmd_max>)([^<]*)", 1.001, {"reader"}, Q.ACTUATORS),
    "imu": ("equipped", r'(<sensor name="imu"[^$]*?<pose>)([^ ]*)', 1.001, {"reader"}, Q.SENSORS),
    "samples": ("equipped", r"(<samples>)([^<]*)", 2.0, {"reader"}, Q.SENSORS),
    "scan": ("equipped", r"(<max_angle>)([^<]*)", 1.001, {"reader"}, Q.SENSORS),
    "clip": ("equipped", r"(<far>)([^<]*)", 1.001, {"reader"}, Q.SENSORS),
}
MJCF = {
    "mass": ("two_link_arm", r'(<inertial[^>]* mass=")([^"]*)', 1.001, {"mujoco"}, Q.MASS),
    "com": ("two_link_arm", r'(<inertial pos=")(0\.1[^ ]*)', 1.001, {"mujoco"}, Q.COM),
    "inertia": ("two_link_arm", r'(fullinertia=")([^ ]*)', 1.001, {"mujoco"}, Q.INERTIA),
    "axis": ("two_link_arm", r'(axis="0 )(0.6)', 1.001, {"mujoco"}, Q.AXES),
    "range": ("two_link_arm", r'(<joint[^>]* range=")([^ ]*)', 1.001, {"mujoco"}, Q.LIMITS),
    "effort": ("two_link_arm", r'(actuatorfrcrange="-)([^ ]*)', 0.5, {"mujoco"}, Q.LIMITS),
    "velocity": ("two_link_arm", r'(<numeric[^>]*data=")([^"]*)', 1.001, {"mujoco"}, Q.LIMITS),
    "armature": ("two_link_arm", r'(armature=")([^"]*)', 1.001, {"mujoco"}, Q.DYNAMICS),
    "stiffness": ("slider", r'(stiffness=")([^"]*)', 1.001, {"mujoco"}, Q.DYNAMICS),
    "place": ("two_link_arm", r'(<body name="forearm" pos=")([^ ]*)', 1.001, {"mujoco"}, Q.POSES),
    "mimic": ("gripper_with_mimic", r'(polycoef="[^ ]* )(-[^ "]*)', 1.001, {"mujoco"}, Q.MIMIC),
    "site": ("two_link_arm", r'(<site name="tool0" pos=")([^ ]*)', 1.001, {"mujoco"}, Q.FRAMES),
    "closure": ("four_bar", r'(<site name="rocker_pin::b" class="mark" pos=")([^ ]*)', 1.001, {"mujoco"}, Q.CLOSURES),
    "axis of closure": (
        "four_bar",
        r'(<site name="rocker_pin::b::axis" class="mark" pos=")([^ ]*)',
        1.01,
        {"mujoco"},
        Q.CLOSURES,
    ),
    "gain": ("two_link_arm", r'(kp=")([^"]*)', 1.001, {"mujoco"}, Q.ACTUATORS),
    "gear": ("two_link_arm", r'(gear=")([^"]*)', 1.001, {"mujoco"}, Q.ACTUATORS),
    "input": ("equipped", r'(ctrlrange="[^ ]* )([^"]*)', 1.001, {"mujoco"}, Q.ACTUATORS),
    "force": ("equipped", r'(forcerange="-)([^ ]*)', 0.5, {"mujoco"}, Q.ACTUATORS),
    "imu": ("equipped", r'(<site name="imu::site" class="mark" pos=")([^ ]*)', 1.001, {"mujoco"}, Q.SENSORS),
    "camera": ("equipped", r'(<camera[^>]*fovy=")([^"]*)', 1.001, {"mujoco"}, Q.SENSORS),
    "scan": ("equipped", r'(::ray::3"[^>]*quat=")([^ ]*)', 1.001, {"mujoco"}, Q.SENSORS),
    "reach": ("equipped", r'(cutoff=")([^"]*)', 1.001, {"mujoco"}, Q.SENSORS),
    "rate": ("equipped", r'(<gyro[^>]*interval=")([^"]*)', 1.001, {"mujoco"}, Q.SENSORS),
    "home": ("two_link_arm", r'(qpos="0 )([^"]*)', 1.001, {"mujoco"}, Q.INITIAL),
    "box": ("primitives", r'(<geom name="box touched"[^$]*?size=")([^ ]*)', 1.01, {"mujoco"}, Q.MESHES),
}
CASES = [
    pytest.param(written_in, engine, robot, pattern, factor, quantity, id=f"{written_in}-{engine}-{name}")
    for written_in, table in (("urdf", URDF), ("sdf", SDF), ("mjcf", MJCF))
    for name, (robot, pattern, factor, tellers, quantity) in table.items()
    for engine in sorted(tellers)
]


Right = Callable[[str, str], tuple[Path, Request, Observation]]


@pytest.fixture(scope="module")
def right(folders: dict[str, Folder]) -> Right:
    """For a robot and a format the right file, what is asked about it, and what should be observed; made once."""

    @cache
    def made(robot: str, written_in: str) -> tuple[Path, Request, Observation]:
        asked = question(folders[robot].request(written_in))
        return folders[robot].written[written_in].path, asked, folders[robot].expected(written_in, asked)

    return made


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Folder]:
    """The robots on disk whose files are changed."""
    names = dict.fromkeys(robot for table in (URDF, SDF, MJCF) for robot, *_ in table.values())
    return {name: write(ROBOTS[name](), tmp_path_factory.mktemp(name)) for name in names}


def damage(text: str, pattern: str, factor: float) -> str:
    """The text with the first number found by the pattern's second group multiplied."""
    match = re.search(pattern, text)
    assert match is not None, f"nothing to spoil: {pattern}"
    assert float(match[2]) != 0.0
    return text[: match.start(2)] + repr(float(match[2]) * factor) + text[match.end(2) :]


@pytest.mark.parametrize(("written_in", "engine", "robot", "pattern", "factor", "quantity"), CASES)
def test_a_wrong_number_is_noticed(
    written_in: str, engine: str, robot: str, pattern: str, factor: float, quantity: Quantity, right: Right
) -> None:
    """The quantity of the changed number fails; the unchanged file passes (see test_every_robot)."""
    path, asked, expected = right(robot, written_in)
    wrong = path.with_name(f"wrong{path.suffix}")
    wrong.write_text(damage(path.read_text(encoding="utf-8"), pattern, factor), encoding="utf-8")
    assert quantity in failures(expected, look(engine, replace(asked, file=str(wrong))))


@pytest.mark.parametrize(
    ("written_in", "engine"), [("urdf", "mujoco"), ("urdf", "pybullet"), ("sdf", "reader"), ("mjcf", "mujoco")]
)
def test_a_mesh_that_is_another_is_noticed(
    written_in: str, engine: str, folders: dict[str, Folder], tmp_path: Path
) -> None:
    """Exchanged meshes of two links are detected."""
    folder = write(folders["two_link_arm"].robot, tmp_path)
    one, other = (tmp_path / "meshes" / f"{name}_1.obj" for name in ("upper_arm", "forearm"))
    first, second = one.read_bytes(), other.read_bytes()
    one.write_bytes(second)
    other.write_bytes(first)
    request = question(folder.request(written_in))
    assert Quantity.MESHES in failures(folder.expected(written_in, request), look(engine, request))


@pytest.mark.parametrize(("written_in", "engine"), [("urdf", "pybullet"), ("urdf", "yourdfpy"), ("sdf", "reader")])
def test_joints_that_change_places_are_noticed(
    written_in: str, engine: str, folders: dict[str, Folder], tmp_path: Path
) -> None:
    """Exchanged names of two joints are detected."""
    folder = folders["floating_biped"] if "floating_biped" in folders else write(ROBOTS["floating_biped"](), tmp_path)
    right = folder.written[written_in].path
    text = right.read_text(encoding="utf-8")
    swapped = text.replace("left_knee", "@").replace("right_knee", "left_knee").replace("@", "right_knee")
    wrong = right.with_name(f"swapped{right.suffix}")
    wrong.write_text(swapped, encoding="utf-8")
    asked = question(folder.request(written_in))
    assert Quantity.JOINTS in failures(
        folder.expected(written_in, asked), look(engine, replace(asked, file=str(wrong)))
    )
