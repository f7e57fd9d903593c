"""Drawn mechanisms are drafted from descriptions of them: parts in their links, joints on their lines and as drawn."""

from random import Random

import numpy as np
import pytest

from stepbot.draft.draft import DraftJoint
from stepbot.draft.from_description.drafted import draft_of_description
from stepbot.robot.model import JointKind
from tests.made.described import description_of
from tests.made.kit import SCREWS
from tests.made.scored import drawn

FOUND = (
    ("pan_tilt", 1),
    ("quadruped", 0),
    ("telescope", 1),
    ("cheek_quadruped", 1),
    ("side_by_side", 1),
    ("excavator", 1),
    ("knee_brace", 0),
    ("dovetail_stage", 1),
)
"""Kinds and seeds whose links all have a shape that is no other's."""


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seed"), FOUND)
def test_a_description_is_found_in_its_assembly(kind: str, seed: int) -> None:
    """Frames are turned at random and joints are drawn off their zeros; limits are those of the description."""
    kit = drawn(kind, seed)
    assembly, link_of = kit.assembly(is_meshed=True)
    description, positions = description_of(kit, assembly, link_of, Random(f"{kind}{seed}"))
    draft = draft_of_description(description, assembly, kind, "drawn.urdf")
    assert draft is not None
    found = {assembly.components[i].path: link.name for link in draft.links for i in link.components}
    assert {path: found[path] for path, link in link_of.items() if link != SCREWS} == {
        path: link for path, link in link_of.items() if link != SCREWS
    }
    assert len(draft.joints) == len(positions)
    assert len(draft.joints) + len(draft.closures) == len(kit.joints)
    for joint in (*draft.joints, *draft.closures):
        ends = {joint.parent, joint.child} if isinstance(joint, DraftJoint) else {joint.link_a, joint.link_b}
        true = next(one for one in kit.joints if {one.a, one.b} == ends)
        assert joint.type == true.kind
        assert joint.direction is not None
        assert abs(np.dot(joint.direction, true.direction)) == pytest.approx(1.0, abs=1e-9)
        if joint.type is not JointKind.PRISMATIC:
            assert np.linalg.norm(np.cross(np.array(joint.point) - true.point, true.direction)) < 1e-7
    for joint in draft.joints:
        assert joint.zero == pytest.approx(positions[joint.child], abs=1e-5)
        assert joint.limits is not None
        assert (joint.limits.lower, joint.limits.upper) == pytest.approx((joint.zero - 0.5, joint.zero + 0.5), abs=1e-5)
