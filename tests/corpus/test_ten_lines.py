"""`init` and at most ten edited lines give the robots of two hand-made sidecars: links, masses, joints."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.truth import read_truth
from stepbot.draft.text.sidecar_text import sidecar_text
from stepbot.pipeline.drafting import draft_step
from stepbot.pipeline.stages import Options, produce
from tests.corpus.test_authoring import PAGE, blocks, edited
from tests.corpus.test_inference import read

pytestmark = [pytest.mark.slow, pytest.mark.long]
HERE = Path(__file__).parent
SO101 = """\
+joint_defaults:
+  "*": {limits: {lower: -3, upper: 3, effort: 1, velocity: 1}}
"""
"""What the draft of SO-101 lacks; its densities are the placeholder's."""


@pytest.mark.parametrize("robot", ["follower", "so101"])
def test_draft_and_ten_lines_give_the_sidecar_made_by_hand(robot: str, corpus: Path, tmp_path: Path) -> None:
    """Links have equal components and masses, joints equal axes; names and signs may differ."""
    if robot == "follower":
        step, by_hand = corpus / "low_cost_robot_follower.step", HERE / "low_cost_robot_follower.robot.yaml"
        (lines,) = blocks("diff", PAGE.read_text(encoding="utf-8"))
    else:
        step, by_hand, lines = corpus / "so101_assembly.step", corpus / "joints" / "so101.robot.yaml", SO101
    added, removed = (sum(line.startswith(sign) for line in lines.splitlines()) for sign in "+-")
    assert max(added, removed) <= 10  # a line that is replaced is one
    draft = draft_step(step, Options(tmp_path)).draft
    assert draft is not None
    drafted = tmp_path / "draft.robot.yaml"
    drafted.write_text(edited(sidecar_text(draft, step.as_posix(), schema=""), lines), encoding="utf-8")

    assembly = read(step)
    ours, theirs = read_truth(drafted, assembly), read_truth(by_hand, assembly)
    names = {theirs.link_of[i]: ours.link_of[i] for i in theirs.link_of}
    assert {i: names[link] for i, link in theirs.link_of.items()} == ours.link_of
    assert len(set(names.values())) == len(names) == len(theirs.joints) + 1
    for joint in theirs.joints:
        (same,) = (one for one in ours.joints if {one.a, one.b} == {names[joint.a], names[joint.b]})
        assert same.kind == joint.kind
        assert np.linalg.norm(np.cross(joint.point - same.point, same.axis)) < 5e-6
        assert np.linalg.norm(np.cross(joint.axis, same.axis)) < 5e-5

    robots = [produce(path, Options(tmp_path, step=step, verify=False)).robot for path in (drafted, by_hand)]
    assert robots[0] is not None
    assert robots[1] is not None
    for link in robots[1].links:
        mass = robots[0].link_by_name[names[link.name]].mass_properties.mass
        assert mass == pytest.approx(link.mass_properties.mass, rel=1e-9)
