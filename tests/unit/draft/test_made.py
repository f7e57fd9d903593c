"""Drawn mechanisms of several kinds and styles: all joints are found, none is invented, none is wrong without a mark.

``python -m tests.made`` draws more of them, and those that no rule was set on.
"""

import pytest

from stepbot.draft.draft_robot import infer
from tests.assembled import assembled, part
from tests.made.kinds import ASIDE, ASIDE_BOUGHT, ASIDE_LATER, ASIDE_LATEST, KINDS, VARIED
from tests.made.scored import drawn, scored
from tests.solids import box, cylinder

_DRAWN = (
    ("wheeled", 0),  # four wheels of rim and tyre, motors in clamps
    ("wheeled", 3),  # the same without names
    ("slider_crank", 0),  # a piston between guides, a pin that stands on the base
    ("slider_crank", 5),
    ("gear_gripper", 0),  # one half is like the other, mirrored
    ("quadruped", 0),  # one leg is placed 0.36 mm off
    ("telescope", 0),
    ("telescope", 1),  # with clearance
    ("profile_rail", 0),
    ("walker", 0),
    ("hinged_lid", 0),
    ("excavator", 0),  # a cylinder that slides in a loop
    ("forked_wheels", 2),  # wheels between the cheeks of forks, in Spanish
    ("forked_wheels", 3),  # forks and wheels of casters in subassemblies
    ("turntable", 0),  # two rings of one bearing, each bolted to something else
    ("turntable", 2),  # a column off the axis of a round table
    ("side_by_side", 2),  # three fingers on one pin
    ("side_by_side", 4),  # pins with the clearance of a screw's hole
    ("neck", 3),  # balls in a chain
    ("rocker_bogie", 1),
    ("drawers", 2),  # profiles in profiles, with play to the sides
    ("stage", 0),  # blocks without clearance in one subassembly with their rail, and a screw in a nut
    ("corexy", 2),  # blocks on rails in imports, each with parts of several links
    ("rack_gripper", 0),
    ("dovetail_stage", 1),  # flanks that are not across each other
    ("knee_brace", 1),  # clevis pins with washers and circlips
    ("coaxial_legs", 0),  # a thigh between two actuators on one line, each a disc in the end of a housing
    ("coaxial_legs", 1),  # flanges turned less than what they carry, so that their holes are not in line
    ("hub_drive", 5),  # casters: wheels on axles of their own, forks that trail
)
_LOOKED_AT = frozenset({"hinged_lid", "drawers", "stage", "coaxial_legs", "hub_drive"})
"""Set aside once, until a rule was set on them."""


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seed"), _DRAWN)
def test_joints_of_drawn_mechanisms_are_found(kind: str, seed: int) -> None:
    """Every joint is found, on its line and between its links."""
    result = scored(drawn(kind, seed))
    assert (result.found, result.unmarked, result.reviewed, result.notes) == (result.true, 0, 0, [])
    assert result.volume > 0.98


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
    assert not (ASIDE | ASIDE_LATER | ASIDE_BOUGHT | ASIDE_LATEST) & {kind for kind, _ in _DRAWN} - _LOOKED_AT


def test_a_bound_that_cuts_the_search_short_is_noted() -> None:
    """Of more equal parts than the bound, joints are not carried over, and the draft says so."""
    pin, seat = cylinder(4, 20), box(20, 20, 10) - cylinder(4.1, 10).at(0, 0, -5)
    crank = pin + box(36, 12, 5).at(12, 0, 22.5)
    nodes = [part("plate", box(40 * 62, 60, 10), 40 * 30.5, 0, -10)]
    for n in range(61):
        nodes += [part(f"seat {n}", seat, 40 * n, 0, 0), part(f"crank {n}", crank, 40 * n, 0, -5)]
    notes = infer(assembled(*nodes), "cranks").notes
    assert [note for note in notes if "more than 60 equal parts" in note]
