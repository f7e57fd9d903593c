"""Descriptions of robots drawn at random: their conversion passes its own proof, and the comparison with its source."""

from pathlib import Path
from random import Random
from xml.etree import ElementTree as ET

import pytest
from hypothesis import HealthCheck, Phase, example, given, settings
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.differences import differing_robots
from stepbot.robot.mesh_files import share_meshes
from stepbot.runtime.output import write_atomically
from tests.mutation.extras import with_extras
from tests.random_robots import drawn_robot, widened

from .rewriting import rewritten

FORMATS = ("urdf", "sdf", "mjcf")
_UNSTABLE = {"SB811", "SB812"}
"""A drawn spring may be too stiff for the time step of a passive simulation, as in the source itself."""


def _as_others_write(text: bytes, random: Random) -> bytes:
    """A description with what exporters leave out or repeat, and stepbot never writes.

    Efforts and velocities are 0 or missing, and shapes of all links have one name, or none in URDF.
    """
    root = ET.fromstring(text)
    if root.find(".//sensor/contact") is None:  # which names collisions
        named = random.choice([True, root.tag == "sdf"])
        for link in root.iter("link"):
            for kind in ("visual", "collision"):
                for number, shape in enumerate(link.findall(kind)):
                    shape.set("name", f"{kind}_{number}" if number else kind)
                    if not named:
                        del shape.attrib["name"]
    for limit in root.iterfind("joint/limit"):
        for which in ("effort", "velocity"):
            stated = random.choice([limit.get(which), "0", None])
            limit.attrib.pop(which, None)
            if stated is not None:
                limit.set(which, stated)
    return ET.tostring(root)


def _errors(seed: int, written_in: str, folder: Path, *, wide: bool = False) -> list[str]:
    """The errors of a conversion of a drawn robot's file; with ``wide``, of one with more of what robots have."""
    random = Random(seed)
    robot = drawn_robot(random)
    robot = widened(Random(f"{seed} wide"), robot) if wide else robot
    files = render(share_meshes(robot), written_in, Diagnostics())
    name = next(iter(files))
    write_atomically({**files, name: _as_others_write(files[name], random)}, folder / "in")
    return _errors_of(folder / "in" / name, folder / "out")


def _errors_of(description: Path, output: Path) -> list[str]:
    conversion = convert(description, Options(output, timeout=100.0))
    return [str(one) for one in conversion.diagnostics if one.severity == "error" and one.code not in _UNSTABLE]


def _rewritten(seed: int, written_in: str, folder: Path) -> None:
    """A rewritten description converts, and differs from the original one in nothing."""
    random = Random(f"{seed} rewritten")
    robot = widened(Random(f"{seed} wide"), drawn_robot(Random(seed)))
    files = render(share_meshes(robot), written_in, Diagnostics())
    name = next(iter(files))
    write_atomically(files, folder / "as_stepbot")
    others = rewritten(written_in, files[name], random)
    write_atomically({**files, **others}, folder / "as_others")
    description, diagnostics = folder / "as_others" / next(iter(others)), Diagnostics()
    assert not _errors_of(description, folder / "out")
    differences = differing_robots(folder / "as_stepbot" / name, description, Options(folder), diagnostics)
    assert differences is not None, list(diagnostics)
    assert {one.name for one in differences.rows} <= {"frame 'a' is new", "frame 'b' is new"}


@pytest.mark.slow
@given(seed=st.integers(0, 2**32), written_in=st.sampled_from(FORMATS))
@example(seed=1006, written_in="urdf")  # half a gram on two slides, to which MJCF added two stand-ins of 1e-12 kg
@settings(
    max_examples=1,
    deadline=None,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_conversion_of_a_valid_description_passes_its_proof(seed: int, written_in: str, tmp_path: Path) -> None:
    """Whatever the robot and the format: every engine reads in each written file the robot of the source."""
    assert not _errors(seed, written_in, tmp_path / f"{seed}_{written_in}")


@pytest.mark.parametrize(("seed", "written_in"), [(3, "urdf"), (1, "sdf"), (2, "mjcf")])
def test_conversion_of_a_wide_robot_passes_its_proof(seed: int, written_in: str, tmp_path: Path) -> None:
    """Initial poses, followers with limits, a tool without mass, single contact properties, names of all languages."""
    assert not _errors(seed, written_in, tmp_path, wide=True)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(0, 60, 6))
def test_many_conversions_pass_their_proof(seed: int, tmp_path: Path) -> None:
    """The same, of six robots in every format."""
    for one in range(seed, seed + 6):
        for written_in in FORMATS:
            for wide in (False, True):
                folder = tmp_path / f"{one}_{written_in}_{wide}"
                assert not _errors(one, written_in, folder, wide=wide), (one, written_in, wide)


def _errors_of_field(seed: int, written_in: str, folder: Path) -> list[str]:
    """The errors of a conversion of a file with what stepbot never writes, but those about what it does not convert."""
    robot = widened(Random(f"{seed} wide"), drawn_robot(Random(seed)))
    files = render(share_meshes(robot), written_in, Diagnostics())
    name = next(iter(files))
    write_atomically({**files, name: with_extras(written_in, files[name], Random(seed))}, folder / "in")
    return [one for one in _errors_of(folder / "in" / name, folder / "out") if "[SB861]" not in one]


@pytest.mark.slow
def test_conversion_of_a_description_of_the_field_passes_its_proof(tmp_path: Path) -> None:
    """Contacts for Gazebo and for PyBullet, solvers, plugins, lights and further drives: known ones are converted."""
    assert not _errors_of_field(1, "urdf", tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(200, 220))
@pytest.mark.parametrize("written_in", FORMATS)
def test_many_descriptions_of_the_field(seed: int, written_in: str, tmp_path: Path) -> None:
    """The same, of more robots."""
    assert not _errors_of_field(seed, written_in, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "written_in"), [(7, "urdf"), (8, "sdf"), (9, "mjcf")])
def test_other_units_conventions_and_structure(seed: int, written_in: str, tmp_path: Path) -> None:
    """Euler angles, degrees, frames, packages, included files and another order are the same robot."""
    _rewritten(seed, written_in, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(100, 120))
@pytest.mark.parametrize("written_in", FORMATS)
def test_many_rewritten_descriptions(seed: int, written_in: str, tmp_path: Path) -> None:
    """The same, of more robots."""
    _rewritten(seed, written_in, tmp_path)
