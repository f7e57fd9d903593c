"""Teeth by shape: outlines of plane faces that rise and fall evenly, about an axis or in a sector, or along a rack."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from stepbot.draft.contacts.contacts import CoaxialLine
from stepbot.draft.contacts.shafts import HALF_ROUND
from stepbot.draft.parts.axis import Axis, are_parallel
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.spatial import Array, cross
from stepbot.step.assembly import Body
from stepbot.step.faces import FaceKind

_FEWEST, _FEWEST_CORNERS = 5, 20
"""Teeth of a sector; corners of an outline that may have as many."""
_STRAIGHT = 1e-6
"""Bend of an outline as a share of its largest, below which it is none."""
_LONG_EDGE, _MOST_EDGES = 0.25, 4
"""Share of the longest edge from which a rack may be along another, and the number of such directions."""
_LARGEST_PITCH = 2.0 * pi / 8.0
"""Angle [rad] of a tooth of the smallest pinion."""
_LEAST_HEIGHT, _FLAT = 0.01, 5e-4
"""Height of a tooth as a share of the largest radius, below which an outline is round; the same of a tip's land."""
_EQUAL_TIPS, _EQUAL_PITCH = 0.1, 0.06
"""Share of the height up to which tips are equally high, and of the pitch up to which they are equally spaced."""
_HEIGHT = (1.0, 3.2)
"""Height of a tooth in modules: 2.25 of a gear's, less of a timing pulley's."""


@dataclass(frozen=True, eq=False)
class Rim:
    """A toothed rim."""

    axis: Axis
    tip: float
    """Radius of the tips [m]."""
    teeth: int
    """Number of teeth all around; a sector has fewer."""


@dataclass(frozen=True, eq=False)
class Rack:
    """Teeth on a line."""

    point: Array
    """Shape (3,) [m]: in the middle of the tips."""
    along: Array
    """Unit direction (3,) of the line."""
    out: Array
    """Unit direction (3,) across it, from the rack to its tips."""
    pitch: float
    """[m]."""
    length: float
    """From the first to the last tip [m]."""


class _Tip(NamedTuple):
    place: float
    """Angle [rad] or position [m] along the outline, without jumps."""
    level: float
    """Radius, or height above the lowest point [m]."""
    height: float
    """Above the gap before it [m]."""


def find_rims(scene: Scene, part: int, lines: Sequence[CoaxialLine]) -> list[Rim]:
    """The toothed rims of a part about the axes of its round faces, at most one about each: the one with most teeth."""
    axes = [line.axis for line in lines if any(face.span > HALF_ROUND for face in line.faces[part])]
    outlines = list(_outlines(scene, part)) if axes else []
    found = []
    for axis in axes:
        across = (outline for normal, outline in outlines if are_parallel(normal, axis.d))
        rims = [rim for outline in across for rim in _rims(outline, axis)]
        if rims:
            found.append(max(rims, key=lambda rim: (rim.teeth, rim.tip)))
    return found


def find_rack(scene: Scene, part: int) -> Rack | None:
    """The rack of a part, with most teeth; None without one."""
    racks = [rack for normal, outline in _outlines(scene, part) for rack in _racks(outline, normal)]
    return max(racks, key=lambda rack: round(rack.length / rack.pitch), default=None)


_WAVY: WeakKeyDictionary[Body, tuple[tuple[int, Array], ...]] = WeakKeyDictionary()
"""For each definition in use, the wavy outlines of its plane faces, with the number of the face among them."""


def _outlines(scene: Scene, part: int) -> Iterator[tuple[Array, Array]]:
    """Normals and outlines of plane faces that teeth may be along."""
    body = scene.body(part)
    if body not in _WAVY:
        planes = [face for face in body.faces if face.kind == FaceKind.PLANE]
        rings = ((n, ring) for n, face in enumerate(planes) for ring in face.rings)
        _WAVY[body] = tuple((n, ring) for n, ring in rings if _is_wavy(ring))
    if wavy := _WAVY[body]:
        normals, X = scene.columns(part, FaceKind.PLANE).directions, scene.component(part).X_WC
        yield from ((normals[n], X.apply(ring)) for n, ring in wavy)


