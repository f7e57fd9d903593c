"""`init` drafts `up` for arms drawn on their side, and omits it for upright ones."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.draft.draft_robot import infer
from stepbot.draft.text.sidecar_text import drawn_up, sidecar_text
from stepbot.geometry.inertia import DIRECTIONS, Direction, rotation_of
from stepbot.geometry.spatial import Pose
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import parse_sidecar
from stepbot.step.assembly import Assembly, ReadOptions
from stepbot.step.features.ground import grounds
from tests.unit.step.in_process import read_quietly


@pytest.fixture(scope="module")
def arm(robot_library: Path) -> Assembly:
    """A desk arm, drawn upright."""
    return read_quietly(robot_library / "stepbot_desk_arm" / "desk_arm.step", ReadOptions(faces=True))


@pytest.mark.slow
@pytest.mark.parametrize("up", DIRECTIONS)
def test_a_real_arm_in_all_orientations(up: Direction, arm: Assembly) -> None:
    """The drafted line rotates the robot upright, with its evidence in a comment."""
    X = Pose.of(rotation_of(up, "y" if up.endswith("x") else "x"))
    turned = replace(arm, components=tuple(replace(c, X_WC=X @ c.X_WC) for c in arm.components))
    draft = infer(turned, "arm")
    found = drawn_up(draft, turned)
    text = sidecar_text(replace(draft, standing=found), "arm.step")
    if up.endswith("z"):
        assert found is None
        assert "root:" not in text.replace("# root:", "")
        return
    assert found is not None
    assert found.up == up
    assert f"\nroot: {{up: {up}}}\n" in text
    assert f"# REVIEW: drawn with {up} up?" in text
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("arm.robot.yaml"), diagnostics)
    assert sidecar is not None
    check_sidecar(sidecar, diagnostics)
    assert not diagnostics.has_errors
    assert sidecar.document.root is not None
    assert sidecar.document.root.up == up


@pytest.mark.slow
def test_the_ground_is_below_the_root(arm: Assembly) -> None:
    """The largest flat side of the arm is below its base."""
    found = grounds(arm)
    up = max(found, key=lambda one: sum(found[one].values()))
    draft = infer(arm, "arm")
    (root,) = (link for link in draft.links if link.name == draft.root)
    assert up == "z"
    assert sum(share for i, share in found[up].items() if i in root.components) > 0.9 * sum(found[up].values())
