"""Profiles that one part holds in another: a tube in a tube, a carriage around a rail, a dovetail, a T-slot's nut.

Planes of both face each other, with clearance or without, and together hold one part in all directions across a
line; nothing holds it along. Clearance alone indicates that one moves in the other.
"""

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.draft.contacts.contacts import Pair
from stepbot.draft.contacts.planes import GAP, Facing, Planes
from stepbot.draft.contacts.relations import Relation, Via
from stepbot.draft.parts.axis import Axis, are_parallel
from stepbot.draft.parts.parts import box_gap
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.solids.box_pairs import box_pairs
from stepbot.geometry.spatial import Array, cross, unit
from stepbot.step.faces import FaceKind

_CLEARANCE, _WIDE = 6e-4, 3e-3
"""Gap [m] between faces of a slide up to which they guide it, and up to which they keep it in."""
_DEEP = 1e-3
"""Overlap [m] of two bounding boxes, in all directions, from which one part may be in the other."""
_ENGAGED, _LONG, _PROFILE = 1.0, 3.0, 1.5
"""Engaged length, in the least width of what is held, from which it slides: with guides all around, and if some are
wide; the same in the largest width, from which it is a profile.
"""
_ALONG, _STRAIGHT, _SKEW = 0.99, 1e-2, 0.3
"""Cosines from which a face ends a slide, and up to which it guides it; sine of the least angle between guides."""
_PAD, _FEWEST_LINED = 0.2, 4
"""Ratio of the sizes of a glide pad and its host, at most; two parts with three pads that line a slide are more."""
_SPAN = 1e-3
"""Angle [rad] by which directions that hold a part on all sides are less than half a turn apart, at most."""
_MOST_PLANES = 2000
"""Number of planes of a part above which it is not looked at."""


class Captured(Struct, frozen=True, eq=False):
    """A direction along which one part is free in another."""

    axis: Axis
    has_play: bool
    """Whether there is clearance on some side."""
    is_profile: bool
    """Whether it has clearance and is engaged over more than its widths: no motor in its seat is."""
    is_on_pin: bool = False
    """Whether a pin and two faces along it hold the part, rather than faces on four sides."""


def find_captured(
    scene: Scene, relations: dict[Pair, Relation], larger: Collection[int], cut: dict[str, None]
) -> dict[Pair, Captured]:
    """Pairs of parts of which one is held in the other across a line, and free along it.

    Args:
        relations: Those of parts that touch.
        larger: The parts to look at.
        cut: Gets a note if a part is left out.
    """
    captured: dict[Pair, Captured] = {}
    slides: dict[bytes, tuple[bool, Captured | None]] = {}  # in the frame of a part, and whether faces are beside it
    alone: set[tuple[int, bytes]] = set()  # of parts with their pads: those that are no slide
    planes, inside = scene.of_all(Planes), frozenset(larger)
    bolted, pads, pins = _bolted(relations, inside), _pads(scene, relations, inside), _pins(relations, inside)
    for pair, arrangement in _overlapping(scene, larger, cut):
        for one, host in _within(scene, pair, bolted):
            placed = arrangement if len(host) == 1 else scene.arrangement(one, host)
            X = scene.component(one).X_WC
            if placed not in slides:
                facing = [face for other in host for face in planes.facing(one, other, _WIDE)]
                slide = _slide(facing) if len(facing) > 1 else None
                slides[placed] = bool(facing), slide and replace(slide, axis=slide.axis.moved(X.inverse()))
            is_beside, slide = slides[placed]
            if slide is not None:
                slide = replace(slide, axis=slide.axis.moved(X))
                if not _is_locked(relations, one, host, slide.axis):
                    captured[pair] = slide
                    break
            if len(host) == 1 and not is_beside:
                break  # nothing is beside: what is bolted on makes no slot of it
        if pair not in captured and pair not in relations and (slide := _on_pin(planes, pair, pins)) is not None:
            captured[pair] = slide
        elif pair not in captured and pair not in relations:
            lined, sides = _lined(scene, pair, pads)
            if len(lined) + len(sides) <= _FEWEST_LINED:
                continue
            padded = len(lined), scene.arrangement(pair[0], lined + sides)
            if padded in alone:
                continue
            slide = _slide([x for a in lined for b in sides for x in planes.facing(a, b, _WIDE)])
            if slide is not None and slide.has_play:
                captured[pair] = slide
            else:
                alone.add(padded)
    return captured


