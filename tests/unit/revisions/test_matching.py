"""Matching of parts: by shape and pose first, by name where these are ambiguous."""

import math
from collections.abc import Iterable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from stepbot.geometry.spatial import Pose, Vector3, bounds, matrix3, rotation_about, turn_inertia, unit
from stepbot.revisions.matching import Certainty, Match, match
from stepbot.revisions.shapes import motion, same_shape
from stepbot.revisions.snapshot import Part, Shape, Snapshot

CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def block(x: float, y: float, z: float, com: Vector3 = (0.0, 0.0, 0.0)) -> Shape:
    """A block [m] whose centroid is at a point of its frame."""
    volume = x * y * z
    moments = (y * y + z * z, x * x + z * z, x * x + y * y)
    inertia = (*(volume * m / 12 for m in moments), 0.0, 0.0, 0.0)
    return Shape("solid", (("plane", 6),), "exact", volume, com, inertia, 1e-9)


PLATE, ROD, CUBE = block(0.1, 0.06, 0.01), block(0.01, 0.01, 0.2), block(0.02, 0.02, 0.02)
SHAPES = (PLATE, ROD, CUBE)
SIZES = ((0.1, 0.06, 0.01), (0.01, 0.01, 0.2), (0.02, 0.02, 0.02))


def part(path: str, shape: int, at: Vector3 = (0.0, 0.0, 0.0), *, by_ordinal: bool = False) -> Part:
    """A part at a position, in the orientation of its frame."""
    box = bounds(CORNERS * SIZES[shape] + at)
    return Part(path, shape, at, box=box, by_ordinal=by_ordinal)


def assembly(*parts: Part, shapes: tuple[Shape, ...] = SHAPES) -> Snapshot:
    """A snapshot of parts."""
    return Snapshot("a.step", "0" * 40, shapes, parts)


def names(old: Snapshot, new: Snapshot, found: Match, certainty: Certainty) -> dict[str, str]:
    """Former and present name of each part matched for a reason."""
    pairs = [pair for pair in found.pairs if pair.certainty is certainty]
    return {old.parts[pair.old].path: new.parts[pair.new].path for pair in pairs}


def paths(snapshot: Snapshot, indices: Iterable[int]) -> list[str]:
    """Names of parts."""
    return [snapshot.parts[index].path for index in indices]


BASE = part("base", 0)


def test_same_shape_and_place_is_certain() -> None:
    """A renamed part with the same shape and pose is a certain match."""
    old, new = assembly(BASE, part("pin", 1, (0.1, 0, 0))), assembly(BASE, part("bolt", 1, (0.1, 0, 0)))
    assert names(old, new, match(old, new), Certainty.CERTAIN) == {"pin": "bolt"}


def test_same_shape_elsewhere_is_probable() -> None:
    """A part that was renamed and moved is a probable match if it is the only one of its shape."""
    old, new = assembly(BASE, part("pin", 1, (0.1, 0, 0))), assembly(BASE, part("bolt", 1, (0.1, 0, 0.003)))
    found = match(old, new)
    assert names(old, new, found, Certainty.PROBABLE) == {"pin": "bolt"}
    assert found.pairs[1].motion.distance == pytest.approx(0.003, abs=1e-12)


def test_equal_parts_are_distinguished_by_pose() -> None:
    """Equal parts that were all renamed are matched by position, in any order of the file."""
    places: list[Vector3] = [(0.1 * i, 0, 0) for i in range(1, 5)]
    old = assembly(BASE, *(part(f"screw {i}", 1, at) for i, at in enumerate(places)))
    new = assembly(BASE, *(part(f"bolt {i}", 1, at) for i, at in reversed(list(enumerate(places)))))
    expected = {f"screw {i}": f"bolt {i}" for i in range(4)}
    assert names(old, new, match(old, new), Certainty.CERTAIN) == expected


def test_two_parts_at_one_place_are_ambiguous() -> None:
    """Two equal parts at one pose have no certain match."""
    at = (0.1, 0, 0)
    old = assembly(BASE, part("a", 1, at), part("b", 1, at))
    new = assembly(BASE, part("c", 1, at), part("d", 1, at))
    found = match(old, new)
    assert names(old, new, found, Certainty.CERTAIN) == {}
    assert paths(old, found.removed) == ["a", "b"]
    assert {paths(old, [i])[0]: paths(new, several) for i, several in found.candidates.items()} == {
        "a": ["c", "d"],
        "b": ["c", "d"],
    }


def test_swapped_names_are_moved_parts() -> None:
    """Two equal parts that keep their names and exchange positions have moved."""
    old = assembly(BASE, part("left", 1, (0.1, 0, 0)), part("right", 1, (-0.1, 0, 0)))
    new = assembly(BASE, part("left", 1, (-0.1, 0, 0)), part("right", 1, (0.1, 0, 0)))
    found = match(old, new)
    assert names(old, new, found, Certainty.PATH) == {"base": "base", "left": "left", "right": "right"}
    assert [pair.motion.distance for pair in found.pairs] == pytest.approx([0.0, 0.2, 0.2])