def _is_wavy(outline: Array) -> bool:
    """Whether a closed plane outline turns to and fro as often as teeth do."""
    if len(outline) < _FEWEST_CORNERS:
        return False
    edges = np.diff(outline, axis=0)
    turns = cross(edges, np.roll(edges, -1, axis=0))
    bends = turns @ turns[int(np.argmax((turns**2).sum(axis=1)))]
    signs = np.sign(bends[np.abs(bends) > _STRAIGHT * np.abs(bends).max()])
    return int((signs != np.roll(signs, 1)).sum()) >= 2 * (_FEWEST - 1)


def _rims(outline: Array, axis: Axis) -> Iterator[Rim]:
    """The rim that the longest run of equal tips along a closed outline makes, if their height is that of teeth."""
    x, y = _across(axis)
    offsets = outline[:-1] - axis.point
    radii = np.hypot(offsets @ x, offsets @ y)
    peaks = (radii >= np.roll(radii, 1)) & (radii > np.roll(radii, -1))
    if int(peaks.sum()) < _FEWEST:
        return
    lowest = int(np.argmin(radii))
    angles = np.unwrap(np.roll(np.arctan2(offsets @ y, offsets @ x), -lowest))
    run = max(_runs(_tips(np.roll(radii, -lowest).tolist(), angles.tolist())), key=len, default=[])
    if len(run) < _FEWEST:
        return
    pitch = abs(run[-1].place - run[0].place) / (len(run) - 1)
    rim = Rim(axis, max(tip.level for tip in run), round(2.0 * pi / pitch))
    module = 2.0 * rim.tip / (rim.teeth + 2.0)  # tips are one module above the pitch circle
    if pitch < _LARGEST_PITCH and _HEIGHT[0] < run[len(run) // 2].height / module < _HEIGHT[1]:
        yield rim


def _racks(outline: Array, normal: Array) -> Iterator[Rack]:
    """The racks along the longest straight edges of an outline."""
    edges = np.diff(outline, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    directions: list[Array] = []
    for row in np.flatnonzero(lengths > _LONG_EDGE * lengths.max()).tolist():
        along = edges[row] / lengths[row]
        if not any(are_parallel(along, known) for known in directions):
            directions.append(along)
    for along in directions[:_MOST_EDGES]:
        for out in (cross(normal, along), cross(along, normal)):
            levels = outline[:-1] @ out
            lowest = int(np.argmin(levels))
            levels, places = np.roll(levels - levels.min(), -lowest), np.roll(outline[:-1] @ along, -lowest)
            run = max(_runs(_tips(levels.tolist(), places.tolist())), key=len, default=[])
            if len(run) < _FEWEST:
                continue
            length = abs(run[-1].place - run[0].place)
            pitch = length / (len(run) - 1)
            if _HEIGHT[0] < run[len(run) // 2].height / (pitch / pi) < _HEIGHT[1]:
                middle = 0.5 * (run[0].place + run[-1].place)
                base = outline[0] - (outline[0] @ along) * along - (outline[0] @ out) * out
                top = run[0].level + float((outline[:-1] @ out).min())
                yield Rack(base + middle * along + top * out, along, out, pitch, length)


def _across(axis: Axis) -> tuple[Array, Array]:
    """Two unit vectors across an axis and each other."""
    x = cross(axis.d, np.eye(3)[int(np.argmin(np.abs(axis.d)))])
    x = x / np.linalg.norm(x)
    return x, cross(axis.d, x)


def _tips(levels: list[float], places: list[float]) -> list[_Tip]:
    """The tips along an outline that starts at its lowest point, each in the middle of its land."""
    least, flat = _LEAST_HEIGHT * max(levels), _FLAT * max(levels)
    found: list[_Tip] = []
    low, first, last, rises = levels[0], 0, 0, True
    for k, level in enumerate([*levels, levels[0]]):
        high = levels[first]
        if not rises:
            low = min(low, level)
            if level > low + least:
                first, last, rises = k, k, True
        elif level > high + flat:
            first = last = k
        elif level > high - flat:
            last = k
        elif level < high - least:
            found.append(_Tip(0.5 * (places[first] + places[last]), high, high - low))
            low, rises = level, False
    return found


def _runs(tips: list[_Tip]) -> Iterator[list[_Tip]]:
    """Tips in a row that are equally high and equally spaced."""
    run: list[_Tip] = []
    for tip in tips:
        if len(run) > 1:
            pitch = run[1].place - run[0].place
            even = abs(tip.place - run[-1].place - pitch) < _EQUAL_PITCH * abs(pitch)
            if not even or abs(tip.level - run[0].level) > _EQUAL_TIPS * run[1].height:
                yield run
                run = run[-1:]
        run.append(tip)
    yield run
