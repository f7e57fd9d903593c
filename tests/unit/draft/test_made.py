"""Drawn mechanisms of several kinds and styles: all joints are found, none is invented, none is wrong without a mark.

``python -m tests.made`` draws more of them, and those that no rule was set on.
"""

import pytest

from stepbot.draft import draft_robot
from stepbot.draft.answers import Facts
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.draft_robot import infer
from stepbot.draft.inference import InferredMechanism, infer_from
from tests.assembled import assembled, part
from tests.made.kinds import ASIDE, ASIDE_BOUGHT, ASIDE_LATER, ASIDE_LATEST, KINDS, VARIED
from tests.made.recorded import DRAFTED, draft_text, recorded
from tests.made.scored import compared, drawn, scored
from tests.solids import box, cylinder

_LOOKED_AT = frozenset({"hinged_lid", "drawers", "stage", "coaxial_legs", "hub_drive"})
"""Set aside once, until a rule was set on them."""


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seed"), DRAFTED)
def test_joints_of_drawn_mechanisms_are_found(kind: str, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every joint is found, on its line and between its links, and the draft reads as it was recorded.

    After a change of a rule, `python -m tests.made --record` shows in the difference of `drafts.txt` what it changes.
    """
    inferred: list[InferredMechanism] = []

    def infer_once(survey: Survey, facts: Facts) -> InferredMechanism:
        inferred.append(infer_from(survey, facts))
        return inferred[-1]

    monkeypatch.setattr(draft_robot, "infer_from", infer_once)
    kit = drawn(kind, seed)
    assembly, by_path = kit.assembly()
    text = draft_text(assembly, kind)
    result = compared(kit, inferred[-1], by_path)
    assert (result.found, result.unmarked, result.reviewed, result.notes) == (result.true, 0, 0, [])
    assert result.volume > 0.98
    assert text == recorded()[f"{kind} {seed}"]


@pytest.mark.parametrize(
    ("kind", "seed"), [("frame", 0), ("frame", 1), ("frame", 2), ("tube_stand", 2), ("tube_stand", 5)]
)
def test_a_frame_has_no_joint(kind: str, seed: int) -> None:
    """Posts, beams and screwed plates, or tubes in clamps: nothing moves."""
    assert scored(drawn(kind, seed)).notes == []


def test_a_third_of_the_kinds_is_set_aside() -> None:
    """What is tested here is not what is looked at once."""
    assert len(ASIDE) * 3 == len(KINDS) - len(VARIED)
    assert (len(ASIDE_LATER), len(ASIDE_BOUGHT)) == (4, 3)
    assert not (ASIDE | ASIDE_LATER | ASIDE_BOUGHT | ASIDE_LATEST) & {kind for kind, _ in DRAFTED} - _LOOKED_AT


def test_a_bound_that_cuts_the_search_short_is_noted() -> None:
    """Of more equal parts than the bound, joints are not carried over, and the draft says so."""
    pin, seat = cylinder(4, 20), box(20, 20, 10) - cylinder(4.1, 10).at(0, 0, -5)
    crank = pin + box(36, 12, 5).at(12, 0, 22.5)
    nodes = [part("plate", box(40 * 62, 60, 10), 40 * 30.5, 0, -10)]
    for n in range(61):
        nodes += [part(f"seat {n}", seat, 40 * n, 0, 0), part(f"crank {n}", crank, 40 * n, 0, -5)]
    notes = infer(assembled(*nodes), "cranks").notes
    assert [note for note in notes if "more than 60 equal parts" in note]
