"""A composed robot is the sum of its modules: mass matrix, files and names, against each module converted alone."""

from collections.abc import Callable, Mapping
from pathlib import Path
from textwrap import dedent

import mujoco
import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.pipeline.stages import produce
from stepbot.robot.model import Robot
from stepbot.runtime.cache import Cache

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


def mass_matrix(model: mujoco.MjModel, qpos: np.ndarray) -> tuple[np.ndarray, mujoco.MjData]:
    """The full mass matrix (nv, nv) at a configuration."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full, data


def test_mass_matrix_is_the_sum_of_the_modules(converted: Callable[..., Conversion], tmp_path: Path) -> None:
    """M = M_arm + T' M_hand T, with M_arm, the floating hand's M_hand and the port's motion T from MuJoCo alone."""
    whole = converted(
        f"""
        version: 1
        robot: both
        modules:
          arm: {{file: LIBRARY/{ARM}, prefix: ""}}
          hand: {{file: LIBRARY/{HAND}, at: arm/tool0, offset: {{xyz: [0, 0, 10 mm], rpy: [0, 0, 30 deg]}}}}
        """,
        "both",
    ).robot
    converted(ARM, "arm2")
    converted(HAND, "2f85")
    assert whole is not None
    both, arm = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("both/both.xml", "arm2/arm2.xml"))
    spec = mujoco.MjSpec.from_file(str(tmp_path / "2f85" / "2f85.xml"))
    palm = spec.worldbody.first_body()
    palm.add_freejoint()
    hand = spec.compile()
    random = np.random.default_rng(7)
    port = whole.modules[1]
    for _ in range(8):
        q = random.uniform(-0.5, 0.5, both.nq)
        M, data = mass_matrix(both, q)
        of_arm, _ = mass_matrix(arm, q[: arm.nq])
        body = both.body(port.links[0]).id
        floating = np.zeros(hand.nq)
        floating[:3], floating[3:7], floating[7:] = data.xpos[body], data.xquat[body], q[arm.nq :]
        of_hand, _ = mass_matrix(hand, floating)
        linear, angular = np.zeros((3, both.nv)), np.zeros((3, both.nv))
        mujoco.mj_jacBody(both, data, linear, angular, body)
        T = np.zeros((hand.nv, both.nv))
        T[:3], T[3:6] = (
            linear,
            data.xmat[body].reshape(3, 3).T @ angular,
        )  # a free joint's rates are in the body's frame
        T[6:, arm.nv :] = np.eye(hand.nv - 6)
        sum_of_modules = T.T @ of_hand @ T
        sum_of_modules[: arm.nv, : arm.nv] += of_arm
        assert np.allclose(M, sum_of_modules, rtol=0.0, atol=1e-12 * np.abs(M).max())


@pytest.mark.parametrize("robot", ["stepbot_arm2", "robotiq_2f85"])
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


def test_modules_of_modules_are_flat(converted: Callable[..., Conversion]) -> None:
    """(arm + hand) as a module gives what arm and hand give, with the same prefixes."""
    flat = converted(
        f"""
        version: 1
        robot: flat
        modules:
          arm: {{file: LIBRARY/{ARM}, prefix: a_}}
          hand: {{file: LIBRARY/{HAND}, at: arm/tool0, prefix: a_h_, home: {{finger_joint: 0.3}}}}
        frames:
          tcp:
            link: hand/robotiq_arg2f_base_link
            origin: {{xyz: [0, 0, 1 mm], relative_to: hand/robotiq_arg2f_base_link}}
        """,
        "flat",
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
        """
        version: 1
        robot: flat
        modules:
          robot: {file: inner.robot.yaml, prefix: a_}
        frames:
          tcp:
            link: robot/hand/robotiq_arg2f_base_link
            origin: {xyz: [0, 0, 1 mm], relative_to: robot/hand/robotiq_arg2f_base_link}
        """,
        "flat",
    )
    same = {path for path in flat.files if path != "report.json" and "mount" not in path}
    assert same == {path for path in nested.files if path != "report.json"}
    for path in same:
        assert flat.files[path].replace(b"hand_mount", b"a_hand_mount") == nested.files[path], path
    assert nested.robot is not None
    assert [module.name for module in nested.robot.modules] == ["robot", "robot/arm", "robot/hand"]
