"""Links and joints inferred from the STEP of real assemblies, against hand-made sidecars."""

from functools import cache
from pathlib import Path

import pytest

from benchmarks.scoring import is_unmarked, score
from benchmarks.truth import read_truth
from stepbot.diagnostics import Diagnostics
from stepbot.draft.contacts.survey import Sources
from stepbot.draft.draft import OriginForm
from stepbot.draft.draft_robot import infer
from stepbot.draft.inference import infer_mechanism
from stepbot.step.assembly import Assembly, MeshTolerance, ReadOptions
from stepbot.step.reader import read_assembly


@cache
def read(step: Path) -> Assembly:
    """An assembly with its faces, meshed coarsely."""
    diagnostics = Diagnostics()
    options = ReadOptions(tolerance=MeshTolerance(relative=0.05, angle=0.8), faces=True)
    assembly = read_assembly(step, options, diagnostics)
    assert assembly is not None, list(diagnostics)
    return assembly


@pytest.mark.slow
@pytest.mark.parametrize(
    ("step", "truth", "joints"),
    [
        ("simple_pendulum", "simple_pendulum", 1),
        ("two_joint_servo_arm_ap242", "two_joint", 2),
        pytest.param("openarm_leader_gripper", "openarm_leader_gripper", 7, marks=pytest.mark.long),
    ],
)
def test_all_joints_of_real_assemblies(corpus: Path, step: str, truth: str, joints: int) -> None:
    """All joints have the right type, axis and sides, none is wrong, and the volume is in the right links."""
    assembly = read(corpus / f"{step}.step")
    result = score(infer_mechanism(assembly), read_truth(corpus / "joints" / f"{truth}.robot.yaml", assembly))
    assert (result.true, result.found, result.wrong) == (joints, joints, [])
    assert result.volume > 0.98
    assert result.root


@pytest.mark.long
def test_loops_of_a_gripper_are_cut_at_bearings(corpus: Path) -> None:
    """The motor's joint is in the tree, both closures are at bearings, and their origins are the bearings' axes."""
    draft = infer(read(corpus / "openarm_leader_gripper.step"), "gripper")
    (driven,) = (joint for joint in draft.joints if "DM-J4310" in joint.confidence.evidence[0])
    assert driven.parent == draft.root
    at_bearings = [one for one in (*draft.joints, *draft.closures) if "bearing" in one.confidence.evidence[0]]
    assert len(at_bearings) == 4
    assert set(draft.closures) < set(at_bearings)
    for one in at_bearings:
        assert one.origin.form == OriginForm.AXIS_OF
        assert one.origin.paths[0].startswith("mr126zz:")


@pytest.mark.slow
@pytest.mark.parametrize(
    "step",
    [
        pytest.param(step, marks=pytest.mark.xdist_group(step))
        for step in ("as1-oc-214", "dm1_ideas_inch", "s1_autocad_foot", "eight_cylinders_multi_root")
    ],
)
@pytest.mark.parametrize("sources", [Sources(), Sources(names=False), Sources(names=False, tree=False)])
def test_no_unmarked_joint_where_there_is_no_robot(corpus: Path, step: str, sources: Sources) -> None:
    """Brackets, a foot and loose cylinders have no joint without a mark."""
    inferred = infer_mechanism(read(corpus / f"{step}.step"), sources)
    assert not [arc.evidence.why for arc in inferred.arcs if is_unmarked(arc)]


@pytest.mark.slow
@pytest.mark.parametrize("step", ["as1-oc-214", "box_sides_inch", "dm1_ideas_inch", "eight_cylinders_multi_root"])
def test_no_joint_is_drafted_where_nothing_moves(corpus: Path, step: str) -> None:
    """Brackets, boxes, a clamp and loose cylinders: all is fixed, and the draft says why."""
    draft = infer(read(corpus / f"{step}.step"), step)
    assert not [
        joint.name for joint in (*draft.joints, *draft.closures) if joint.confidence.is_chosen and joint.type != "fixed"
    ]
    assert draft.notes[0].startswith("no moving parts found: ")
