"""Scores of joint inference count correct and wrong joints."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from benchmarks.scoring import score
from benchmarks.truth import Truth, read_truth
from stepbot.diagnostics import Diagnostics
from stepbot.draft.inference import InferredMechanism, infer_mechanism
from stepbot.robot.model import JointKind
from stepbot.step.assembly import ReadOptions
from stepbot.step.reader import read_assembly

FOUR_BAR = Path(__file__).parents[2] / "robot_library" / "stepbot_four_bar"


@pytest.fixture(scope="module")
def four_bar() -> tuple[InferredMechanism, Truth]:
    """The inferred and the true robot of the four-bar."""
    diagnostics = Diagnostics()
    assembly = read_assembly(FOUR_BAR / "four_bar.step", ReadOptions(faces=True), diagnostics)
    assert assembly is not None, list(diagnostics)
    return infer_mechanism(assembly), read_truth(FOUR_BAR / "four_bar.robot.yaml", assembly)


@pytest.mark.slow
def test_all_right(four_bar: tuple[InferredMechanism, Truth]) -> None:
    """The four joints of a four-bar, one of them a closure, count as found."""
    result = score(*four_bar)
    assert (result.true, result.found, result.seen, result.wrong, result.root) == (4, 4, 4, [], True)
    assert result.volume == pytest.approx(1.0)
    assert (result.exact, result.undrawn) == (4, 0)


def test_an_axis_2_micrometres_off_is_found_and_not_exact(four_bar: tuple[InferredMechanism, Truth]) -> None:
    """A reference beside the axis that the faces of both links have is not drawn; its joint is found, not exactly."""
    inferred, truth = four_bar
    moved = [replace(truth.joints[0], point=truth.joints[0].point + 2e-6), *truth.joints[1:]]
    result = score(inferred, replace(truth, joints=moved))
    assert (result.found, result.exact, result.undrawn) == (4, 3, 1)


def test_a_wrong_type_is_wrong_and_seen(four_bar: tuple[InferredMechanism, Truth]) -> None:
    """A hinge drafted as a slide counts as wrong, not as found; its axis counts as found."""
    inferred, truth = four_bar
    inferred.arcs[0].evidence.type = JointKind.PRISMATIC
    try:
        result = score(inferred, truth)
    finally:
        inferred.arcs[0].evidence.type = JointKind.REVOLUTE
    assert (result.found, result.seen, len(result.wrong)) == (3, 4, 1)


@pytest.mark.slow
def test_a_link_torn_apart_loses_volume(four_bar: tuple[InferredMechanism, Truth]) -> None:
    """Parts in the wrong link count by their volume."""
    inferred, truth = four_bar
    moved = inferred.links[0].pop()
    inferred.links[1].append(moved)
    try:
        result = score(inferred, truth)
    finally:
        inferred.links[0].append(inferred.links[1].pop())
    assert result.volume < 1.0 - 1e-6
