"""Mass properties computed from geometry, where a description has none that are possible, if the user asks for it."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh

from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Conversion, Options

_DENSITY = 2000.0
_BODY = '<link name="{0}">{1}<collision><geometry>{2}</geometry></collision></link>'
_JOINT = """<joint name="to_{1}" type="{2}"><parent link="{0}"/><child link="{1}"/>
  <origin xyz="0.6 0 0"/><axis xyz="0 0 1"/></joint>"""
_IMPOSSIBLE = """<inertial><mass value="3"/><origin xyz="0.01 0 0"/>
  <inertia ixx="1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>"""
_SMALL = '<inertial><mass value="0.001"/></inertial>'
"""Drake takes an inertia of 0; ROS, MuJoCo and PyBullet reject the file."""
SOURCE = "".join(
    (
        '<robot name="robot">',
        _BODY.format("base", "", '<box size="0.2 0.2 0.1"/>'),
        _BODY.format("roll", "", '<cylinder radius="0.05" length="0.3"/>'),
        _BODY.format("ball", "", '<sphere radius="0.1"/>'),
        _BODY.format("block", _IMPOSSIBLE, '<mesh filename="block.stl" scale="0.001 0.001 0.001"/>'),
        _BODY.format("open", "", '<mesh filename="open.stl"/>'),
        f'<link name="mark">{_SMALL}</link><link name="tip"/><link name="frame"/>',
        *(
            _JOINT.format(*one)
            for one in (
                ("base", "roll", "continuous"),
                ("roll", "ball", "continuous"),
                ("ball", "block", "continuous"),
                ("block", "open", "continuous"),
                ("block", "mark", "fixed"),
                ("open", "tip", "continuous"),
                ("block", "frame", "fixed"),
            )
        ),
        "</robot>",
    )
)


def converted(folder: Path, density: float) -> Conversion:
    """The robot, whose block is a box in millimetres, and whose open box lacks two triangles."""
    trimesh.creation.box((100.0, 200.0, 300.0)).export(folder / "block.stl")
    box = trimesh.creation.box((0.1, 0.1, 0.1))
    trimesh.Trimesh(box.vertices, box.faces[2:]).export(folder / "open.stl")
    path = folder / "robot.urdf"
    path.write_text(SOURCE, encoding="utf-8")
    return convert(path, Options(folder / "out", formats=("mjcf",), base="fixed", assume_inertia=density))


def test_without_the_option_nothing_is_assumed(tmp_path: Path) -> None:
    """Each fault is an error that names the option."""
    conversion = converted(tmp_path, 0.0)
    wrong = [one for one in conversion.diagnostics if one.severity == "error"]
    assert {one.code for one in wrong} == {"SB508", "SB509", "SB861"}
    assert all("--assume-inertia" in one.message or "--assume-inertia" in " ".join(one.help) for one in wrong)


@pytest.mark.slow
def test_mass_properties_are_those_of_solids(tmp_path: Path) -> None:
    """MuJoCo reads those of closed forms; a stated mass is kept, an open mesh is a hull, and each link is reported."""
    conversion = converted(tmp_path, _DENSITY)
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    told = [one.message for one in conversion.diagnostics if one.code == "SB874:mass"]
    assert [one.split("'")[1] for one in told] == ["base", "roll", "ball", "block", "open", "mark", "tip"]
    assert "inertia assumed to be that of its geometry at 2000 kg/m^3; mass and com are those of the file" in told[3]
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))

    def box(mass: float, x: float, y: float, z: float) -> list[float]:
        return [mass / 12.0 * (y * y + z * z), mass / 12.0 * (x * x + z * z), mass / 12.0 * (x * x + y * y)]

    roll = _DENSITY * np.pi * 0.05**2 * 0.3
    ball = _DENSITY * 4.0 / 3.0 * np.pi * 0.1**3
    across = roll / 12.0 * (3.0 * 0.05**2 + 0.3**2)
    expected = {
        "base": (8.0, box(8.0, 0.2, 0.2, 0.1), 1e-9),
        "roll": (roll, [across, across, 0.5 * roll * 0.05**2], 1e-3),
        "ball": (ball, [0.4 * ball * 0.1**2] * 3, 2e-3),
        "block": (3.0, box(3.0, 0.1, 0.2, 0.3), 1e-9),
        "open": (2.0, box(2.0, 0.1, 0.1, 0.1), 1e-6),
        "mark": (0.001, [0.4 * 0.001 * (3e-3 / (4.0 * np.pi * _DENSITY)) ** (2.0 / 3.0)] * 3, 1e-9),
        "tip": (1e-6 * _DENSITY, [0.4 * 1e-6 * _DENSITY * (3e-6 / (4.0 * np.pi)) ** (2.0 / 3.0)] * 3, 1e-9),
    }
    for name, (mass, moments, error) in expected.items():
        body = model.body(name)
        assert body.mass[0] == pytest.approx(mass, rel=error), name
        assert sorted(body.inertia) == pytest.approx(sorted(moments), rel=error), name
    assert model.body("block").ipos == pytest.approx([0.01, 0.0, 0.0])
    assert model.body("frame").mass[0] == 0.0


def test_a_mesh_too_large_for_moments_is_reported(tmp_path: Path) -> None:
    """Its fifth powers are no numbers."""
    trimesh.creation.box((1.0, 1.0, 1.0)).export(tmp_path / "block.stl")
    shape = '<mesh filename="block.stl" scale="1e120 1e120 1e120"/>'
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="large">{_BODY.format("base", "", shape)}</robot>', encoding="utf-8")
    conversion = convert(path, Options(tmp_path / "out", formats=("mjcf",), base="fixed", assume_inertia=1000.0))
    assert {one.code for one in conversion.diagnostics if one.severity == "error"} == {"SB414"}
