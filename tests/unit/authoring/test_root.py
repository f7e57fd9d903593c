"""The root link."""

from tests.assembled import Node, inferred, links, part
from tests.solids import box, cylinder

BORED = box(120, 40, 20).at(40, 0, 15) - cylinder(10.02, 20).at(0, 0, 5)
"""5 mm above z = 0."""


def hinge(lower: str, upper: str, *, heavy_above: bool = False) -> set[str]:
    """The root of two subassemblies that turn on each other, one above the other."""
    block = box(80, 80, 20).at(0, 0, -10) + cylinder(10, 25)
    arm = BORED + (box(200, 200, 100).at(120, 0, 75) if heavy_above else box(20, 20, 10).at(90, 0, 30))
    nodes = [Node(lower, children=[part("block", block)]), Node(upper, children=[part("arm", arm)])]
    found = inferred(*nodes)
    return links(found)[found.root]


def test_named_base_is_the_root() -> None:
    """A link with a part named a base is the root, even if it is lighter and above."""
    assert hinge("a", "base") == {"base/arm"}
    assert hinge("base", "b", heavy_above=True) == {"base/block"}


def test_larger_and_lower_link_is_the_root() -> None:
    """Without names the larger one, if it is not far above, is the root."""
    assert hinge("a", "b") == {"a/block"}
