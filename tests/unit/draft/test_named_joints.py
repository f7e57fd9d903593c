"""Drafts from joints that names in the STEP state, after the convention of urdf_from_step."""

from math import pi
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.draft import Draft
from stepbot.draft.named_joints import draft_of_names
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.model import JointKind
from tests.unit.assemble.workshop import Workshop, at
from tests.unit.draft.test_sidecar_text import built

UPWARDS = at(0, 0, 50, (0, -pi / 2, 0))
"""x of the frame of a joint is z of the assembly."""
MARKS = (
    ("joint_base_", "fixed", IDENTITY),
    ("joint_base_to_upper_arm_", "revolute v2", UPWARDS),
    ("joint_upper_arm_to_hand_left", "prismatic (1)", at(0, 40, 60)),
    ("joint_hand_to_tip_", "fixed", at(5, 40, 60, (0, 0, pi / 2))),
    ("joint_base_to_dial_", "continuous", at(30, 0, 0)),
)


def shop(marks: tuple[tuple[str, str, Pose], ...] = MARKS, without: str = "") -> Workshop:
    """A column with an arm of two parts, a hand on it and a dial, and the frames of their joints."""
    made = Workshop()
    for name, place in (
        ("column", at(0, 0, 20)),
        ("link_upper_arm_", at(0, 20, 60)),
        ("link_upper_arm_cover", at(0, 30, 60)),
        ("link_hand_", at(0, 50, 60)),
        ("link_dial_", at(30, 0, 0)),
    ):
        if name != without:
            made.box(name, X_PC=place, density=1000.0)
    folder = made.group("URDF frames")
    for name, kind, place in marks:
        mark = made.group(name, folder, place)
        made.box(kind, (5, 5, 5), parent=mark, density=1000.0)
    return made


def drafted(made: Workshop) -> Draft:
    """The draft, which must be one."""
    draft, why = draft_of_names(made.assembly, "robot")
    assert draft is not None, why
    return draft


def test_joints_are_those_that_names_state(tmp_path: Path) -> None:
    """Types, links and axes are those of the convention: x of each frame. A link with a frame alone is a frame."""
    draft = drafted(shop())
    kinds = {joint.child: (joint.parent, joint.type) for joint in draft.joints}
    assert kinds == {
        "upper_arm": ("base", JointKind.REVOLUTE),
        "hand": ("upper_arm", JointKind.PRISMATIC),
        "dial": ("base", JointKind.CONTINUOUS),
    }
    limited = tuple(replace(joint, limits=None) for joint in draft.joints)
    robot, _ = built(replace(draft, joints=limited), tmp_path, shop())
    axes = {joint.child: joint.X_PC.turn(joint.axis) for joint in robot.joints}
    np.testing.assert_allclose(axes["upper_arm"], [0, 0, 1], atol=1e-12)
    tip = next(frame for frame in robot.frames if frame.name == "tip")
    assert tip.link == "hand"
    np.testing.assert_allclose(tip.X_LF.p, [0.005, 0, 0], atol=1e-12)


def test_marks_are_no_parts_of_the_robot(tmp_path: Path) -> None:
    """They have neither mass nor geometry; the base has what no name claims."""
    robot, _ = built(drafted(shop()), tmp_path, shop())
    masses = {link.name: link.mass_properties.mass for link in robot.links}
    assert masses == pytest.approx({"base": 1e-3, "upper_arm": 2e-3, "hand": 1e-3, "dial": 1e-3})


def test_a_moving_link_without_parts_is_reported() -> None:
    """Nothing is drafted of names then, and the reason is given."""
    draft, why = draft_of_names(shop(without="link_hand_").assembly, "robot")
    assert draft is None
    assert why == "joints named in 'URDF frames' were ignored: no parts link_NAME_ for hand"


def test_joints_are_at_their_frames_wherever_their_links_are() -> None:
    """Also where the parts of both links have one frame that is not the assembly's."""
    made = Workshop()
    for name in ("column", "link_upper_arm_"):
        made.box(name, X_PC=at(100, 0, 20, (0, 0, pi / 2)), density=1000.0)
    mark = made.group("joint_base_to_upper_arm_", made.group("urdf"), UPWARDS)
    made.box("revolute", (5, 5, 5), parent=mark, density=1000.0)
    (joint,) = drafted(made).joints
    np.testing.assert_allclose(joint.point, [0, 0, 0.05], atol=1e-12)
    np.testing.assert_allclose(joint.direction, [0, 0, 1], atol=1e-12)


def test_a_joint_without_a_known_type_is_reported() -> None:
    """No joint is left out in silence: all are inferred then."""
    marks = (*MARKS[:-1], ("joint_base_to_dial_", "welded", IDENTITY))
    assert draft_of_names(shop(marks).assembly, "robot") == (
        None,
        "joints named in 'URDF frames' were ignored: no part named fixed, revolute, continuous, prismatic in"
        " 'joint_base_to_dial_'",
    )


@pytest.mark.parametrize("marks", [(), (("urdf logo", "plate", IDENTITY),)])
def test_other_subassemblies_state_nothing(marks: tuple[tuple[str, str, Pose], ...]) -> None:
    """A subassembly of that name without such parts is one like any other."""
    assert draft_of_names(shop(marks).assembly, "robot") == (None, "")
