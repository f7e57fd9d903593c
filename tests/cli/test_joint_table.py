"""The joint table fits any screen and shows type, links, axis, origin and evidence of each joint."""

import json
from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.robot.joint_table import Basis, Evidence, JointRow, Rival, Side
from stepbot_cli.table import joint_lines
from tests.cli.conftest import Stepbot

MM = 1e-3
PIN = Side("base/pin", 10 * MM, bore=False)
HUB = Side("arm/hub", 10.05 * MM, bore=True)
OTHER = Rival(Basis.TOUCH, (0.0, 0.02, 0.03), (0.0, 0.6, 0.8), (5 * MM, 3 * MM), 0.5)
FIT = Evidence(Basis.FIT, "axis that link 'base' and link 'arm' share", (PIN, HUB), 18 * MM, rivals=(OTHER,))
SHOULDER = JointRow("shoulder", "revolute", "base", "arm", (0.0, 0.0, 0.102), (0.0, 0.0, -1.0), evidence=FIT)
ARM2 = Path(__file__).parents[2] / "robot_library" / "stepbot_arm2" / "arm2.robot.yaml"


def test_a_joint_in_words() -> None:
    """A row has type, both links, axis and origin, the faces with their components, and the other candidate lines."""
    assert joint_lines([SHOULDER], 200) == [
        "Joints, as modelled in CAD, in the STEP frame:",
        "  shoulder: revolute, base -> arm",
        "    axis -z through [0, 0, 102] mm",
        "    shaft of radius 10 mm in bore of radius 10.05 mm, 18 mm engaged",
        "    shaft of radius 10 mm: base/pin",
        "    bore of radius 10.05 mm: arm/hub",
        "    other line (touch), 50 % as wide: [0, 0.6, 0.8] through [0, 20, 30] mm, radius 5, 3 mm",
    ]


def test_weak_evidence_is_marked() -> None:
    """A joint on weak evidence is marked, with the reason, and counted in the last line."""
    doubted = replace(FIT, basis=Basis.TOUCH, overlap=-0.2 * MM, doubt="they do not fit")
    lines = joint_lines([SHOULDER, replace(SHOULDER, name="elbow", evidence=doubted)], 200)
    assert lines[-8:] == [
        "? elbow: revolute, base -> arm",
        "    axis -z through [0, 0, 102] mm",
        "    shaft of radius 10 mm and bore of radius 10.05 mm, 0.2 mm apart",
        "    weak: they do not fit",
        "    shaft of radius 10 mm: base/pin",
        "    bore of radius 10.05 mm: arm/hub",
        "    other line (touch), 50 % as wide: [0, 0.6, 0.8] through [0, 20, 30] mm, radius 5, 3 mm",
        "1 of 2 joints on weak evidence: elbow",
    ]


@pytest.mark.parametrize(
    ("evidence", "words"),
    [
        (Evidence(Basis.GIVEN, 'numbers, relative to "assembly"'), 'given: numbers, relative to "assembly"'),
        (Evidence(Basis.AXIS, "", (HUB,), selected=True), "axis of bore of radius 10.05 mm, selected by the sidecar"),
        (
            replace(
                FIT, basis=Basis.APART, overlap=-0.002, selected=True, selected_by=(Side("arm", 0.008, bore=True),)
            ),
            "selected by bore of radius 8 mm: shaft of radius 10 mm and bore of radius 10.05 mm, 2 mm apart",
        ),
        (
            replace(FIT, selected=True, selected_by=(HUB,)),
            "shaft of radius 10 mm in bore of radius 10.05 mm, 18 mm engaged, selected by the sidecar",
        ),
        (Evidence(Basis.FLANGE, "", (HUB, HUB), 0.0), "equal bores of radius 10.05 mm, end to end"),
        (replace(FIT, basis=Basis.TOUCH), "shaft of radius 10 mm and bore of radius 10.05 mm, overlapping by 18 mm"),
        (
            replace(FIT, basis=Basis.APART, overlap=-0.228, selected=True),
            "shaft of radius 10 mm and bore of radius 10.05 mm, 228 mm apart, selected by the sidecar",
        ),
    ],
)
def test_every_basis_has_words(evidence: Evidence, words: str) -> None:
    """Each form of origin has a description."""
    assert joint_lines([replace(SHOULDER, evidence=evidence)], 160)[3] == f"    {words}"


def test_joints_without_axis_and_closures() -> None:
    """A ball joint has a centre and no axis, a universal joint two axes; closures are labelled."""
    ball = replace(SHOULDER, kind="ball", axis=None, is_closure=True)
    universal = replace(SHOULDER, kind="universal", axis2=(1.0, 0.0, 0.0))
    lines = joint_lines([ball, universal], 80)
    assert lines[1:3] == ["  shoulder: ball closure, base -> arm", "    at [0, 0, 102] mm"]
    assert "  shoulder: universal, base -> arm" in lines
    assert "    axis -z and +x through [0, 0, 102] mm" in lines


@pytest.mark.parametrize("width", [20, 60, 61, 79])
def test_fits_the_screen(width: int) -> None:
    """No line exceeds the screen, at 60 columns and more; control characters in names are escaped."""
    row = replace(SHOULDER, name="left front upper shoulder joint", parent="left front upper plate of the base \x1b[2J")
    lines = joint_lines([row, replace(row, evidence=replace(FIT, doubt="nothing fits " * 9))], width)
    assert max(map(len, lines)) <= max(width, 60)
    assert "\x1b" not in "".join(lines)


@pytest.mark.slow
def test_check_convert_and_verify_agree(stepbot: Stepbot, tmp_path: Path) -> None:
    """`check --step`, `convert` and `report.json` have the same table; `verify` reads the same axes from the files."""
    lines = ARM2.read_text(encoding="utf-8").splitlines()
    at_zero = tmp_path / "arm2.robot.yaml"  # drawn at q = 0, the position of `verify`
    at_zero.write_text("\n".join(line for line in lines if "zero:" not in line), encoding="utf-8")
    step = str(ARM2.with_name("arm2.step"))
    checked = stepbot("check", f"--step={step}", "--json", str(at_zero))
    (table,) = json.loads(checked.out)["joint_tables"].values()
    names = ["shoulder", "elbow", "finger", "finger_mirror"]
    assert [(row["name"], row["basis"]) for row in table] == [(name, "fit") for name in names]
    out = tmp_path / "arm2"
    converted = stepbot("convert", str(at_zero), "--step", step, "-o", str(out), "-f", "urdf", "--no-verify", "-v")
    assert "  shoulder: revolute, base -> upper_arm\n    axis +z through [0, 0, 102] mm\n" in converted.out
    assert json.loads((out / "report.json").read_text(encoding="utf-8"))["joint_table"] == table
    verified = json.loads(stepbot("verify", "--json", str(out / "arm2.urdf")).out)["report"]["joint_table"]
    seen = {row["name"]: row for row in verified}
    for row in table:
        assert seen[row["name"]]["basis"] == "file"
        assert seen[row["name"]]["axis"] == pytest.approx(row["axis"], abs=1e-9)
        assert seen[row["name"]]["origin"] == pytest.approx(row["origin"], abs=1e-9)