def _pins(relations: Mapping[Pair, Relation], larger: Collection[int]) -> dict[int, Axis]:
    """The axis of the pin of each part that nothing but a pin holds."""
    held: dict[int, list[Relation]] = defaultdict(list)
    for pair, r in relations.items():
        for i in pair:
            held[i].append(r)
    axes = {i: [r.axis for r in of if r.via == Via.PIN and r.axis is not None] for i, of in held.items() if i in larger}
    return {i: of[0] for i, of in axes.items() if len(of) == len(held[i]) and all(one.same(of[0]) for one in of)}


def _on_pin(planes: Planes, pair: Pair, pins: Mapping[int, Axis]) -> Captured | None:
    """How a block that nothing but a pin holds slides, with play, between two faces along the pin, as in a channel."""
    for one, other in (pair, pair[::-1]):
        if one not in pins or other in pins:
            continue
        pin, near = pins[one], list(planes.facing(one, other, _WIDE))
        guides = [face for face in near if abs(float(face.normal @ pin.d)) < _STRAIGHT and face.gap < _CLEARANCE]
        if len(_distinct([guide.normal for guide in guides])) != 1 or not _is_between(guides):
            continue
        along = cross(guides[0].normal, pin.d)
        is_stopped = any(abs(float(face.normal @ along)) > _ALONG for face in near)
        if not is_stopped and max(guide.gap for guide in guides) > GAP:
            return Captured(Axis(guides[0].patch.point, along), has_play=True, is_profile=False, is_on_pin=True)
    return None


def _pads(scene: Scene, relations: Mapping[Pair, Relation], larger: Collection[int]) -> dict[int, list[int]]:
    """For each part the much smaller ones that lie on a face of it, such as glide pads."""
    pads: dict[int, list[int]] = defaultdict(list)
    for pair, r in relations.items():
        if r.patches and all(i in larger and i in scene.boxes for i in pair):
            sizes = {i: float(np.linalg.norm(np.ptp(scene.boxes[i], axis=0))) for i in pair}
            pad, host = sorted(pair, key=lambda i: sizes[i])
            if sizes[pad] < _PAD * sizes[host]:
                pads[host].append(pad)
    return pads


def _lined(scene: Scene, pair: Pair, pads: Mapping[int, Sequence[int]]) -> list[list[int]]:
    """Two parts that do not touch, each with its pads that are beside the other."""
    return [
        [one, *(pad for pad in pads.get(one, ()) if box_gap(scene.boxes[pad], scene.boxes[other]) < _WIDE)]
        for one, other in (pair, pair[::-1])
    ]


def _bolted(relations: Mapping[Pair, Relation], larger: Collection[int]) -> dict[int, set[int]]:
    """For each part those that are fastened to it."""
    bolted: dict[int, set[int]] = defaultdict(set)
    for (a, b), r in relations.items():
        if (r.is_rigid or r.via == Via.RING) and a in larger and b in larger:
            bolted[a].add(b)
            bolted[b].add(a)
    return bolted


def _within(scene: Scene, pair: Pair, bolted: Mapping[int, set[int]]) -> Iterator[tuple[int, tuple[int, ...]]]:
    """One of two parts, and the other alone, then with what is bolted to it, such as the floor or the lid of a slot."""
    yield pair[0], pair[1:]
    for one, other in (pair, pair[::-1]):
        beside = [i for i in bolted.get(other, ()) if i != one and i in scene.boxes]
        more = [i for i in beside if box_gap(scene.boxes[one], scene.boxes[i]) < _WIDE]
        if more:
            yield one, (other, *sorted(more))


