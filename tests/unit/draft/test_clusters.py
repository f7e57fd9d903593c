"""Disjoint sets with pairs that must stay apart."""

from stepbot.draft.parts.clusters import Clusters


def test_what_is_kept_apart_stays_apart_through_joins() -> None:
    """A joint between two parts separates everything that is joined to them later."""
    found = Clusters(range(5))
    assert found.forbid(0, 1)
    assert found.join(0, 2)
    assert found.join(1, 3)
    assert found.are_apart(2, 3)
    assert not found.join(2, 3)
    assert found.groups() == {0: [0, 2], 1: [1, 3], 4: [4]}


def test_a_joint_inside_one_body_is_refused() -> None:
    """Two parts of one set cannot be separated."""
    found = Clusters(range(2))
    assert found.join(0, 1)
    assert not found.forbid(0, 1)


def test_what_is_allowed_again_can_be_joined() -> None:
    """A removed joint no longer separates its sides."""
    found = Clusters(range(2))
    found.forbid(0, 1)
    found.allow(0, 1)
    assert found.join(0, 1)
    assert found.members(1) == [0, 1]
