"""An arm drawn straight: a horn and a bracket are coaxial, 228 mm apart, and no joint."""

import json
from math import pi
from pathlib import Path

import pytest
from lxml import etree

from tests.cli.conftest import Stepbot
from tests.parts import STRAIGHT_ARM_GAP, write_straight_arm

pytestmark = pytest.mark.slow
SIDECAR = """version: 1
robot: straight
step: straight.step
defaults: {density: 1000 kg/m^3}
links: {upper: {parts: [upper]}, lower: {parts: [lower]}}
joints:
  elbow:
    {type: revolute, parent: upper, child: lower, origin: auto, limits: {lower: -90 deg, upper: 90 deg}}
"""


def _write(origin: str = "auto") -> Path:
    path = Path("straight.robot.yaml")
    path.write_text(SIDECAR.replace("origin: auto", f"origin: {origin}"), encoding="utf-8")
    return path


def _elbow(file: Path) -> tuple[list[float], list[float]]:
    joint = etree.parse(file).getroot().find("joint")
    origin = joint.find("origin")
    return [[float(c) for c in (origin.get(key) or "0 0 0").split()] for key in ("xyz", "rpy")]


def test_the_elbow_is_found(stepbot: Stepbot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The pin in its bore is the joint, in files and table, although the other line is wider."""
    monkeypatch.chdir(tmp_path)
    (line,) = write_straight_arm(Path("straight.step")).lines
    run = stepbot("convert", str(_write()), "-f", "urdf", "-v")
    assert run.code == 0, run.err
    xyz, rpy = _elbow(Path("straight/straight.urdf"))
    assert xyz == pytest.approx(line.point, abs=1e-9)
    assert rpy == pytest.approx((-pi / 2, 0, 0), abs=1e-9)  # z along +y, x as in the assembly
    (row,) = json.loads(Path("straight/report.json").read_text(encoding="utf-8"))["joint_table"]
    assert (row["basis"], row["overlap"], row["clearance"]) == ("fit", pytest.approx(0.01), pytest.approx(5e-5))
    assert [rival["basis"] for rival in row["rivals"]] == ["apart"]
    assert "shaft of radius 8 mm in bore of radius 8.05 mm, 10 mm engaged" in run.out


def test_the_wrong_line_is_refused(stepbot: Stepbot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If links share that line only, it is listed with gap and radii; written into the sidecar, it is accepted."""
    monkeypatch.chdir(tmp_path)
    write_straight_arm(Path("straight.step"), pin=False)
    for origin in ("auto", '{mate: ["upper", "lower"]}'):
        run = stepbot("convert", str(_write(origin)), "-f", "urdf", "--json")
        assert run.code == 1
        assert not Path("straight").exists()
        (fault,) = (one for one in json.loads(run.out)["diagnostics"] if one["severity"] == "error")
        assert (fault["code"], fault["line"]) == ("SB406", 8)
        assert (
            f'shaft of radius 20 mm of "upper" and bore of radius 20.2 mm of "lower" are {STRAIGHT_ARM_GAP:g} mm apart'
            in (fault["notes"][0])
        )
    pasted = fault["help"][0]
    assert pasted == 'origin: {mate: ["upper", "lower"], radius: 20.2 mm}'
    run = stepbot("convert", str(_write(pasted.removeprefix("origin: "))), "-f", "urdf", "-v")
    assert run.code == 0, run.err
    xyz, _ = _elbow(Path("straight/straight.urdf"))
    assert xyz == pytest.approx((0, 0, 0.005 + STRAIGHT_ARM_GAP / 2e3), abs=1e-9)
    assert "228 mm apart, selected by the sidecar" in run.out
