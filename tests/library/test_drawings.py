"""Drawn STEP files against closed forms, by the kernel's integrals."""

import importlib
import json
import re
import subprocess
import sys
from collections.abc import Callable
from math import cos, hypot, pi, sin
from pathlib import Path

import numpy as np
import pytest

from robot_library.expected import write_expected
from robot_library.moments import NOTHING, Moments
from robot_library.step_file import UNITS, LengthUnit
from robot_library.stepbot_arm2 import closed_form as arm2
from robot_library.stepbot_arm2.dimensions import ELBOW_DRAWN, FINGER_DRAWN
from robot_library.stepbot_four_bar import closed_form as four_bar
from robot_library.stepbot_four_bar import dimensions
from tests import parts
from tests.corpus.measure_follower import occurrences, solid_moments

LIBRARY = Path(__file__).parents[2] / "robot_library"
ROBOTS = ("four_bar", "arm2")

DRAWINGS: tuple[Callable[[Path], parts.Drawing], ...] = (
    parts.write_box,
    parts.write_cylinder,
    parts.write_cone,
    parts.write_sphere,
    parts.write_bored_plate,
    parts.write_colored_faces,
    parts.write_nested,
    parts.write_many,
    parts.write_same_names,
    parts.write_hinge,
    parts.write_slider,
)


def assert_same_body(found: Moments, expected: Moments) -> None:
    """Assert that volume or mass, com and inertia agree to the digits of a STEP file."""
    size = float(np.max(np.abs(expected.inertia)))
    assert found.mass == pytest.approx(expected.mass, rel=1e-9)
    np.testing.assert_allclose(found.com, expected.com, atol=1e-9)
    np.testing.assert_allclose(found.inertia, expected.inertia, atol=1e-9 * size)


@pytest.mark.parametrize("robot", ROBOTS)
def test_expected_json_is_what_the_closed_forms_say(robot: str, tmp_path: Path) -> None:
    """expected.json in the repository is that of the current closed forms."""
    closed_form = importlib.import_module(f"robot_library.stepbot_{robot}.closed_form")
    write_expected(tmp_path / "expected.json", closed_form.expected())
    fresh = json.loads((tmp_path / "expected.json").read_text(encoding="utf-8"))
    kept = json.loads((LIBRARY / f"stepbot_{robot}" / "expected.json").read_text(encoding="utf-8"))
    assert fresh == kept


def test_four_bar_step_has_the_mass_of_its_closed_form() -> None:
    """Each link of the drawn four-bar has mass, com and inertia of the closed forms."""
    found = dict.fromkeys(four_bar.links(), NOTHING)
    for part in occurrences(LIBRARY / "stepbot_four_bar" / "four_bar.step"):
        link = "ground" if part.path.startswith("frame:1/") else part.path.removesuffix(":1")
        density = four_bar.STEEL if link == "ground" else four_bar.ALUMINIUM
        found[link] += solid_moments(part.shape).moved(part.X_WC).in_metres().weighing(density)
    for name, expected in four_bar.links().items():
        assert_same_body(found[name], expected)


def test_arm2_step_has_the_mass_of_its_closed_form() -> None:
    """Each link of the drawn arm has mass, com and inertia of the closed forms, in the drawn pose."""
    claims = (
        (r"base:1", "base"),
        (r"shoulder:1", "upper_arm"),
        (r"forearm:1/gripper:1/finger:1", "left_finger"),
        (r"forearm:1/gripper:1/finger:2", "right_finger"),
        (r"forearm:1", "forearm"),
    )
    densities = (
        (r"screw|rod", arm2.STEEL),
        (r"palm", arm2.NYLON),
        (r"finger", arm2.ABS),
        (r"elbow motor", arm2.MOTOR_MASS / arm2.motor().in_metres().mass),
        (r"", arm2.ALUMINIUM),
    )
    expected = arm2.links(ELBOW_DRAWN, FINGER_DRAWN)
    found = dict.fromkeys(expected, NOTHING)
    for part in occurrences(LIBRARY / "stepbot_arm2" / "arm2.step"):
        link = next(link for pattern, link in claims if re.match(pattern, part.path))
        density = next(density for pattern, density in densities if re.search(pattern, part.path))
        found[link] += solid_moments(part.shape).moved(part.X_WC).in_metres().weighing(density)
    for name, body in expected.items():
        assert_same_body(found[name], body)


