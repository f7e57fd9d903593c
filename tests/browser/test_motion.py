"""Joints and loops that the page solves, against MuJoCo."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import files_of, main_file
from stepbot.robot.model import Joint, JointKind, Robot
from stepbot.runtime.output import write_atomically
from stepbot.viewing.scene import scene_document
from tests.rigid import Array, pose
from tests.robots import ROBOTS

from .page import Page

pytestmark = pytest.mark.slow

SHARES = (0.31, 0.77)
"""Positions of all sliders, as shares of their ranges, one after the other."""
EACH_KIND = (
    *("ball", "cylindrical", "floating_biped", "four_bar", "gripper_with_mimic", "planar", "screw", "sliding_closure"),
    *("tree", "universal"),
)
"""Robots with every kind of joint, a mimic, and both kinds of closures."""
MODELS: dict[Path, tuple[Robot, Any]] = {}


def travel(joint: Joint, poses: Mapping[str, Array]) -> float:
    """Position [m] of a slide that the file has in place of a closure, from the poses of its links."""
    assert joint.kind is JointKind.PRISMATIC
    X_CQ = np.linalg.inv(joint.X_PC.matrix) @ np.linalg.inv(poses[joint.parent]) @ poses[joint.child]
    return float(X_CQ[:3, 3] @ joint.axis)


def compiled(folder: Path, robot: Robot) -> tuple[Robot, Any]:
    """The robot as MJCF expresses it, and MuJoCo's model of its file, written once to a folder."""
    import mujoco

    if folder not in MODELS:
        mjcf = format_named("mjcf")
        lowered = lower(robot, mjcf, Diagnostics())
        write_atomically(files_of(lowered, mjcf), folder)
        MODELS[folder] = lowered, mujoco.MjModel.from_xml_path(str(folder / main_file(lowered, mjcf)))
    return MODELS[folder]


def mujoco_poses(
    folder: Path, robot: Robot, q: Mapping[str, float], poses: Mapping[str, Array]
) -> tuple[dict[str, Array], float]:
    """X_RL of every link relative to the root in MuJoCo, and the largest violation of an equality constraint."""
    import mujoco

    lowered, model = compiled(folder, robot)
    data = mujoco.MjData(model)
    closures = {closure.name for closure in robot.closures}
    slides = {f"{one.name}_slide": one.pitch * q[one.name] for one in robot.joints if one.kind is JointKind.SCREW}
    slides |= {one.name: travel(one, poses) for one in lowered.joints if one.name in closures}
    for i in range(model.njnt):
        joint = model.joint(i)
        start = int(joint.qposadr[0])
        if joint.type[0] == mujoco.mjtJoint.mjJNT_BALL:
            turns = [q[f"{joint.name}_{angle}"] for angle in ("roll", "pitch", "yaw")]
            mujoco.mju_mat2Quat(data.qpos[start : start + 4], pose([0, 0, 0], turns)[:3, :3].ravel())
        elif joint.type[0] != mujoco.mjtJoint.mjJNT_FREE:
            data.qpos[start] = {**q, **slides}[joint.name]
    mujoco.mj_forward(model, data)
    X = {}
    for link in robot.links:
        X[link.name] = np.eye(4)
        X[link.name][:3, :3] = data.body(link.name).xmat.reshape(3, 3)
        X[link.name][:3, 3] = data.body(link.name).xpos
    to_root = np.linalg.inv(X[robot.root.name])
    is_equality = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    return {name: to_root @ X_WL for name, X_WL in X.items()}, float(np.abs(data.efc_pos[is_equality]).max(initial=0.0))


def assert_same(page: Page, folder: Path, robot: Robot) -> None:
    """Every link of the page is where MuJoCo puts it at the same joint positions, and all loops are closed."""
    poses = {name: np.eye(4) for name in page.poses()}
    for name, numbers in page.poses().items():
        poses[name][:3] = np.column_stack([np.array(numbers[:9]).reshape(3, 3), numbers[9:]])
    expected, violation = mujoco_poses(folder, robot, page.positions(), poses)
    for name, X in poses.items():
        assert pytest.approx(expected[name], abs=1e-6) == X
    assert violation < 1e-6


def slide_all(page: Page, share: float) -> None:
    """Move all sliders to a share of their ranges, as far as the loops allow."""
    for one in page.run("return stepbot.state.scene.motion.driven"):
        low, high = one["range"]
        page.run("stepbot.state.drive(...arguments)", one["name"], low + share * (high - low))