def test_numbers_shift_with_the_parts() -> None:
    """After the first of three screws is removed, paths with #n alone follow the positions of the others."""
    old = assembly(BASE, *(part(f"screw#{i}", 1, (0.1 * i, 0, 0), by_ordinal=True) for i in (1, 2, 3)))
    new = assembly(BASE, *(part(f"screw#{i}", 1, (0.1 * (i + 1), 0, 0), by_ordinal=True) for i in (1, 2)))
    found = match(old, new)
    assert names(old, new, found, Certainty.CERTAIN) == {"screw#2": "screw#1", "screw#3": "screw#2"}
    assert paths(old, found.removed) == ["screw#1"]


def test_mirror_image_is_another_shape() -> None:
    """A mirror image in the same pose has the same moments and another box, and does not match."""
    bracket = replace(block(0.1, 0.06, 0.01), com=(0.01, 0.0, 0.0))
    left = Part("bracket", 0, box=((-0.03, -0.03, -0.005), (0.07, 0.03, 0.005)))
    right = replace(left, box=((-0.05, -0.03, -0.005), (0.05, 0.03, 0.005)))
    old, new = (assembly(one, BASE, shapes=(bracket, ROD)) for one in (left, right))
    pair = match(old, new).pairs[0]
    assert pair.motion.is_none
    assert not pair.is_same_shape
    renamed = assembly(replace(right, path="mirrored"), BASE, shapes=(bracket, ROD))
    assert names(old, renamed, match(old, renamed), Certainty.CERTAIN) == {}


def test_part_of_nearly_the_same_size_at_the_same_place_is_probable() -> None:
    """A part that was renamed and slightly reshaped is a probable match; one of half the size is not."""
    thicker = block(0.1, 0.06, 0.011)
    old = assembly(part("cover", 0), part("pin", 1, (0, 0, 1)))
    new = assembly(part("lid", 2), part("pin", 1, (0, 0, 1)), shapes=(PLATE, ROD, thicker))
    assert names(old, new, match(old, new), Certainty.PROBABLE) == {"cover": "lid"}
    smaller = assembly(part("lid", 2), part("pin", 1, (0, 0, 1)), shapes=(PLATE, ROD, block(0.05, 0.06, 0.01)))
    found = match(old, smaller)
    assert (paths(old, found.removed), paths(smaller, found.added)) == (["cover"], ["lid"])


def test_motion_of_the_whole_does_not_count() -> None:
    """A motion shared by all parts is removed before matching, so that a renamed part is certain."""
    shift = (0.0, 0.0, 0.25)
    old = assembly(BASE, part("pin", 1, (0.1, 0, 0)), part("foot", 2, (0, 0.1, 0)))
    new = assembly(part("base", 0, shift), part("bolt", 1, (0.1, 0, 0.25)), part("foot", 2, (0, 0.1, 0.25)))
    found = match(old, new)
    assert found.is_moved
    assert found.common.position == pytest.approx(shift)
    assert names(old, new, found, Certainty.CERTAIN) == {"pin": "bolt"}
    assert all(pair.motion.is_none for pair in found.pairs)


def test_one_part_that_stays_makes_the_others_moved() -> None:
    """The whole has not moved if one part has not."""
    old = assembly(BASE, part("pin", 1, (0.1, 0, 0)), part("foot", 2, (0, 0.1, 0)))
    new = assembly(BASE, part("pin", 1, (0.1, 0, 0.25)), part("foot", 2, (0, 0.1, 0.25)))
    found = match(old, new)
    assert not found.is_moved
    assert [pair.motion.distance for pair in found.pairs] == pytest.approx([0.0, 0.25, 0.25])


directions = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: math.hypot(*v) > 0.1)
points = st.tuples(*[st.floats(-2.0, 2.0)] * 3)


@given(directions, st.floats(-3.0, 3.0), points)
def test_shape_does_not_depend_on_the_frame_it_is_drawn_in(axis: Vector3, angle: float, p: Vector3) -> None:
    """A solid drawn in another frame has the same shape; if its occurrence compensates, it has not moved."""
    R = rotation_about(unit(axis), angle)
    a = block(0.1, 0.06, 0.01)
    tensor = turn_inertia(R, a.tensor)
    six = (*(float(tensor[i, i]) for i in range(3)), float(tensor[0, 1]), float(tensor[0, 2]), float(tensor[1, 2]))
    b = replace(a, com=p, inertia=six)
    assert same_shape(a, b)
    X_WC = Pose.of(R, p).inverse()
    old = part("plate", 0)
    new = replace(old, position=X_WC.position, rotation=matrix3(X_WC.R))
    assert motion(old, a, new, b).is_none


@given(st.floats(1e-4, 0.5))
def test_a_larger_part_is_another_shape(share: float) -> None:
    """A part that grew in one direction by more than 1e-4 has another shape."""
    assert not same_shape(block(0.1, 0.06, 0.01), block(0.1 * (1.0 + share), 0.06, 0.01))
