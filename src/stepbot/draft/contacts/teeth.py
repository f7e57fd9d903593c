"""Toothed rims by shape: outlines of plane faces that rise and fall evenly about an axis, all around or in a sector."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np

from stepbot.draft.contacts.contacts import CoaxialLine
from stepbot.draft.contacts.shafts import HALF_ROUND
from stepbot.draft.parts.axis import PARALLEL, Axis
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.spatial import Array, cross
from stepbot.step.faces import FaceKind

_FEWEST, _FEWEST_CORNERS = 5, 20
"""Teeth of a sector; corners of an outline that may have as many."""
_STRAIGHT = 1e-6
"""Bend of an outline as a share of its largest, below which it is none."""
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


class _Tip(NamedTuple):
    angle: float
    """[rad], along the outline without jumps."""
    radius: float
    height: float
    """Above the gap before it [m]."""


def find_rims(scene: Scene, part: int, lines: Sequence[CoaxialLine]) -> list[Rim]:
    """The toothed rims of a part about the axes of its round faces, at most one about each: the one with most teeth."""
    planes = scene.columns(part, FaceKind.PLANE)
    outlines: dict[int, list[Array]] = {}
    found = []
    for axis in (line.axis for line in lines if any(face.span > HALF_ROUND for face in line.faces[part])):
        across = np.linalg.norm(cross(planes.directions, axis.d), axis=-1) < PARALLEL
        rims: list[Rim] = []
        for row in np.flatnonzero(across).tolist():
            if row not in outlines:
                rings = [ring for ring in planes.faces[row].rings if _is_wavy(ring)]
                outlines[row] = [scene.component(part).X_WC.apply(ring) for ring in rings]
            rims += [rim for ring in outlines[row] for rim in _rims(ring, axis)]
        if rims:
            found.append(max(rims, key=lambda rim: (rim.teeth, rim.tip)))
    return found


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
    pitch = abs(run[-1].angle - run[0].angle) / (len(run) - 1)
    rim = Rim(axis, max(tip.radius for tip in run), round(2.0 * pi / pitch))
    module = 2.0 * rim.tip / (rim.teeth + 2.0)  # tips are one module above the pitch circle
    if pitch < _LARGEST_PITCH and _HEIGHT[0] < run[len(run) // 2].height / module < _HEIGHT[1]:
        yield rim


def _across(axis: Axis) -> tuple[Array, Array]:
    """Two unit vectors across an axis and each other."""
    x = cross(axis.d, np.eye(3)[int(np.argmin(np.abs(axis.d)))])
    x = x / np.linalg.norm(x)
    return x, cross(axis.d, x)


def _tips(radii: list[float], angles: list[float]) -> list[_Tip]:
    """The tips along an outline that starts at its lowest point, each in the middle of its land."""
    least, flat = _LEAST_HEIGHT * max(radii), _FLAT * max(radii)
    found: list[_Tip] = []
    low, first, last, rises = radii[0], 0, 0, True
    for k, radius in enumerate([*radii, radii[0]]):
        high = radii[first]
        if not rises:
            low = min(low, radius)
            if radius > low + least:
                first, last, rises = k, k, True
        elif radius > high + flat:
            first = last = k
        elif radius > high - flat:
            last = k
        elif radius < high - least:
            found.append(_Tip(0.5 * (angles[first] + angles[last]), high, high - low))
            low, rises = radius, False
    return found


def _runs(tips: list[_Tip]) -> Iterator[list[_Tip]]:
    """Tips in a row that are equally high and equally spaced."""
    run: list[_Tip] = []
    for tip in tips:
        if len(run) > 1:
            pitch = run[1].angle - run[0].angle
            even = abs(tip.angle - run[-1].angle - pitch) < _EQUAL_PITCH * abs(pitch)
            if not even or abs(tip.radius - run[0].radius) > _EQUAL_TIPS * run[1].height:
                yield run
                run = run[-1:]
        run.append(tip)
    yield run
