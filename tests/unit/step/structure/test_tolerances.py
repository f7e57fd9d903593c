"""Tolerances of links: the nearest claim applies to a component, the finest to a body."""

from stepbot.step.assembly import Component, MeshTolerance, ReadOptions
from stepbot.step.structure.repetition import definition_tolerances

COARSE, FINE, FINEST = MeshTolerance(0.01), MeshTolerance(0.001), MeshTolerance(absolute=1e-6)
COMPONENTS = (
    Component(0, -1, ".", ".", "arm", "", 1),
    Component(1, 0, "motor", "motor", "motor", "motor:1", 1),
    Component(2, 1, "horn", "motor/horn", "horn", "horn:1", 1, body=0),
    Component(3, 1, "case", "motor/case", "case", "case:1", 1, body=1),
    Component(4, 0, "horn", "horn", "horn", "horn:2", 1, body=0),
)


def tolerances(*claims: tuple[str, MeshTolerance]) -> list[tuple[MeshTolerance, ...]]:
    """The tolerances of the bodies of the assembly above."""
    return definition_tolerances(COMPONENTS, [0, 1], ReadOptions(tolerance=COARSE, tolerance_of=claims))


def test_without_claims_the_default_holds() -> None:
    """Without claims every body has the default tolerance."""
    assert tolerances() == [(COARSE,), (COARSE,)]


def test_a_claim_holds_for_all_below_and_the_nearest_wins() -> None:
    """A link that claims a subassembly refines its parts, except those claimed separately."""
    assert tolerances(("motor", FINE)) == [(FINE, COARSE), (FINE,)]
    assert tolerances(("motor", FINE), ("motor/case", FINEST)) == [(FINE, COARSE), (FINEST,)]


def test_patterns_that_name_nothing_are_for_others_to_report() -> None:
    """A pattern without a match is ignored here, and reported elsewhere."""
    assert tolerances(("no such part", FINE)) == [(COARSE,), (COARSE,)]
