"""Subassemblies as links."""

from stepbot.draft.contacts.survey import ALL_SOURCES, Sources, Survey
from stepbot.draft.evidence.subassemblies import Structure
from tests.assembled import Node, assembled, group, part
from tests.solids import box

BLOCK = box(40, 40, 10)


def structure(*nodes: Node, sources: Sources = ALL_SOURCES, moving: set[tuple[int, int]] | None = None) -> Structure:
    """The subassemblies that look like links."""
    return Structure(Survey(assembled(*nodes), sources), moving or set())


def two(name: str, x: float) -> Node:
    """A subassembly of two blocks in contact."""
    return group(name, part("lower", BLOCK, x), part("upper", BLOCK, x, 0, 10))


def test_parts_of_a_subassembly_are_together() -> None:
    """Parts of one subassembly are together, those of two are across; a loose part is in neither."""
    found = structure(two("a", 0), two("b", 100), part("loose", BLOCK, 200))
    assert found.are_together(2, 3)
    assert found.are_across(2, 5)
    assert found.are_across(2, 7)
    assert not found.are_together(2, 5)


def test_subassembly_with_a_joint_inside_is_no_link() -> None:
    """A joint between two parts of a subassembly divides it."""
    found = structure(two("a", 0), two("b", 100), moving={(2, 3)})
    assert not found.are_together(2, 3)
    assert found.are_together(5, 6)


def test_without_the_tree_there_are_no_groups() -> None:
    """If the tree does not count, no parts are together or across."""
    found = structure(two("a", 0), two("b", 100), sources=Sources(tree=False))
    assert (found.groups, found.link_of) == ([], {})
    assert not found.are_across(2, 5)
