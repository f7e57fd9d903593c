"""Every robot of the library has a uniform folder, converts, has consistent files, and can be simulated."""

import json
import re
import shutil
from pathlib import Path

import pytest
from lxml import etree
from ruamel.yaml import YAML

from tests.command_line import stepbot
from tests.engines import ASLANT
from tests.library.conftest import (
    LIBRARY,
    ROBOTS,
    Converted,
    converted_robots,
    every_converted_robot,
    every_robot,
    name_of,
    sidecar_of,
)
from tests.processes import call_isolated

BETWEEN = {"ball": 2, "universal": 1, "screw": 1, "cylindrical": 1, "planar": 2, "floating": 5}
"""Links that URDF adds between the two links of a joint that it writes as several."""
FINER_STEPS = {"kinova_gen3": 5e-4}
"""Steps [s] of robots for which 1 ms is too long: a wrist without damping briefly exceeds 100 rad/s and gains 12 % of
energy; at half the step it is 1 %."""
PULLS = {"robotiq_2f85": (-3.0, -4.0, 8.0)}
"""Other gravities [m/s^2] for robots that standard gravity pulls against their stops."""
BALANCED = "stepbot_diff_drive"
"""A robot whose joints are wheels and a ball, which gravity does not move."""
ALLOWED = re.compile(r"README\.md|expected\.json|preview\.png|drive\.svg|[a-z0-9_]+\.(?:py|step|robot\.yaml)")


def test_the_library_is_not_empty() -> None:
    """The library has robots."""
    assert {"stepbot_four_bar", "stepbot_arm2"} <= set(ROBOTS)


# The folder


@every_robot
def test_folder_has_what_every_folder_has(robot: str) -> None:
    """Sidecar, STEP, drawing script, expected numbers and README exist, named after the robot, and nothing else."""
    name = name_of(robot)
    assert re.fullmatch(rf"[a-z0-9_]+_{name}", robot), "<maker>_<robot>"
    files = {path.name for path in (LIBRARY / robot).iterdir() if path.name != "__pycache__"}
    assert files >= {f"{name}.robot.yaml", f"{name}.step", "build.py", "expected.json", "README.md", "preview.png"}
    assert [file for file in sorted(files) if not ALLOWED.fullmatch(file)] == []
    assert (LIBRARY / robot / f"{name}.step").stat().st_size < 1_000_000


@every_robot
def test_sidecar_names_its_neighbours(robot: str) -> None:
    """The robot's name, its STEP and its schema are those in the folder."""
    sidecar = sidecar_of(robot)
    text = sidecar.read_text(encoding="utf-8")
    name = name_of(robot)
    schema = re.match(r"# yaml-language-server: \$schema=(\S+)\n", text)
    assert schema is not None
    assert (sidecar.parent / schema[1]).is_file()
    content = YAML(typ="safe", pure=True).load(text)
    assert (content["version"], content["robot"], content["step"]) == (1, name, f"{name}.step")


@every_robot
def test_step_header_has_no_person_folder_or_time(robot: str) -> None:
    """The STEP header has no person, folder or time of drawing, so that drawing is reproducible."""
    (step,) = (LIBRARY / robot).glob("*.step")
    header = step.read_text(encoding="utf-8").split("ENDSEC;", 1)[0]
    assert f"FILE_NAME('{step.name}','2000-01-01T00:00:00',(''),('')," in re.sub(r"\s*\n\s*", "", header)


@every_robot
def test_readme_shows_the_command(robot: str) -> None:
    """The command in the README converts this robot."""
    readme = (LIBRARY / robot / "README.md").read_text(encoding="utf-8")
    sidecar = sidecar_of(robot).relative_to(LIBRARY.parent).as_posix()
    assert f"stepbot convert {sidecar}" in readme
    assert readme.startswith(f"# {name_of(robot)}\n")
    named = re.findall(r"^- `([\w.]+)`:", readme, re.MULTILINE)
    assert len(named) >= 4
    assert [file for file in named if not (LIBRARY / robot / file).is_file()] == []


# The conversion


@pytest.mark.slow
@every_converted_robot
def test_converts_and_every_check_passes(robot: str, converted: Converted) -> None:
    """Three formats and a report are written; no check fails, there is no error, and the mass is the expected one."""
    conversion = converted(robot)
    name = name_of(robot)
    tops = {path.name for path in conversion.folder.iterdir() if path.is_file() and not path.name.startswith(".")}
    report = conversion.report
    for_drake = {f"{name}.drake.sdf"} if report["robot"]["closures"] else set()
    scenes = {f"{name}.scene.xml", f"{name}.world.sdf"}
    assert tops == {f"{name}.urdf", f"{name}.sdf", f"{name}.xml", "report.json"} | for_drake | scenes
    assert {file["path"] for file in report["files"]} == tops - {"report.json"}
    assert {file["path"] for file in report["files"] if file["content"] == "scene"} == scenes
    assert report["summary"]["failed"] == 0
    assert [check for check in report["checks"] if check["status"] == "failed"] == []
    assert {entry["severity"] for entry in report["diagnostics"]} <= {"warning", "note"}
    assert report["robot"]["overlaps"] == []
    expected = json.loads((LIBRARY / robot / "expected.json").read_text(encoding="utf-8"))
    (mass,) = {body["mass"] for key, body in expected.items() if key.startswith("total")}
    assert report["robot"]["mass"] == pytest.approx(mass, rel=1e-3)
    links = {link["name"] for link in report["robot"]["links"]}
    # Links and joints share a namespace: a maker's joint named like its link becomes `<link>_joint`.
    known = {f"{joint}_joint" if joint in links else joint for joint in expected["joints"]}
    known |= set(expected.get("added_joints", ()))
    assert {joint["name"] for joint in report["robot"]["joints"]} <= known