def _is_locked(relations: Mapping[Pair, Relation], one: int, host: Sequence[int], axis: Axis) -> bool:
    """Whether round faces or holes that are not along a slide hold its sides together."""
    between = (relations.get((min(one, other), max(one, other))) for other in host)
    return any(
        r.is_rigid or bool(r.sockets) or any(not axis.is_along(fit.axis.d) for fit in r.fits) or r.holes > 0
        for r in between
        if r is not None
    )


def _overlapping(scene: Scene, larger: Collection[int], cut: dict[str, None]) -> Iterator[tuple[Pair, bytes]]:
    """Pairs of parts whose boxes overlap, with their arrangement."""
    counts = {i: scene.count(i, FaceKind.PLANE) for i in larger if i in scene.boxes}
    if any(count > _MOST_PLANES for count in counts.values()):
        cut[f"parts with more than {_MOST_PLANES} plane faces were not tried as slides in others"] = None
    ids = sorted(i for i, count in counts.items() if 0 < count <= _MOST_PLANES)
    boxes = np.array([scene.boxes[i] for i in ids]).reshape(-1, 2, 3)
    rows = box_pairs(boxes[:, 0], boxes[:, 1], _DEEP)
    return scene.arranged([(ids[k], ids[m]) for k, m in zip(*rows, strict=True)])


def _slide(facing: Sequence[Facing]) -> Captured | None:
    """The longest direction that is free between faces that hold one part in the other."""
    near = [one for one in facing if one.gap < _CLEARANCE]
    normals = _distinct([one.normal for one in facing])
    best: tuple[float, Captured] | None = None
    for along in _distinct([unit(v) for u, w in combinations(normals, 2) if np.linalg.norm(v := cross(u, w)) > _SKEW]):
        guides = [one for one in near if abs(float(one.normal @ along)) < _STRAIGHT]
        ends = [float(one.normal @ along) for one in facing if abs(float(one.normal @ along)) > _ALONG]
        if not guides or len(guides) < len(near) or (ends and min(ends) < 0.0 < max(ends)):
            continue
        wide = [one for one in facing if abs(float(one.normal @ along)) < _STRAIGHT]
        least = _ENGAGED if _are_around(guides, along) else _LONG if _is_kept(guides, wide, along) else None
        hull = np.concatenate([guide.patch.hull for guide in guides])
        widths = [float(np.ptp(hull @ guide.normal)) for guide in guides]
        length = float(np.ptp(hull @ along))
        if least is not None and length >= least * min(widths) and (best is None or length > best[0]):
            has_play = max(guide.gap for guide in guides) > GAP
            longest = max(float(np.ptp(guide.patch.hull @ along)) for guide in guides)
            is_profile = has_play and longest >= _PROFILE * max(widths)
            best = length, Captured(Axis(guides[0].patch.point, along), has_play, is_profile)
    return best[1] if best is not None else None


def _distinct(directions: Sequence[Array]) -> list[Array]:
    """Directions without those that are parallel to earlier ones."""
    kept: list[Array] = []
    for direction in directions:
        if not any(are_parallel(direction, known) for known in kept):
            kept.append(direction)
    return kept


def _is_between(guides: Sequence[Facing]) -> bool:
    """Whether two of some faces hold a part from opposite sides."""
    return any(
        are_parallel(one.normal, two.normal) and float(one.normal @ two.normal) < 0.0
        for one, two in combinations(guides, 2)
    )


def _are_around(guides: Sequence[Facing], along: Array) -> bool:
    """Whether faces hold a part on all sides across a direction."""
    u = guides[0].normal
    v = cross(along, u)
    angles = np.sort([np.arctan2(float(guide.normal @ v), float(guide.normal @ u)) for guide in guides])
    gaps = np.diff(angles, append=angles[0] + 2.0 * np.pi)
    return len(_distinct([guide.normal for guide in guides])) > 1 and bool(gaps.max() < np.pi + _SPAN)


def _is_kept(guides: Sequence[Facing], wide: Sequence[Facing], along: Array) -> bool:
    """Whether a part is guided on two opposite sides with clearance, and kept in by wider gaps on the others."""
    return _is_between(guides) and max(guide.gap for guide in guides) > GAP and _are_around(wide, along)
