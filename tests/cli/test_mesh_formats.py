"""``mesh: {format, visual, collision}`` in a sidecar: engines prove the files."""

import json
from pathlib import Path

import pytest

from tests import parts

from .conftest import Stepbot

SIDECAR = """\
version: 1
robot: hinge
step: hinge.step
mesh: {mesh}
defaults: {{density: 1000}}
links:
  plate: {{parts: [plate]}}
  arm: {{parts: [arm]}}
joints:
  hinge: {{type: revolute, parent: plate, child: arm, limits: {{lower: -1, upper: 1, effort: 1, velocity: 1}}}}
"""


@pytest.mark.parametrize(
    ("mesh", "kinds", "noted"),
    [
        ("{format: dae, collision: stl}", {".dae", ".obj", ".stl"}, "MJCF: MuJoCo does not read COLLADA"),
        ("{visual: glb}", {".glb", ".obj"}, "MJCF: MuJoCo does not read glTF"),
    ],
)
def test_engines_prove_the_files(
    stepbot: Stepbot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mesh: str, kinds: set[str], noted: str
) -> None:
    """Boxes of all meshes agree in all engines, which report the copies that they needed."""
    monkeypatch.chdir(tmp_path)
    parts.write_hinge(Path("hinge.step"))
    Path("hinge.robot.yaml").write_text(SIDECAR.format(mesh=mesh), encoding="utf-8")
    run = stepbot("convert", "hinge.robot.yaml", "-o", "out", "-v")
    assert run.code == 0, run.err
    assert noted in run.err
    assert {path.suffix for path in Path("out/meshes").iterdir()} == kinds
    report = json.loads(Path("out/report.json").read_text(encoding="utf-8"))
    assert set(report["names"]) == {path.relative_to("out").as_posix() for path in Path("out/meshes").iterdir()}
    passed = [one for one in report["checks"] if (one["quantity"], one["status"]) == ("meshes", "passed")]
    compared = {(one["format"], one["engine"]) for one in passed}
    assert {("urdf", "mujoco"), ("mjcf", "mujoco"), ("sdf", "reader")} <= compared
    reader = "mujoco" if ".dae" in kinds else "pybullet"
    if any(engine == reader for _, engine in compared):
        assert "read from a copy with OBJ in place of" in json.dumps(report["notes"])
