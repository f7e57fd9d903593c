"""Pairs of equal parts that are placed alike are looked at once: each has what it has alone."""

from collections.abc import Iterator

import numpy as np
import pytest

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.inference import infer_mechanism
from stepbot.draft.parts.parts import Boxes
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array
from tests.assembled import Node, assembled, part
from tests.solids import box, cylinder

PLATE = box(60, 40, 10) - cylinder(6, 10).at(15, 0, -5)
PIN = cylinder(5.9, 30).at(0, 0, -15) + cylinder(10, 4).at(0, 0, 5)
CHANNEL = box(30, 60, 20) - box(20.4, 60, 15).at(0, 0, 5) + box(30, 60, 2).at(0, 0, 11)
BLOCK = box(20, 30, 9).at(0, 0, 5)
PLACES = ((0.0, 0.0, 0.0), (137.3, 0.0, 0.0), (137.3, -211.7, 43.9), (-90.1, 15.3, -77.7))


def machine(place: tuple[float, float, float], number: int) -> list[Node]:
    """A pin in a plate, and a block with play in a channel on it, 3 mm aside in every other machine."""
    x, y, z = place
    return [
        part("plate", PLATE, x, y, z),
        part("pin", PIN, x + 15, y, z),
        part("channel", CHANNEL, x - 15, y + 3 * (number % 2), z + 15),
        part("block", BLOCK, x - 15, y + 4, z + 15),
    ]


def close(one: Array | None, two: Array | None) -> bool:
    """Whether both are equal but for the rounding of outlines, 10 nm, or neither is there."""
    return one is two if one is None or two is None else bool(np.allclose(one, two, rtol=0.0, atol=1e-8))


@pytest.fixture(scope="module")
def together() -> Survey:
    """All machines in one assembly."""
    return Survey(assembled(*(node for n, place in enumerate(PLACES) for node in machine(place, n))), ALL_SOURCES)


@pytest.mark.parametrize("number", range(len(PLACES)))
def test_relations_are_those_of_the_machine_alone(together: Survey, number: int) -> None:
    """Freedom, axis, and areas in contact."""
    alone, first = Survey(assembled(*machine(PLACES[number], number)), ALL_SOURCES), 4 * number
    inside = {pair: r for pair, r in together.relations.items() if set(pair) <= set(range(first + 1, first + 5))}
    assert [(a - first, b - first) for a, b in inside] == list(alone.relations)
    for expected, r in zip(alone.relations.values(), inside.values(), strict=True):
        assert (r.via, r.freedom.kind, r.freedom.dof) == (expected.via, expected.freedom.kind, expected.freedom.dof)
        assert [fit.kind for fit in r.fits] == [fit.kind for fit in expected.fits]
        assert {r.a, r.b} == {part for of in (*r.fits, *r.patches) for part in (of.a, of.b)}
        assert close(r.freedom.direction, expected.freedom.direction)
        assert close(r.freedom.point, expected.freedom.point)
        assert (r.axis is None) == (expected.axis is None)
        assert r.axis is None or expected.axis is None or r.axis.same(expected.axis)
        assert exact_sum(p.area for p in r.patches) == pytest.approx(exact_sum(p.area for p in expected.patches))
        for patch, other in zip(r.patches, expected.patches, strict=True):
            assert close(patch.point, other.point)
            assert np.sort(patch.hull, axis=0) == pytest.approx(np.sort(other.hull, axis=0), abs=1e-8)


@pytest.mark.parametrize("number", range(len(PLACES)))
def test_slides_are_those_of_the_machine_alone(together: Survey, number: int) -> None:
    """The block slides along the channel, through its own place."""
    alone, first = Survey(assembled(*machine(PLACES[number], number)), ALL_SOURCES), 4 * number
    (slide,) = (one for pair, one in together.captured.items() if set(pair) <= set(range(first + 1, first + 5)))
    assert list(alone.captured) == [(3, 4)]
    assert slide.axis.same(alone.captured[3, 4].axis)
    assert slide.has_play
    assert slide.axis.is_along(np.array([0.0, 1.0, 0.0]))


def test_work_for_loose_parts_grows_with_their_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of 576 and of 1,600 looks for what may carry it among few boxes, though none of the others may."""
    seen: list[int] = []
    nearest = Boxes.nearest

    def counted(self: Boxes, box: Array) -> Iterator[tuple[int, float]]:
        for row in nearest(self, box):
            seen.append(row[0])
            yield row

    monkeypatch.setattr(Boxes, "nearest", counted)
    work = []
    for side in (24, 40):
        seen.clear()
        infer_mechanism(assembled(*(part("plate", PLATE, 120 * x, 120 * y) for x in range(side) for y in range(side))))
        work.append(len(seen))
    assert 0 < work[0] < work[1] < 4 * work[0]