def test_four_bar_closes_over_a_full_turn() -> None:
    """The pins of crank and rocker stay one coupler length apart, and a full turn ends at its start."""
    d = dimensions
    for i in range(360):
        q = d.closed(2 * pi * i / 360)
        x = d.GROUND + d.ROCKER * cos(q.rocker) - d.CRANK * cos(q.crank)
        z = d.ROCKER * sin(q.rocker) - d.CRANK * sin(q.crank)
        assert hypot(x, z) == pytest.approx(d.COUPLER, rel=1e-12)
        assert (x, z) == pytest.approx((d.COUPLER * cos(q.coupler), d.COUPLER * sin(q.coupler)), abs=1e-9)
    assert four_bar.motion(2 * pi)["rocker_swing"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("write", DRAWINGS, ids=lambda write: write.__name__)
def test_drawn_parts_have_the_volume_of_their_closed_form(
    write: Callable[[Path], parts.Drawing], tmp_path: Path
) -> None:
    """The kernel's values of a drawn file equal the closed forms, for each piece."""
    drawing = write(tmp_path / "part.step")
    found = occurrences(drawing.path)
    assert len(found) == len(drawing.pieces)
    for part, piece in zip(found, drawing.pieces, strict=True):
        assert_same_body(solid_moments(part.shape).moved(part.X_WC).in_metres(), piece.body)


@pytest.mark.parametrize("unit", UNITS)
def test_every_unit_holds_the_same_assembly(unit: LengthUnit, tmp_path: Path) -> None:
    """A file in another unit declares it, and has the same bodies at the same positions."""
    drawing = parts.write_nested(tmp_path / "nested.step", unit)
    text = drawing.path.read_text(encoding="utf-8")
    declared = {"mm": ".MILLI.,.METRE.", "cm": ".CENTI.,.METRE.", "m": "$,.METRE.", "inch": "'INCH'", "foot": "'FOOT'"}
    assert declared[unit] in text
    for part, piece in zip(occurrences(drawing.path), drawing.pieces, strict=True):
        assert_same_body(solid_moments(part.shape).moved(part.X_WC).in_metres(), piece.body)


@pytest.mark.long
def test_another_process_draws_the_same_bytes(tmp_path: Path) -> None:
    """Drawn files do not depend on time, hash seed or addresses of objects."""
    script = "import sys; from pathlib import Path; from tests import parts; parts.write_nested(Path(sys.argv[1]))"
    drawn = set()
    for i in range(2):
        path = tmp_path / str(i) / "nested.step"
        path.parent.mkdir()
        subprocess.run([sys.executable, "-c", script, str(path)], check=True, cwd=LIBRARY.parent)
        drawn.add(path.read_bytes())
    assert len(drawn) == 1


@pytest.mark.long
@pytest.mark.parametrize("robot", ROBOTS)
def test_the_script_draws_the_step_of_the_repository(robot: str, tmp_path: Path) -> None:
    """The script draws the STEP in the repository."""
    pytest.importorskip("build123d", reason="drawing needs build123d")
    target = tmp_path / "drawn.step"
    command = [sys.executable, "-m", f"robot_library.stepbot_{robot}.build", "-o", str(target)]
    subprocess.run(command, check=True, cwd=LIBRARY.parent)
    assert target.read_bytes() == (LIBRARY / f"stepbot_{robot}" / f"{robot}.step").read_bytes()
