"""``mesh: {format, visual, collision, max_triangles}`` in a sidecar: engines prove the files."""

import json
import shutil
from pathlib import Path
from xml.etree import ElementTree as ET

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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mesh", "kinds", "noted"),
    [
        ("{format: dae, collision: stl}", {".dae", ".obj", ".stl"}, "MJCF: MuJoCo does not read COLLADA"),
        pytest.param("{visual: glb}", {".glb", ".obj"}, "MJCF: MuJoCo does not read glTF", marks=pytest.mark.long),
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


@pytest.mark.slow
def test_budgets_hold_for_a_link_and_the_robot(
    stepbot: Stepbot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is drawn is within both budgets, as the report says; masses and collisions are those without a budget."""
    monkeypatch.chdir(tmp_path)
    parts.write_hinge(Path("hinge.step"))
    budgets = SIDECAR.replace("[plate]}", "[plate], mesh: {{max_triangles: 60}}}")
    for name, text in (("plain", SIDECAR.format(mesh="{}")), ("coarse", budgets.format(mesh="{max_triangles: 160}"))):
        Path(f"{name}.robot.yaml").write_text(text, encoding="utf-8")
        run = stepbot("convert", f"{name}.robot.yaml", "-o", name, "--no-verify", "-f", "urdf", "-v")
        assert run.code == 0, run.err
    assert run.err.count("note[SB611]: ") == 2
    plain, coarse = (ET.parse(Path(name, "hinge.urdf")).getroot() for name in ("plain", "coarse"))
    for tag in ("inertial", "collision"):
        assert [ET.tostring(one) for one in plain.iter(tag)] == [ET.tostring(one) for one in coarse.iter(tag)]
    counts = {
        link.get("name"): sum(
            Path("coarse", mesh.get("filename", "")).read_text().count("\nf ") for mesh in link.findall("visual//mesh")
        )
        for link in coarse.iter("link")
    }
    report = json.loads(Path("coarse/report.json").read_text(encoding="utf-8"))
    own, whole = report["simplified_visuals"]
    assert (own["link"], own["after"]) == ("plate", counts["plate"])
    assert (whole["link"], whole["after"]) == (None, counts["plate"] + counts["arm"])
    assert 30 < counts["plate"] <= 60
    assert 120 < whole["after"] <= 160
    assert 0.0 < own["deviation"] < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["obj", "stl", "dae", "glb"])
def test_files_within_a_number_of_bytes(
    kind: str, stepbot: Stepbot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The files of the visual meshes fit in ``max_bytes``; all else is as without."""
    monkeypatch.chdir(tmp_path)
    parts.write_hinge(Path("hinge.step"))
    chosen = f"visual: {kind}, angle: 2 deg"
    sizes, rest = [], []
    for name, mesh in (("plain", f"{{{chosen}}}"), ("small", f"{{{chosen}, max_bytes: 9 kB}}")):
        Path(f"{name}.robot.yaml").write_text(SIDECAR.format(mesh=mesh), encoding="utf-8")
        run = stepbot("convert", f"{name}.robot.yaml", "-o", name, "--no-verify", "-f", "sdf", "-v")
        assert run.code == 0, run.err
        top = ET.parse(Path(name, "hinge.sdf")).getroot()
        shown = {uri.text or "" for uri in top.iterfind(".//visual//uri")}
        assert shown
        sizes.append(sum(Path(name, path).stat().st_size for path in shown))
        rest.append([ET.tostring(one) for tag in ("inertial", "collision") for one in top.iter(tag)])
    assert sizes[0] > 1.5 * 9000 >= 1.5 * sizes[1]
    assert rest[0] == rest[1]
    (note,) = (line for line in run.err.splitlines() if "SB611" in line)
    assert "bytes, off by up to" in note
    assert "'arm'" in note
    (record,) = json.loads(Path("small/report.json").read_text(encoding="utf-8"))["simplified_visuals"]
    assert (record["max_bytes"], record["max_triangles"]) == (9000, None)
    assert record["after"] < record["before"]


@pytest.mark.parametrize(
    ("text", "code"), [("10 parsecs", "SB122"), ("0", "SB125"), ("0.2", "SB122"), ("-1k", "SB122"), ("true", "SB122")]
)
def test_what_is_no_number_of_bytes(
    text: str, code: str, stepbot: Stepbot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is reported at its place."""
    monkeypatch.chdir(tmp_path)
    parts.write_hinge(Path("hinge.step"))
    Path("hinge.robot.yaml").write_text(SIDECAR.format(mesh=f"{{max_bytes: {text}}}"), encoding="utf-8")
    run = stepbot("check", "hinge.robot.yaml")
    assert run.code == 1
    assert f"error[{code}]: mesh.max_bytes" in run.out


@pytest.mark.long
def test_an_arm_of_the_library_with_few_triangles(
    stepbot: Stepbot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, robot_library: Path
) -> None:
    """The Panda's 48 466 triangles become 3000, with the deviation that docs/sidecar.md states."""
    monkeypatch.chdir(tmp_path)
    for file in ("panda.robot.yaml", "panda.step"):
        shutil.copy(robot_library / "franka_panda" / file, tmp_path)
    sidecar = Path("panda.robot.yaml")
    sidecar.write_text(sidecar.read_text(encoding="utf-8") + "mesh: {max_triangles: 3000}\n", encoding="utf-8")
    run = stepbot("convert", "panda.robot.yaml", "-o", "out", "--no-verify", "-f", "mjcf")
    assert run.code == 0, run.err
    (record,) = json.loads(Path("out/report.json").read_text(encoding="utf-8"))["simplified_visuals"]
    assert (record["before"], record["after"]) == (48466, 3000)
    assert 1e3 * record["deviation"] == pytest.approx(7.4, abs=0.05)
