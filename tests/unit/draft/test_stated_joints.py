"""Drafts from the kinematic pairs of a STEP file."""

from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.draft import Draft
from stepbot.draft.stated_joints import draft_of_mechanism
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import JointKind
from stepbot.step.exchange.mechanisms import KinematicLink, KinematicPair, Mechanism, Occurrence
from tests.unit.assemble.workshop import Workshop, at
from tests.unit.draft.test_sidecar_text import built

ON_BASE, ON_ARM = Pose(position=(45.0, 5.0, 0.0)), Pose(position=(-5.0, 5.0, 0.0))
"""[mm]; they coincide where the arm is drawn, 50 mm along x."""
HINGE = KinematicPair("hinge", "REVOLUTE_PAIR", (0, 1), (ON_BASE, ON_ARM), (5,), True)
LINKS = (KinematicLink("base"), KinematicLink("arm"))


def shop() -> Workshop:
    """A base, and an arm 50 mm from it."""
    made = Workshop()
    made.box("base")
    made.box("arm", X_PC=at(50, 0, 0))
    return made


def drafted(*pairs: KinematicPair, links: tuple[KinematicLink, ...] = LINKS, base: int | None = 0) -> Draft:
    """The draft of some pairs; parts have a placeholder density."""
    draft = draft_of_mechanism(Mechanism(links, pairs, base), shop().assembly, "robot")
    assert draft is not None
    return replace(draft, without_density=("",))


@pytest.mark.parametrize(
    ("dofs", "kind"),
    [
        ((5,), JointKind.CONTINUOUS), ((2,), JointKind.PRISMATIC), ((0,), JointKind.PRISMATIC),
        ((2, 5), JointKind.CYLINDRICAL), ((3, 4, 5), JointKind.BALL), ((0, 1, 5), JointKind.PLANAR),
        ((3, 5), JointKind.UNIVERSAL), ((), JointKind.FIXED), ((0, 1, 2, 3, 4, 5), JointKind.FLOATING),
    ],
)  # fmt: skip
def test_every_kind_of_pair_is_built(dofs: tuple[int, ...], kind: JointKind, tmp_path: Path) -> None:
    """The degrees of freedom of a pair determine the kind of its joint; the sidecar builds without a mark."""
    draft = drafted(replace(HINGE, dofs=dofs))
    assert not any(joint.is_reviewed for joint in draft.joints)
    assert draft.joints[0].confidence.score == 1.0
    robot, _ = built(draft, tmp_path, shop())
    (joint,) = robot.joints
    assert joint.kind is kind
    assert joint.X_PC.p == pytest.approx([0.045, 0.005, 0.0])
    if dofs == (0,):
        assert joint.axis == (1.0, 0.0, 0.0)
    if dofs == (3, 5):
        assert (joint.axis, joint.axis2) == ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def test_screw_keeps_its_pitch(tmp_path: Path) -> None:
    """A pitch in the file's length unit per turn is converted to metres per radian."""
    screw = replace(HINGE, kind="SCREW_PAIR", dofs=(2, 5), pitch=2.0, is_stated=False)
    joint = built(drafted(screw), tmp_path, shop())[0].joints[0]
    assert (joint.kind, joint.pitch) == (JointKind.SCREW, pytest.approx(0.002 / (2 * pi)))


def test_range_and_drawn_position_count_from_the_pair_s_own_zero(tmp_path: Path) -> None:
    """If the second placement is drawn rotated by 0.3, the joint is drawn at 0.3, within the file's range."""
    turned = Pose.of([[cos(0.3), -sin(0.3), 0], [sin(0.3), cos(0.3), 0], [0, 0, 1]], ON_ARM.position)
    pair = replace(HINGE, placements=(ON_BASE, turned), bounds=(-1.5, 0.5))
    joint = built(drafted(pair), tmp_path, shop())[0].joints[0]
    assert joint.kind is JointKind.REVOLUTE
    assert (joint.limit.lower, joint.limit.upper) == pytest.approx((-1.5, 0.5), abs=1e-9)
    assert joint.drawn_position == pytest.approx(0.3, abs=1e-9)


def test_slider_drawn_away_from_zero(tmp_path: Path) -> None:
    """The drawn position of a slider is the distance between its placements, and its range is a length."""
    away = Pose(position=(-5.0, 5.0, 7.5))
    pair = replace(HINGE, kind="PRISMATIC_PAIR", dofs=(2,), placements=(ON_BASE, away), bounds=(-10.0, 30.0))
    joint = built(drafted(pair), tmp_path, shop())[0].joints[0]
    assert (joint.limit.lower, joint.limit.upper, joint.drawn_position) == pytest.approx((-0.01, 0.03, 0.0075))


def test_joint_is_turned_round_where_the_base_is_the_second_link(tmp_path: Path) -> None:
    """From the second link on, the motion is about the opposite axis, with the same range."""
    pair = replace(HINGE, bounds=(-1.5, 0.5))
    joint = built(drafted(pair, base=1), tmp_path, shop())[0].joints[0]
    assert (joint.parent, joint.child, joint.axis) == ("arm", "base", (0.0, 0.0, -1.0))
    assert (joint.limit.lower, joint.limit.upper) == pytest.approx((-1.5, 0.5), abs=1e-9)


