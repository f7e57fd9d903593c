"""The strength of a draft's evidence."""

import pytest

from stepbot.draft.draft import CHOSEN, SURE, Confidence, DraftJoint, OriginForm, OriginSnippet
from stepbot.robot.model import JointKind


def joint(score: float, review: str = "") -> DraftJoint:
    """A hinge with a score and review notes."""
    origin = OriginSnippet(OriginForm.MATE, ("a", "b"))
    place = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    return DraftJoint(
        "hinge",
        JointKind.REVOLUTE,
        origin,
        "z",
        *place,
        Confidence(score, ("a shaft in a bore",)),
        ("a", "b"),
        (),
        review,
    )


@pytest.mark.parametrize(
    ("score", "sure", "chosen"), [(SURE, True, True), (0.79, False, True), (CHOSEN - 0.01, False, False)]
)
def test_scores_sort_joints_into_three_kinds(score: float, sure: bool, chosen: bool) -> None:
    """A joint from 0.8 has no mark, one below has a mark, one below 0.5 is not drafted."""
    found = joint(score)
    assert (found.confidence.is_sure, found.confidence.is_chosen, found.is_reviewed) == (sure, chosen, not sure)


def test_a_reason_to_review_marks_even_a_sure_joint() -> None:
    """A joint with a review note is marked at any score."""
    assert joint(0.95, "could also be revolute").is_reviewed
