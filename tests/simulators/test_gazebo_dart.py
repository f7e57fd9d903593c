"""Gazebo's physics on DART, as Debian 12 has it: worlds that stepbot writes, moved as MuJoCo moves the MJCF.

It needs ``apt-get install libignition-physics-dev libsdformat-dev g++ pkg-config``.
"""

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from msgspec import Struct

from stepbot_cli import main
from tests.library.conftest import sidecar_of

pytestmark = [pytest.mark.long, pytest.mark.mujoco]

SOURCE = Path(__file__).with_name("gazebo_dart.cc")
PACKAGES = ("ignition-physics5", "ignition-physics5-sdf", "ignition-plugin1-loader", "sdformat12")
PLUGIN = "ign-physics-5/engine-plugins/libignition-physics-dartsim-plugin.so"
STEPS, STEP = 30, 0.001
"""So few that no joint reaches its velocity limit, which DART enforces and MuJoCo does not; DART's default step [s]."""
EXACT, SOFT = 1e-12, 1e-5
"""Deviation [m] and [rad] of both engines, which integrate by Euler's method; and of joints that friction holds, which
MuJoCo's, a soft constraint, does not quite do."""


class Moved(Struct, frozen=True):
    """What DART printed."""

    places: dict[str, list[float]]
    """Of the links, at the start [m]."""
    start: dict[str, float]
    end: dict[str, float]
    """Positions of the joints [rad] or [m]."""
    messages: str


Step = Callable[[Path], Moved]


def _configured(*arguments: str) -> str:
    run = subprocess.run(["pkg-config", *arguments], capture_output=True, text=True, check=False)
    return run.stdout.strip() if run.returncode == 0 else ""


@pytest.fixture(scope="module")
def step(tmp_path_factory: pytest.TempPathFactory) -> Step:
    """A function that steps a world."""
    if not all(map(shutil.which, ("g++", "pkg-config"))) or not _configured("--libs", *PACKAGES):
        pytest.skip("Gazebo's physics is not installed: apt-get install libignition-physics-dev libsdformat-dev")
    program = tmp_path_factory.mktemp("dart") / "gazebo_dart"
    options = [*_configured("--cflags", *PACKAGES).split(), *_configured("--libs", *PACKAGES).split()]
    subprocess.run(["g++", "-std=c++17", "-O1", str(SOURCE), "-o", str(program), *options], check=True, timeout=600)
    plugin = Path(_configured("--variable=libdir", PACKAGES[0])) / PLUGIN

    def stepped(world: Path) -> Moved:
        command = [str(program), str(plugin), str(world), str(STEPS)]
        run = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
        rows = [json.loads(line) for line in run.stdout.splitlines() if line.startswith("[")]
        at = {(number, kind): {name: value for n, k, name, value in rows if (n, k) == (number, kind)}
              for number in (0, STEPS) for kind in ("link", "joint")}  # fmt: skip
        return Moved(at[0, "link"], at[0, "joint"], at[STEPS, "joint"], run.stderr)

    return stepped


def converted(robot: str, folder: Path) -> tuple[Path, Path]:
    """The world and the MJCF of a robot of the library."""
    command = ["convert", str(sidecar_of(robot)), "-o", str(folder), "-f", "sdf,mjcf", "--no-verify", "-q"]
    assert main(command) == 0
    (world,) = folder.glob("*.world.sdf")
    return world, folder / f"{world.name.removesuffix('.world.sdf')}.xml"


@pytest.mark.parametrize(
    ("robot", "tolerance"),
    [
        ("universal_robots_ur5e", EXACT),
        ("kinova_gen3", EXACT),
        ("rethink_sawyer", EXACT),
        ("kuka_youbot", SOFT),
        ("stepbot_hexapod", SOFT),
    ],
)
def test_trees_fall_as_in_mujoco(robot: str, tolerance: float, step: Step, tmp_path: Path) -> None:
    """Links start in the same places; joints without motors move alike for 30 ms: masses and inertias are the same."""
    world, mjcf = converted(robot, tmp_path / "out")
    moved = step(world)
    model = mujoco.MjModel.from_xml_path(str(mjcf))
    off = mujoco.mjtDisableBit
    model.opt.disableflags |= off.mjDSBL_ACTUATION | off.mjDSBL_CONTACT | off.mjDSBL_LIMIT
    model.opt.timestep = STEP
    model.dof_armature[:] = 0.0  # lost in SDFormat, which is declared
    model.actuator_damping[:] = 0.0  # the torque-speed line of motors, which stays without actuation
    data = mujoco.MjData(model)
    joints = [name for name in moved.start if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) >= 0]
    assert len(joints) >= 6
    for name in joints:
        data.joint(name).qpos[0] = moved.start[name]
    mujoco.mj_forward(model, data)
    root = model.body(1).name
    shift = np.array(moved.places[root]) - data.body(root).xpos
    for body in range(1, model.nbody):
        link = model.body(body).name
        assert moved.places[link] == pytest.approx(data.body(link).xpos + shift, abs=EXACT), link
    for _ in range(STEPS):
        mujoco.mj_step(model, data)
    for name in joints:
        assert moved.end[name] == pytest.approx(data.joint(name).qpos[0], abs=tolerance), name


def test_loops_stay_open(step: Step, tmp_path: Path) -> None:
    """DART drops the joint that closes a loop, with a message: what the documentation states."""
    world, _ = converted("stepbot_four_bar", tmp_path / "out")
    moved = step(world)
    assert "but the child link already" in moved.messages
    assert set(moved.start) == {"crank_turn", "coupler_turn", "rocker_swing"}