@pytest.mark.slow
@every_converted_robot
def test_the_three_files_are_one_robot(robot: str, converted: Converted) -> None:
    """`stepbot verify` of the three files, which knows nothing of the CAD, finds no difference between them."""
    conversion = converted(robot)
    files = [conversion.file(suffix).name for suffix in (".urdf", ".sdf", ".xml")]
    run = stepbot("verify", *files, cwd=conversion.folder)
    assert run.code == 0, run.err


@pytest.mark.slow
@every_converted_robot
def test_files_hold_no_absolute_path_and_miss_no_mesh(robot: str, converted: Converted) -> None:
    """Referenced meshes exist, by relative paths and in metres; none is unused; no local path is written."""
    folder = converted(robot).folder
    for suffix, tag, attribute in ((".urdf", "mesh", "filename"), (".sdf", "uri", None), (".xml", "mesh", "file")):
        root = etree.parse(converted(robot).file(suffix)).getroot()
        named = {e.get(attribute) if attribute else e.text for e in root.iter(tag)} - {None}
        assert named == {path.relative_to(folder).as_posix() for path in folder.glob("meshes/*")}
        assert root.xpath("//*[@scale] | //scale | //@package") == []
    for path in folder.rglob("*"):
        if path.is_file():
            content = path.read_bytes()
            assert str(LIBRARY).encode() not in content, path.name
            assert str(folder).encode() not in content, path.name


@pytest.mark.slow
@every_converted_robot
def test_its_files_are_one_robot(robot: str, converted: Converted, tmp_path: Path) -> None:
    """`stepbot verify` on a copy, in another folder and without the report, finds the three files consistent."""
    folder = shutil.copytree(converted(robot).folder, tmp_path / "copy")
    (folder / "report.json").unlink()
    (folder / ".stepbot.json").unlink()
    files = [converted(robot).file(suffix).name for suffix in (".urdf", ".sdf", ".xml")]
    run = stepbot("verify", *files, cwd=folder)
    assert run.code == 0, run.out + run.err
    assert run.out.startswith(f"equal: {files[0]}, {files[1]} and {files[2]} are the same robot in "), run.out
    assert "MuJoCo" in run.out.partition(" (")[0], run.out


# The simulation


@pytest.mark.slow
@pytest.mark.mujoco
@every_converted_robot
@pytest.mark.parametrize("noise", [False, True], ids=["at rest", "noise"])
def test_one_second_in_mujoco(robot: str, noise: bool, converted: Converted) -> None:
    """From its keyframe, held by its actuators or with noise on them: no warning, divergence or collision."""
    seen = call_isolated("tests.engines:run_in_mujoco", str(converted(robot).file(".xml")), 1.0, noise)
    assert not any(seen["warnings"])
    assert seen["finite"]
    if noise:
        assert seen["speed"] > 1e-3
    else:
        assert seen["speed"] < 1.0  # [rad/s] or [m/s]: the sag on its springs
        assert seen["depth"] > -1e-4


@pytest.mark.slow
@pytest.mark.pybullet
@every_converted_robot
def test_one_second_in_pybullet(robot: str, converted: Converted) -> None:
    """Hanging from its base without motors, or fallen on a floor, the robot stays finite and gains no energy."""
    pytest.importorskip("pybullet")
    conversion = converted(robot)
    report = conversion.report["robot"]
    step = FINER_STEPS.get(robot, 1e-3)
    seen = call_isolated("tests.engines:run_in_pybullet", str(conversion.file(".urdf")), 1.0, report, step)
    assert seen["finite"]
    assert seen["speed"] > 1e-3
    assert seen["surplus"] < 0.05
    in_between = sum(BETWEEN.get(joint["kind"], 0) for joint in report["joints"])
    away_from_links = sum(sensor["source"] != "" for sensor in report["sensors"])
    optical = sum(sensor["kind"] == "camera" for sensor in report["sensors"])  # a frame of each, as REP 103 has it
    assert seen["links"] == len(report["links"]) + len(report["frames"]) + in_between + away_from_links + optical


@pytest.mark.pybullet
@converted_robots(but=BALANCED)
def test_energy_is_kept_in_pybullet(robot: str, converted: Converted) -> None:
    """In 50 ms from rest, without damping, the work of gravity equals the kinetic energy of all masses and inertias.

    The energies are those of the robot in report.json with the motion of the file in PyBullet.
    """
    pytest.importorskip("pybullet")
    conversion = converted(robot)
    file, report = str(conversion.file(".urdf")), conversion.report["robot"]
    gravity = PULLS.get(robot, ASLANT)
    assert call_isolated("tests.engines:energy_kept_in_pybullet", file, 50, report, gravity) == pytest.approx(
        1, abs=5e-3
    )


@pytest.mark.pybullet
@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_energy_is_not_kept_with_other_inertias(factor: float, converted: Converted, tmp_path: Path) -> None:
    """The energy check fails for an inertia that is wrong by a tenth."""
    pytest.importorskip("pybullet")
    conversion = converted("stepbot_arm2")
    folder = shutil.copytree(conversion.folder, tmp_path / "copy")
    file = folder / conversion.file(".urdf").name
    text = file.read_text(encoding="utf-8")
    wrong = re.sub(r'\b(i[xyz]{2})="([^"]+)"', lambda found: f'{found[1]}="{factor * float(found[2])}"', text)
    file.write_text(wrong, encoding="utf-8")
    kept = call_isolated("tests.engines:energy_kept_in_pybullet", str(file), 50, conversion.report["robot"])
    assert (kept - 1) * (1 - factor) > 1e-3  # lighter ones accelerate more
