"""`init --from` on real assemblies: a URDF of a hand-made sidecar gives the robot of that sidecar."""

from pathlib import Path

import pytest

from tests.redrafting import differences, redrafted

pytestmark = [pytest.mark.slow, pytest.mark.long]
HERE = Path(__file__).parent


def test_so101_comes_back(corpus: Path, tmp_path: Path) -> None:
    """Seven links of 17 components and six joints in oblique frames are equal, with nothing to review."""
    result = redrafted(corpus / "joints" / "so101.robot.yaml", corpus / "so101_assembly.step", tmp_path, "urdf")
    assert differences(result) == []
    assert all(link.confidence.is_sure for link in result.draft.links)


def test_follower_comes_back(corpus: Path, tmp_path: Path) -> None:
    """Of 163 bodies three surfaces of screws may be in the adjacent link; masses, limits and joints are equal."""
    sidecar = HERE / "low_cost_robot_follower.robot.yaml"
    result = redrafted(sidecar, corpus / "low_cost_robot_follower.step", tmp_path, "urdf")
    assert not [text for text in differences(result) if not text.startswith("components of")]
    of = {path: name for name, link in result.drawn.link_by_name.items() for path in link.components}
    again = {path: name for name, link in result.again.link_by_name.items() for path in link.components}
    moved = [path for path in of if again[path] != of[path]]
    assert all("BTS2" in path for path in moved)
    assert len(moved) <= 3
