"""The root link."""

from tests.assembled import BARE, Node, inferred, links, part
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


def test_heavy_trunk_is_the_root_before_a_hub_with_more_joints() -> None:
    """A plate of three joints is the root, not the hub below it, which has six and half of its volume."""
    bore = cylinder(5.05, 10).at(0, 0, -5)
    lever = box(40, 15, 10).at(15, 0, 0) - bore
    at_plate, at_hub = (
        [(-120.0, 0.0), (120.0, 0.0)],
        [(-50.0, y) for y in (-40.0, 40.0)] + [(50.0, y) for y in (-40.0, 0.0, 40.0)],
    )
    plate, hub = box(300, 200, 20).at(0, 0, 10), box(150, 110, 40) - cylinder(5.05, 40).at(0, 0, -20)
    for x, y in [*at_plate, (0.0, 0.0)]:
        plate += cylinder(5, 13).at(x, y, -13)
    for x, y in at_hub:
        hub += cylinder(5, 13).at(x, y, -33)
    levers = [part(f"lever {x} {y}", lever, x=x, y=y, z=z) for z, at in ((-7, at_plate), (-49, at_hub)) for x, y in at]
    found = inferred(part("plate", plate), part("hub", hub, z=-22), *levers, sources=BARE)
    assert len(links(found)) == 9
    assert links(found)[found.root] == {"plate"}
