"""`init --from` a converted robot and its STEP drafts the robot of the hand-made sidecar."""

from pathlib import Path

import pytest

from stepbot.robot.model import JointKind
from tests.library.conftest import LIBRARY, sidecar_of
from tests.redrafting import differences, redrafted

MOVED = "root: {link: base, frame: {xyz: [0.3, -0.2, 0.1], rpy: [20 deg, -35 deg, 110 deg]}}\n"
"""Another base frame, along no axis of the assembly."""


def step_of(robot: str) -> Path:
    """The STEP in a robot's folder."""
    (step,) = (LIBRARY / robot).glob("*.step")
    return step


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "suffix"),
    [
        ("stepbot_arm2", "urdf"),
        pytest.param("stepbot_desk_arm", "xml", marks=pytest.mark.long),
        pytest.param("stepbot_desk_arm", "sdf", marks=pytest.mark.long),
        pytest.param("robotiq_2f85", "urdf", marks=pytest.mark.long),
        pytest.param("franka_panda", "urdf", marks=pytest.mark.long),
        pytest.param("abb_yumi", "urdf", marks=pytest.mark.long),
        pytest.param("kinova_gen3", "xml", marks=pytest.mark.long),
    ],
)
def test_same_robot_comes_back(robot: str, suffix: str, tmp_path: Path) -> None:
    """Links, components, masses, joints with axes, limits and drawn positions are those of the original."""
    result = redrafted(sidecar_of(robot), step_of(robot), tmp_path, suffix)
    assert differences(result) == []
    assert all(joint.confidence.is_sure for joint in result.draft.joints)


@pytest.mark.long
def test_closures_come_back(tmp_path: Path) -> None:
    """The closures of a gripper in MJCF are at their original pins."""
    result = redrafted(sidecar_of("robotiq_2f85"), step_of("robotiq_2f85"), tmp_path, "xml")
    pairs = zip(result.drawn.closures, result.again.closures, strict=True)
    for ours, theirs in pairs:
        assert (ours.name, theirs.kind) == (theirs.name, JointKind.REVOLUTE)
        assert ours.X_AF.distance_to(theirs.X_AF)[0] < 1e-6 or abs(ours.X_AF.p - theirs.X_AF.p)[1:].max() < 1e-6


@pytest.mark.long
@pytest.mark.parametrize("robot", ["stepbot_desk_arm"])
def test_description_in_another_frame_is_found(robot: str, tmp_path: Path) -> None:
    """A description with another base frame, rotated about no axis of the CAD, is located by its joint axes."""
    sidecar = tmp_path / "moved.robot.yaml"
    sidecar.write_text(sidecar_of(robot).read_text(encoding="utf-8") + MOVED, encoding="utf-8")
    result = redrafted(sidecar, step_of(robot), tmp_path, "urdf")
    assert "joint axes" in result.draft.notes[0]
    assert differences(result) == []


@pytest.mark.long
def test_without_meshes_inferred_links_with_the_same_axes_are_taken(tmp_path: Path) -> None:
    """Without meshes all components are in the right links; unconfirmed ones are marked, and masses are given."""
    result = redrafted(sidecar_of("stepbot_desk_arm"), step_of("stepbot_desk_arm"), tmp_path, "urdf", meshes=False)
    assert not [text for text in differences(result) if not text.startswith("drawn position of gripper")]
    assert all(joint.is_reviewed for joint in result.draft.joints)
