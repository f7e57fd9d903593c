"""Every kind of joint and closure, from STEP and sidecar to files read by engines."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from tests.command_line import Conversion, convert
from tests.parts import draw, drawn
from tests.solids import box

pytestmark = pytest.mark.slow

KINDS = """\
version: 1
robot: kinds
step: kinds.step
defaults: {density: 2700}
links:
  base: {parts: [base]}
  ball: {parts: [p1]}
  cross: {parts: [p2]}
  sleeve: {parts: [p3]}
  nut: {parts: [p4]}
  table: {parts: [p5]}
  free: {parts: [p6]}
  follower: {parts: [p7]}
joint_defaults: {"*": {dynamics: {damping: 0.01}}}
joints:
  ball_joint: {type: ball, parent: base, child: ball, origin: {center: p1, offset: {xyz: [0, 0, -30 mm]}}}
  cross_joint:
    type: universal
    parent: base
    child: cross
    origin: {center: p2, offset: {xyz: [0, 0, -30 mm]}}
    axis: x
    axis2: y
  sleeve_joint: {type: cylindrical, parent: base, child: sleeve, origin: {center: p3}, axis: [0, 0.6, 0.8]}
  nut_joint:
    type: screw
    parent: base
    child: nut
    origin: {center: p4, offset: {xyz: [5 mm, 0, 0]}}
    pitch: -4 mm/rev
    zero: 90 deg
    limits: {lower: -3 rev, upper: inf}
  table_joint: {type: planar, parent: base, child: table, origin: {center: p5}, axis: [0.6, 0, 0.8]}
  free_joint: {type: floating, parent: base, child: free, origin: {center: p6, offset: {rpy: [0, 30 deg, 0]}}}
  follower_joint:
    type: revolute
    parent: table
    child: follower
    origin: {center: p7, offset: {xyz: [0, 0, -30 mm]}}
    axis: y
    limits: {lower: -inf, upper: 90 deg}
    mimic: {joint: nut_joint, multiplier: -0.25, offset: 22.5 deg}
"""

SLIDER_CRANK = """\
version: 1
robot: crank_and_slide
step: kinds.step
defaults: {density: 2700}
links:
  base: {parts: [base, p4, p5, p6, p7], collision: none}
  crank: {parts: [p1]}
  rod: {parts: [p2]}
  piston: {parts: [p3]}
joints:
  shaft: {type: continuous, parent: base, child: crank, origin: {xyz: [0, 0, 0.05]}, axis: y}
  big_end: {type: continuous, parent: crank, child: rod, origin: {xyz: [0.05, 0, 0.1]}, axis: y}
  wrist: {type: continuous, parent: rod, child: piston, origin: {xyz: [0.25, 0, 0.05]}, axis: y}
closures:
  cylinder: {type: prismatic, link_a: base, link_b: piston, origin: {xyz: [0.25, 0, 0.05]}, axis: x}
actuators:
  motor: {joint: shaft, kind: velocity, kv: 0.1}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A STEP of a plate and seven small boxes above it, none of them a cube."""
    place = tmp_path_factory.mktemp("kinds")
    parts = [Occurrence(drawn("base", box(800, 300, 10)), "base:1")]
    parts += [
        Occurrence(drawn(f"p{i}", box(20 + i, 30, 40 - 2 * i)), f"p{i}:1", pose((100 * i - 400, 10 * i, 100)))
        for i in range(1, 8)
    ]
    draw(place / "kinds.step", Assembly("kinds", parts))
    return place


def _converted(folder: Path, name: str, text: str) -> Conversion:
    sidecar = folder / f"{name}.robot.yaml"
    sidecar.write_text(text, encoding="utf-8", newline="\n")
    return convert(sidecar, folder / name)


@pytest.mark.slow
def test_every_kind_of_joint_converts_and_every_check_passes(folder: Path) -> None:
    """All files are written, and every check of every engine passes."""
    report = _converted(folder, "kinds", KINDS).report
    assert report["summary"]["failed"] == 0
    assert {entry["severity"] for entry in report["diagnostics"]} <= {"warning", "note"}
    kinds = {joint["kind"] for joint in report["robot"]["joints"]}
    assert kinds == {"ball", "universal", "cylindrical", "screw", "planar", "floating", "revolute"}
    passed = {(c["format"], c["engine"], c["quantity"]) for c in report["checks"] if c["status"] == "passed"}
    for written_in, engine in (("urdf", "mujoco"), ("urdf", "pybullet"), ("mjcf", "mujoco"), ("sdf", "reader")):
        assert {(written_in, engine, quantity) for quantity in ("poses", "mass matrix", "gravity forces")} <= passed


@pytest.mark.slow
def test_a_closure_that_slides_converts_and_every_check_passes(folder: Path) -> None:
    """A sliding closure has one degree of freedom, a file for Drake, and a snippet for PyBullet."""
    conversion = _converted(folder, "slide", SLIDER_CRANK)
    report = conversion.report
    assert report["summary"]["failed"] == 0
    assert report["robot"]["degrees_of_freedom"] == 1
    assert report["robot"]["driven"] == ["shaft"]
    assert "JOINT_PRISMATIC" in {one["type"] for one in report["robot"]["pybullet"]}
    assert (conversion.folder / "crank_and_slide.drake.sdf").exists()
    assert "1 degree of freedom" in conversion.run.out