def test_drawn_position_outside_of_the_range_is_reviewed(tmp_path: Path) -> None:
    """A drawn position outside the range is marked, and the sidecar still builds."""
    draft = drafted(replace(HINGE, bounds=(0.5, 1.0)))
    assert "range" in draft.joints[0].review
    _, found = built(draft, tmp_path, shop())
    assert [one.code for one in found] == ["SB463", "SB522"]


def test_placements_in_the_frame_of_the_assembly_are_taken_as_such() -> None:
    """Placements in the assembly's frame are not moved by their components."""
    (joint,) = drafted(replace(HINGE, placements=(ON_BASE, ON_BASE))).joints
    assert joint.point == pytest.approx((0.045, 0.005, 0.0))
    assert not joint.is_reviewed


def test_placements_that_do_not_meet_are_reviewed() -> None:
    """Two placements whose axes do not intersect are marked for review."""
    (joint,) = drafted(replace(HINGE, placements=(ON_BASE, Pose(position=(-5.0, 6.0, 0.0))))).joints
    assert "do not coincide" in joint.review
    assert not joint.confidence.is_sure


def test_direction_that_the_file_leaves_out_is_reviewed() -> None:
    """A slider without flags has the direction of the standard, and is marked for review."""
    (joint,) = drafted(replace(HINGE, kind="PRISMATIC_PAIR", dofs=(0,), is_stated=False)).joints
    assert "standard" in joint.review


def test_second_way_round_is_a_closure(tmp_path: Path) -> None:
    """A pair between links that are already connected is a closure."""
    second = replace(HINGE, name="again", placements=(ON_BASE, ON_ARM))
    draft = drafted(replace(HINGE, bounds=(-1.0, 1.0)), replace(second, bounds=(-1.0, 1.0)))
    assert [closure.name for closure in draft.closures] == ["again"]
    assert built(draft, tmp_path, shop())[0].closures[0].kind is JointKind.REVOLUTE


def test_link_that_no_pair_connects_is_held_by_the_base(tmp_path: Path) -> None:
    """Two mechanisms in one file become one tree, with a mark at the added joint."""
    made = shop()
    made.box("table", X_PC=at(0, 80, 0))
    made.box("lid", X_PC=at(0, 80, 20))
    lid = KinematicPair("lid", "REVOLUTE_PAIR", (2, 3), (Pose(), Pose(position=(0.0, 0.0, -20.0))), (5,), True)
    links = (*LINKS, KinematicLink("table"), KinematicLink("lid"))
    draft = draft_of_mechanism(Mechanism(links, (HINGE, lid), 0), made.assembly, "robot")
    assert draft is not None
    robot, _ = built(replace(draft, without_density=("",)), tmp_path, made)
    assert {(j.parent, j.child): j.kind for j in robot.joints} == {
        ("base", "arm"): JointKind.CONTINUOUS, ("base", "table"): JointKind.FIXED,
        ("table", "lid"): JointKind.CONTINUOUS,
    }  # fmt: skip


def test_occurrences_that_links_refer_to_count_before_names() -> None:
    """Links are bound to components by the usages in the file before names."""
    links = (KinematicLink("", (Occurrence("robot", "arm", 1),)), KinematicLink("x", (Occurrence("robot", "base", 1),)))
    draft = drafted(replace(HINGE, placements=(ON_ARM, ON_BASE)), links=links, base=1)
    assert [(link.name, link.parts, link.rest) for link in draft.links] == [("x", (), True), ("arm", ("arm",), False)]


def test_links_that_are_no_components_make_no_draft() -> None:
    """Links that match no component are not drafted."""
    mechanism = Mechanism((KinematicLink("base"), KinematicLink("nowhere")), (HINGE,), 0)
    assert draft_of_mechanism(mechanism, shop().assembly, "robot") is None
    several = Workshop()
    several.box("base")
    first = several.box("arm")
    several.again(first, at(0, 0, 5))
    assert draft_of_mechanism(Mechanism(LINKS, (HINGE,), 0), several.assembly, "robot") is None


def test_turned_components_turn_the_axis(tmp_path: Path) -> None:
    """Placements are in the frames of their components, in any orientation."""
    made = Workshop()
    made.box("base", X_PC=at(0, 0, 0, (pi / 2, 0, 0)))
    made.box("arm", X_PC=at(50, 0, 0, (pi / 2, 0, 0)))
    draft = draft_of_mechanism(Mechanism(LINKS, (HINGE,), 0), made.assembly, "robot")
    assert draft is not None
    joint = built(replace(draft, without_density=("",)), tmp_path, made)[0].joints[0]
    assert np.allclose(joint.X_PC.turn(joint.axis), [0.0, -1.0, 0.0])
    assert joint.X_PC.p == pytest.approx([0.045, 0.0, 0.005])
