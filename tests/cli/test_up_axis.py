"""A robot drawn with another axis up equals the one drawn upright, in all formats."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from robot_library.moments import Array, pose, turn
from tests import parts

from .conftest import Stepbot

SIDECAR = """\
version: 1
robot: turntable
step: turntable.step
base: fixed
root: {root}
links:
  base: {{parts: [foot]}}
  arm: {{parts: [arm]}}
joints:
  tilt:
    type: revolute
    parent: base
    child: arm
    origin: {{component: arm, offset: {{xyz: [0, 5 mm, 50 mm], rpy: [0.1, 0.2, 0.3]}}}}
    axis: [0.6, 0, 0.8]
    limits: {{lower: -90 deg, upper: 90 deg, effort: 5 N*m, velocity: 1 rad/s}}
"""
TURNED = {
    "{up: y}": turn("x", -pi / 2),
    "{up: -y, forward: -z}": turn("x", pi / 2) @ turn("z", -pi / 2),
    "{up: x}": turn("z", pi / 2) @ turn("x", pi / 2),
}
"""Rotations (3, 3) from the upright drawing to one with these directions; checked by the test."""


def numbers_of(folder: Path) -> dict[str, Array]:
    """What MuJoCo reports of a robot in a bent pose."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(folder / "turntable.xml"))
    data = mujoco.MjData(model)
    data.qpos[:] = 0.7
    mujoco.mj_forward(model, data)
    return {
        "mass": model.body_mass.copy(),
        "com": data.subtree_com.copy(),
        "inertia": np.sort(model.body_inertia, axis=1),
        "axis": data.xaxis.copy(),
        "gravity": data.qfrc_bias.copy(),
        "low": data.geom_xpos.min(axis=0) if model.ngeom else np.zeros(3),
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    "root", [pytest.param(root, marks=() if "forward" in root else pytest.mark.long) for root in TURNED]
)
def test_against_the_upright_drawing(
    root: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot
) -> None:
    """All files are verified; masses, centre, inertia, joint axis and gravity torque equal the upright robot's."""
    for name, directions, R in (("upright", "{up: z}", np.eye(3)), ("turned", root, TURNED[root])):
        folder = tmp_path / name
        folder.mkdir()
        parts.write_turntable(folder / "turntable.step", pose((0, 0, 0), R))
        (folder / "turntable.robot.yaml").write_text(SIDECAR.format(root=directions), encoding="utf-8")
        monkeypatch.chdir(folder)
        run = stepbot("convert", "turntable.robot.yaml", "-o", "out")
        assert run.code == 0, run.out + run.err
        assert "SB421" not in run.err
        assert {"turntable.urdf", "turntable.sdf", "turntable.xml"} <= {path.name for path in Path("out").iterdir()}
    upright, turned = (numbers_of(tmp_path / name / "out") for name in ("upright", "turned"))
    for quantity, values in upright.items():
        np.testing.assert_allclose(turned[quantity], values, rtol=1e-6, atol=1e-7, err_msg=quantity)


@pytest.mark.slow
def test_the_warning_and_its_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot) -> None:
    """`check --step` suggests the axis; with the suggested line there are no findings."""
    monkeypatch.chdir(tmp_path)
    parts.write_turntable(tmp_path / "turntable.step", pose((0, 0, 0), turn("x", -pi / 2)))
    sidecar = tmp_path / "turntable.robot.yaml"
    text = SIDECAR.replace("origin: {{component: arm, offset: {{xyz: [0, 5 mm, 50 mm], rpy: [0.1, 0.2, 0.3]}}}}", "")
    text = text.replace("axis: [0.6, 0, 0.8]", "axis: z")
    sidecar.write_text(text.format(root="{link: base}"), encoding="utf-8")
    run = stepbot("check", "--step", sidecar.name)
    assert run.code == 0
    assert "warning[SB421]" in run.out + run.err
    assert "root: {up: y}" in run.out + run.err
    sidecar.write_text(text.format(root="{up: y}"), encoding="utf-8")
    run = stepbot("check", "--step", sidecar.name)
    assert "SB421" not in run.out + run.err
