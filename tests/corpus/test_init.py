"""Sidecars drafted from real assemblies pass the check, convert unedited, and pass their proof."""

import json
import shutil
from pathlib import Path

import pytest

from tests.command_line import stepbot

pytestmark = pytest.mark.slow


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "links", "joints"),
    [
        pytest.param("simple_pendulum.step", 2, ["revolute"], marks=pytest.mark.long),
        ("two_joint_servo_arm_ap242.step", 3, ["revolute", "revolute"]),
        # Two coupled loops that reach a dead centre.
        pytest.param(
            "openarm_leader_gripper.step",
            6,
            ["revolute", "prismatic", "prismatic", "revolute", "revolute"],
            marks=pytest.mark.long,
        ),
    ],
)
def test_draft_of_a_real_assembly_converts(
    file: str, links: int, joints: list[str], corpus: Path, tmp_path: Path
) -> None:
    """`init` finds the joints of the assembly; its sidecar converts with warnings and without errors."""
    shutil.copy(corpus / file, tmp_path)
    drafted = stepbot("init", file, "-o", "a.robot.yaml", "--json", cwd=tmp_path)
    assert drafted.code == 0, drafted.out
    document = json.loads(drafted.out)
    assert (len(document["links"]), [joint["type"] for joint in document["joints"]]) == (links, joints)
    converted = stepbot("convert", "a.robot.yaml", "-o", "out", cwd=tmp_path)
    assert converted.code == 0, converted.err
    assert (tmp_path / "out" / "a.urdf").is_file()


ASSEMBLIES = (
    "aryan",
    "b6",
    "b6b",
    "devdrik",
    "doganc",
    "double_pendulum",
    "elmo",
    "engi",
    "exo",
    "fcg",
    "furuta",
    "gantry",
    "gripde",
    "hanie",
    "haptic",
    "hex",
    "laurie",
    "pimouse",
    "planar",
    "realman_gripper",
    "reconcycle_arm",
    "robot_hand",
    "rover",
    "rst_ee",
    "rst_if",
    "rzlli_quadruped",
    "shrey",
    "spot",
    "str_head",
    "str_wrist",
    "swerve",
    "syed",
    "trex",
)


@pytest.mark.long
@pytest.mark.parametrize("name", ASSEMBLIES)
def test_every_assembly_by_others_gives_a_draft_that_is_proven(name: str, corpus: Path, tmp_path: Path) -> None:
    """Loops next to dead centres, names in a wrong code page, links of surfaces, a motor's half within its housing."""
    step = corpus / "assemblies" / f"{name}.step"
    drafted = stepbot("init", step, "-o", "a.robot.yaml", cwd=tmp_path)
    assert drafted.code == 0, drafted.out + drafted.err
    converted = stepbot("convert", "a.robot.yaml", "-o", "out", cwd=tmp_path)
    assert converted.code == 0, converted.err
