"""The composed robots of the library: their page, and what is exported of them."""

import re
import shlex
from pathlib import Path

import pytest

from stepbot.pipeline.conversion import Options
from stepbot.pipeline.stages import convert, produce
from stepbot.robot.model import Robot
from stepbot.runtime.cache import Cache
from stepbot.runtime.robot_library import LibraryRobot, library_robot, library_robots
from tests.command_line import stepbot
from tests.simulators.conftest import skip_without

COMPOSED = tuple(robot for robot in library_robots() if robot.is_composed)


@pytest.mark.slow
@pytest.mark.parametrize("robot", COMPOSED, ids=lambda robot: robot.name)
def test_page_and_files(robot: LibraryRobot, tmp_path: Path, cache: Cache) -> None:
    """The exported files make the robot whose numbers are on the page, and the page shows the sidecar."""
    for name, content in robot.source().items():
        (tmp_path / name).write_bytes(content)
    options = Options(tmp_path / "out", ("mjcf",), verify=False, cache=cache)
    made = produce(tmp_path / robot.sidecar.name, options)
    assert not made.diagnostics.has_errors, list(made.diagnostics)
    assert made.robot is not None
    assert robot.facts() == _facts(made.robot, made.files["report.json"])
    assert robot.summary().endswith(".")
    assert robot.picture.is_file() != robot.name.endswith(("_leg", "_arm"))
    page = robot.page.read_text(encoding="utf-8").partition(f"\n## {robot.name}\n")[2].partition("\n## ")[0]
    shown = re.search("```yaml\n(.*?)```", page, re.DOTALL)
    text = robot.sidecar.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith(("#", "metadata:"))]
    assert shown is None or shown[1] == "\n".join(lines).strip() + "\n"
    assert shown is not None or f"({robot.sidecar.name})" in page


def _facts(robot: Robot, report: bytes) -> str:
    loops = f", {len(robot.closures)} loop{'s' * (len(robot.closures) > 1)}" if robot.closures else ""
    mass = sum(link.mass_properties.mass for link in robot.links)
    freedom = re.search(rb'"degrees_of_freedom": (\d+)', report)
    assert freedom is not None
    return f"{len(robot.links)} links, {int(freedom[1])} DoF{loops}, {mass:.4g} kg"


@pytest.mark.slow
def test_masses_add_up(tmp_path: Path, cache: Cache) -> None:
    """The arm of 21.70 kg, the changer of 0.15 kg and the gripper of 0.925 kg."""
    options = Options(tmp_path, ("mjcf",), verify=False, cache=cache)
    robot = produce(library_robot("ur5e_2f85").sidecar, options).robot
    assert robot is not None
    assert sum(link.mass_properties.mass for link in robot.links) == pytest.approx(21.70 + 0.15 + 0.925, abs=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("robot", [one for one in COMPOSED if "_leg" not in one.name], ids=lambda robot: robot.name)
def test_engines_prove_it(robot: LibraryRobot, tmp_path: Path) -> None:
    """Every installed engine reads the files as the model is."""
    made = convert(robot.sidecar, Options(tmp_path))
    assert not made.diagnostics.has_errors, [str(one) for one in made.diagnostics if one.severity == "error"]
    assert made.report is not None
    engines = {row.engine for row in made.report.rows() if row.status.value == "passed"}
    assert {"mujoco", "pybullet"} <= engines


@pytest.mark.long
@pytest.mark.parametrize("name", ["ur5e_2f85", "dog"])
def test_newton_reads_one_articulation(name: str, tmp_path: Path) -> None:
    """Newton's mass matrix of the OpenUSD is the model's, which is the sum of its modules."""
    skip_without("newton")
    made = convert(library_robot(name).sidecar, Options(tmp_path, ("usd",), require=("newton",)))
    assert not made.diagnostics.has_errors, [str(one) for one in made.diagnostics if one.severity == "error"]
    assert made.report is not None
    seen = {check.quantity: check.status.value for check in made.report.checks if check.engine == "newton"}
    assert (seen["mass matrix"], seen["poses"], seen["inertia"]) == ("passed",) * 3
    assert (tmp_path / f"{name}.usda").read_text(encoding="utf-8").count('"PhysicsArticulationRootAPI"') == 1


@pytest.mark.long
def test_the_page_can_be_followed(tmp_path: Path) -> None:
    """Each file and each command of stepbot on the way of the page from two STEP files to an arm with a hand."""
    page = (Path(__file__).parents[2] / "docs/compose.md").read_text(encoding="utf-8")
    section = page.partition("\n## From two STEP files to an arm with a hand\n")[2].partition("\n## ")[0]
    run = []
    for kind, text in re.findall("```(sh|yaml)\n(.*?)```", section, re.DOTALL):
        if kind == "yaml":
            (tmp_path / text.split()[1]).write_text(text, encoding="utf-8")
            continue
        for line in text.splitlines():
            program, command, *arguments = shlex.split(line, comments=True)
            if program == "stepbot" and command != "view":
                made = stepbot(command, *arguments, cwd=tmp_path)
                assert made.code == 0, (line, made.out, made.err)
                run.append(command)
    assert run == [*["library"] * 2, *["init"] * 2, *["check"] * 3, "convert", "drive", "convert"]
    assert (tmp_path / "arm_with_hand/arm_with_hand.scene.usda").is_file()
    assert (tmp_path / "src/arm_with_hand_description/launch/view.launch.py").is_file()