@pytest.fixture(scope="module")
def scenes() -> dict[str, tuple[Robot, dict[str, Any]]]:
    """Every robot with its scene."""
    robots = {name: build() for name, build in ROBOTS.items()}
    return {name: (robot, scene_document(robot)) for name, robot in robots.items()}


@pytest.mark.parametrize(
    "names",
    [
        pytest.param(EACH_KIND, id="each kind of joint"),
        pytest.param(tuple(ROBOTS.keys() - set(EACH_KIND)), id="other robots", marks=pytest.mark.long),
    ],
)
def test_every_robot_moves_as_in_mujoco(
    names: Sequence[str], page: Page, tmp_path: Path, scenes: Mapping[str, tuple[Robot, dict[str, Any]]]
) -> None:
    """All kinds of joints and loops, drawn and moved: poses within 1e-6 m and 1e-6, loops closed to 1e-6."""
    page.open_file(tmp_path, scenes["pendulum"][1])
    for name in sorted(names):
        robot, scene = scenes[name]
        page.load(scene)
        assert_same(page, tmp_path / name, robot)
        before = page.positions()
        for share in SHARES:
            slide_all(page, share)
            assert_same(page, tmp_path / name, robot)
        assert page.positions() != before or not before


def test_a_drag_of_the_stewart_platform_takes_little_work(
    page: Page, tmp_path: Path, scenes: Mapping[str, tuple[Robot, dict[str, Any]]]
) -> None:
    """A drag of a slider in sixty small steps: each follows the slider, with at most ten evaluations of the loops."""
    robot, scene = scenes["stewart"]
    page.open_file(tmp_path, scene)
    driven = scene["motion"]["driven"][0]
    low, high = driven["range"]
    counts = page.run(
        """const [name, low, high] = arguments; const { loops } = stepbot.state; const counts = [];
        const solve = loops.constraints.bind(loops); let count = 0;
        loops.constraints = (u) => { count++; return solve(u); };
        for (let i = 0; i < 60; i++) {
          count = 0;
          stepbot.state.drive(name, (low + high) / 2 + (high - low) * 0.2 * Math.sin(i / 9));
          counts.push(count);
        } return counts;""",
        driven["name"],
        low,
        high,
    )
    assert page.run("return stepbot.state.note") == ""
    target = (low + high) / 2 + (high - low) * 0.2 * np.sin(59 / 9)
    assert page.positions()[driven["name"]] == pytest.approx(target, abs=1e-12)
    assert_same(page, tmp_path / "stewart", robot)
    assert max(counts) <= 10, counts


def test_sliders_stop_where_loops_do(
    page: Page, tmp_path: Path, scenes: Mapping[str, tuple[Robot, dict[str, Any]]]
) -> None:
    """A joint driven beyond what its loops allow stops before, closed, and the page says why."""
    robot, scene = scenes["delta"]
    page.open_file(tmp_path, scene)
    driven = scene["motion"]["driven"][0]["name"]
    for target in (3.0, -3.0):
        page.run("stepbot.state.reset(); stepbot.state.drive(...arguments)", driven, target)
        assert 0.05 < abs(page.positions()[driven]) < 2.9
        assert page.run("return stepbot.state.note") != ""
        assert_same(page, tmp_path / "delta", robot)


def test_slider_by_keyboard(page: Page, tmp_path: Path, scenes: Mapping[str, tuple[Robot, dict[str, Any]]]) -> None:
    """Arrow keys move a slider, its number follows; a typed number moves the joint; `as drawn` resets."""
    from selenium.webdriver.common.keys import Keys

    _, scene = scenes["two_link_arm"]
    page.open_file(tmp_path, scene)
    name = scene["motion"]["driven"][0]["name"]
    page.element(f"[data-slider='{name}']").send_keys(Keys.END)
    upper = scene["motion"]["driven"][0]["range"][1]
    assert page.positions()[name] == pytest.approx(upper)
    box = page.element(f"[data-value='{name}']")
    box.send_keys(Keys.CONTROL, "a")
    box.send_keys("10", Keys.TAB)
    assert page.positions()[name] == pytest.approx(np.radians(10.0))
    page.element("#reset").click()
    assert page.positions()[name] == 0.0
