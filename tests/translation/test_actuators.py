"""Actuators of an MJCF whose ranges are wider than what their joints allow, or missing."""

from pathlib import Path

import mujoco
import pytest

from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Conversion, Options

pytestmark = pytest.mark.slow

_BODY = """<body name="{0}" pos="0 0 0.2"><joint name="{0}" axis="0 1 0" range="-1 2" {1}/>
  <inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/></body>"""
ACTUATORS = {
    "geared": '<position gear="50" kp="2" kv="0.1"/>',
    "reversed": '<position gear="-2" kp="2" ctrlrange="-1 1" forcerange="-30 30"/>',
    "wide": '<position kp="2" ctrlrange="-3 3"/>',
    "wheel": '<velocity gear="0.5" kv="0.1" ctrlrange="-3 3"/>',
    "motor": '<motor gear="50" ctrlrange="-3 3"/>',
    "weak": '<motor ctrlrange="-0.5 0.5" forcerange="-30 30"/>',
}
"""By joint."""
_UNLIMITED = ("geared", "reversed")
"""Joints without an effort limit."""


@pytest.fixture(scope="module")
def converted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Conversion]:
    """A robot with all of them, converted and proven."""
    folder = tmp_path_factory.mktemp("actuators")
    bodies = [_BODY.format(name, "" if name in _UNLIMITED else 'actuatorfrcrange="-20 20"') for name in ACTUATORS]
    drives = [text.replace("/>", f' name="{name}" joint="{name}"/>') for name, text in ACTUATORS.items()]
    path = folder / "robot.xml"
    path.write_text(
        f"""<mujoco model="robot"><compiler angle="radian"/><worldbody><body name="base">
        <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>{"".join(bodies)}</body></worldbody>
        <actuator>{"".join(drives)}</actuator></mujoco>""",
        encoding="utf-8",
    )
    return folder, convert(path, Options(folder / "out", formats=("urdf", "sdf", "mjcf")))


def test_ranges_beyond_the_joints_convert_with_proof(converted: tuple[Path, Conversion]) -> None:
    """Gears, missing ranges, and ranges that the effort limit cuts are no difference from the source."""
    _, conversion = converted
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    assert not conversion.report.failed


def test_inputs_beyond_the_stops_are_declared(converted: tuple[Path, Conversion]) -> None:
    """A position actuator with a range beyond the limits of its joint is reported; one without a range is not."""
    _, conversion = converted
    lost = [one.message for one in conversion.diagnostics if one.code == "SB863"]
    assert lost == ["actuator 'wide': inputs beyond the limits of joint 'wide' are not converted: -1 to 2 taken"]


def test_effective_forces_are_those_of_the_source(converted: tuple[Path, Conversion]) -> None:
    """MuJoCo applies the same force at full input with the written MJCF as with the source."""
    folder, _ = converted
    forces = []
    for file in (folder / "robot.xml", folder / "out" / "robot.xml"):
        model = mujoco.MjModel.from_xml_path(str(file))
        data = mujoco.MjData(model)
        for name in ("motor", "weak", "wheel"):
            data.actuator(name).ctrl = 3.0
        mujoco.mj_forward(model, data)
        forces.append([float(data.joint(name).qfrc_actuator[0]) for name in ("motor", "weak", "wheel")])
    assert forces[0] == pytest.approx([20.0, 0.5, 0.15])  # of the wheel: gear * kv * input
    assert forces[1] == pytest.approx(forces[0])
