"""Robots drawn at random: what stepbot writes is read by every engine as the robot that it was written from."""

from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, example, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engines_for
from stepbot.engines.observation import EngineCannotRead, Quantity, Request
from stepbot.geometry.inertia import MassProperties
from stepbot.robot.model import Base, Joint, JointDynamics, JointKind, Limit, Link, Mimic, Robot
from stepbot.robot.validity import check_robot
from stepbot.verification.compare import compare
from tests.random_robots import drawn_robot
from tests.simulators.conftest import failures, look, write
from tests.workshop import at

FORMATS = ("urdf", "sdf", "mjcf")
_ROUND = ((0.04, 0.0, 0.0), (0.0, 0.03, 0.0), (0.0, 0.0, 0.02))
"""In MuJoCo's order: the inertial frame may count as that of the body."""
_LIMIT = Limit(-3.0, 3.0, 1.0, 2.0)


def _misread(robot: Robot, folder: Path, formats: Sequence[str] = FORMATS) -> dict[str, list[str]]:
    """By format and engine, what an engine reports differently; passive simulation aside, which may be unstable."""
    diagnostics = Diagnostics()
    check_robot(robot, diagnostics)
    assert not diagnostics.has_errors, list(diagnostics)
    written = write(robot, folder)
    wrong = {}
    for written_in in formats:
        request = written.request(written_in)
        request = replace(request, simulate=0.0, configurations=request.configurations[:3], rates=request.rates[:3])
        expected = written.expected(written_in, request)
        for engine in (one for one in engines_for(written_in) if one.available() is None):
            try:
                with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                    seen = engine.observer.observe(request)
            except EngineCannotRead:
                continue
            failed = [one for one in compare(expected, seen) if not one.not_run]
            lines = [f"{one.quantity}: {line}" for one in failed for line in one.deviations.failures]
            if lines:
                wrong[f"{written_in} in {engine.name}"] = lines
    return wrong


def _prove(seed: int, folder: Path) -> None:
    assert not _misread(drawn_robot(Random(seed)), folder)


@pytest.mark.slow
@given(seed=st.integers(0, 2**32))
@example(seed=70)  # an inertia of 100 kg m^2, which PyBullet's inverse dynamics rejects unless it is scaled
@example(seed=89)  # a sensor at 1e-9 m, which yourdfpy's scene leaves out
@example(seed=292)  # a joint about the vertical, but for 6e-6 rad
@example(seed=397)  # a turned axis, which PyBullet warns about
@settings(
    max_examples=3,
    deadline=None,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_a_valid_robot_passes_its_own_proof(seed: int, tmp_path: Path) -> None:
    """Whatever the robot: no engine reports a difference from it, warns, or refuses its file."""
    _prove(seed, tmp_path / str(seed))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(0, 240, 30))
def test_many_valid_robots_pass_their_own_proof(seed: int, tmp_path: Path) -> None:
    """The same, thirty robots at a time."""
    for one in range(seed, seed + 30):
        _prove(one, tmp_path / str(one))


def _wheel(com: tuple[float, float, float], base: Base = Base.FIXED, joints: int = 1) -> Robot:
    """A wheel on one joint, or a disc on two slides and a hinge, with its centre of mass near its frame."""
    body = MassProperties(1.0, com, _ROUND)
    plate = Link("plate", MassProperties(2.0, (0.0, 0.0, 0.01), _ROUND))
    if joints == 1:
        axle = Joint("axle", JointKind.CONTINUOUS, "plate", "wheel", at(z=0.1), (0.0, 1.0, 0.0))
        return Robot("wheel", (plate, Link("wheel", body)), (axle,), base=base, source="wheel.step")
    flat = Joint("flat", JointKind.PLANAR, "plate", "wheel", at(z=0.1))
    return Robot("disc", (plate, Link("wheel", body)), (flat,), base=base, source="disc.step")


@pytest.mark.parametrize("distance", [1e-9, 5e-7, 9.9e-7, 2e-6])
@pytest.mark.parametrize("joints", [1, 3])
def test_a_centre_of_mass_near_the_frame_is_where_the_file_has_it(distance: float, joints: int, tmp_path: Path) -> None:
    """MuJoCo's compiler moves a centre of mass by up to 1e-6 m onto the frame of its body; the proof does not."""
    assert not _misread(_wheel((distance, 0.0, 0.0), joints=joints), tmp_path, ["mjcf"])


@pytest.mark.slow
@pytest.mark.parametrize("kind", [JointKind.REVOLUTE, JointKind.PRISMATIC])
@pytest.mark.parametrize("base", list(Base))
def test_an_axis_near_a_coordinate_axis_is_where_the_file_has_it(kind: JointKind, base: Base, tmp_path: Path) -> None:
    """Drake turns about a coordinate axis 2e-8 rad away; the proof does not, also beside springs and mimics."""
    body, dynamics = MassProperties(1.0, (0.1, 0.2, 0.3), _ROUND), JointDynamics(0.2, stiffness=3.0)
    links = [Link(name, body) for name in "abcd"]
    follows = (None, None, Mimic("j0", 0.5))
    joints = [
        Joint(
            f"j{i}", kind, "abc"[i], "bcd"[i], at(z=0.1), (tilt, 1.0, 0.0), limit=_LIMIT, dynamics=dynamics, mimic=mimic
        )
        for i, (tilt, mimic) in enumerate(zip((1e-9, -1.4e-8, 3e-8), follows, strict=True))
    ]
    assert not _misread(Robot("tilted", tuple(links), tuple(joints), base=base, source="tilted.step"), tmp_path)


def test_the_rounding_is_noted_and_hides_no_difference(tmp_path: Path) -> None:
    """A note names the link; a file with another centre of mass, as near, is not this robot."""
    written = write(_wheel((5e-7, 0.0, 0.0)), tmp_path)
    request = written.request("mjcf")
    seen = look("mujoco", request)
    assert [note for note in seen.notes if "wheel" in note and "1e-6" in note]
    path = written.written["mjcf"].path
    path.write_text(path.read_text().replace("5e-07", "4e-07"))
    assert failures(written.expected("mjcf"), look("mujoco", request)) >= {Quantity.COM}


_TABLE = """<mujoco><worldbody><body name="base"><body name="table">
  <inertial pos="0 0 0" mass="2" diaginertia="0.03 0.02 0.01"/>
  <joint name="x" type="slide" axis="1 0 0" armature="0.5"/><joint name="y" type="slide" axis="0 1 0" armature="0.25"/>
</body></body></worldbody></mujoco>"""


def test_armature_of_slides_in_one_body_is_no_mass(tmp_path: Path) -> None:
    """MuJoCo computes the mass matrix of slides in one body in advance, with their armature."""
    file = tmp_path / "table.xml"
    file.write_text(_TABLE)
    seen = look("mujoco", Request(str(file), "mjcf", configurations=({},), simulate=0.0))
    assert seen.dynamics[0].mass_matrix == pytest.approx(np.diag([2.0, 2.0]), rel=1e-12)
    assert [step.dynamics.armature for joint in seen.joints for step in joint.steps or (joint,) if step.dynamics] == [
        0.5,
        0.25,
    ]
