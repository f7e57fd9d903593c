"""Gears and racks by their teeth, gears and pulleys by name: which ones mesh, and their ratio.

Teeth are outlines of plane faces that rise and fall evenly, about an axis or in a sector, or along a line.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import combinations
from math import pi
from typing import NamedTuple

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.contacts import CoaxialLine
from stepbot.draft.contacts.shafts import HALF_ROUND
from stepbot.draft.parts.axis import PARALLEL, Axis, are_parallel
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import Part, box_gap
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.spatial import Array, Pose, cross, perpendicular_frame
from stepbot.step.assembly import Body
from stepbot.step.faces import Face, FaceKind

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
_MESHED = 0.8
"""Ratio of the distance of two axes and the sum of the outer radii, from which teeth mesh up to where they touch."""
_TEETH = 1.15
"""The same ratio up to which they do, where the round faces are those at the roots of the teeth."""
_ADDENDUM = (0.2, 1.5)
"""Distance from the pitch circle to the tips of teeth, in modules: 1 of a standard gear, less with chamfers."""
_OUTER = 0.9
"""Share of a part's outer radius from which a rim is its outer one, and no spline in its bore."""
_DECIMALS = 6
"""Decimals [m] to which the halves of a round face have one radius."""


class Rim(Struct, frozen=True, eq=False):
    """A toothed rim."""

    axis: Axis
    tip: float
    """Radius of the tips [m]."""
    teeth: int
    """Number of teeth all around; a sector has fewer."""

    def placed(self, X: Pose) -> "Rim":
        """This rim, given in the frame of a definition, in the assembly."""
        return Rim(self.axis.moved(X), self.tip, self.teeth)


class Rack(Struct, frozen=True, eq=False):
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

    def placed(self, X: Pose) -> "Rack":
        """This rack, given in the frame of a definition, in the assembly."""
        return Rack(X.apply(self.point), X.turn(self.along), X.turn(self.out), self.pitch, self.length)


class Teeth(NamedTuple):
    """The teeth of a definition, in its frame."""

    rims: tuple[Rim, ...] = ()
    """At most one about each axis: the one with most teeth."""
    rack: Rack | None = None
    """The rack with most teeth."""


class _Tip(NamedTuple):
    place: float
    """Angle [rad] or position [m] along the outline, without jumps."""
    level: float
    """Radius, or height above the lowest point [m]."""
    height: float
    """Above the gap before it [m]."""


def teeth_of(body: Body) -> Teeth:
    """The toothed rims of a body about axes of its round faces, and its rack."""
    planes = (face for face in body.faces if face.kind == FaceKind.PLANE)
    outlines = [(np.array(face.direction), ring) for face in planes for ring in face.rings if _is_wavy(ring)]
    if not outlines:
        return Teeth()
    rims = []
    for axis in _axes(body.faces):
        across = (ring for normal, ring in outlines if are_parallel(normal, axis.d))
        candidates = [rim for ring in across if (rim := _rim(ring, axis)) is not None]
        if candidates:
            rims.append(max(candidates, key=lambda rim: (rim.teeth, rim.tip)))
    racks = (rack for normal, ring in outlines for rack in _racks(ring, normal))
    return Teeth(tuple(rims), max(racks, key=lambda rack: round(rack.length / rack.pitch), default=None))


def _axes(faces: Sequence[Face]) -> list[Axis]:
    """The axes of faces of revolution that cover more than half of a turn together, such as both halves of a bore."""
    lines: list[tuple[Axis, dict[tuple[float, bool], float]]] = []
    for face in faces:
        if face.kind in (FaceKind.CYLINDER, FaceKind.CONE):
            axis = Axis(np.array(face.point), np.array(face.direction))
            spans = next((sums for line, sums in lines if line.same(axis)), None)
            if spans is None:
                spans = defaultdict[tuple[float, bool], float](float)
                lines.append((axis, spans))
            spans[round(face.radius, _DECIMALS), face.bore] += face.span
    return [axis for axis, spans in lines if max(spans.values()) > HALF_ROUND]


def _is_wavy(outline: Array) -> bool:
    """Whether a closed plane outline turns to and fro as often as teeth do."""
    if len(outline) < _FEWEST_CORNERS:
        return False
    edges = np.diff(outline, axis=0)
    turns = cross(edges, np.roll(edges, -1, axis=0))
    bends = turns @ turns[int(np.argmax((turns**2).sum(axis=1)))]
    signs = np.sign(bends[np.abs(bends) > _STRAIGHT * np.abs(bends).max()])
    return int((signs != np.roll(signs, 1)).sum()) >= 2 * (_FEWEST - 1)


def _rim(outline: Array, axis: Axis) -> Rim | None:
    """The rim of the longest run of equal tips along a closed outline; None if they are not as high as teeth."""
    x, y, _ = perpendicular_frame(axis.d).T
    offsets = outline[:-1] - axis.point
    radii = np.hypot(offsets @ x, offsets @ y)
    peaks = (radii >= np.roll(radii, 1)) & (radii > np.roll(radii, -1))
    if int(peaks.sum()) < _FEWEST:
        return None
    lowest = int(np.argmin(radii))
    angles = np.unwrap(np.roll(np.arctan2(offsets @ y, offsets @ x), -lowest))
    run = _longest_run(np.roll(radii, -lowest), angles)
    if len(run) < _FEWEST:
        return None
    pitch = _pitch(run)
    rim = Rim(axis, max(tip.level for tip in run), round(2.0 * pi / pitch))
    module = 2.0 * rim.tip / (rim.teeth + 2.0)  # tips are one module above the pitch circle
    return rim if pitch < _LARGEST_PITCH and _are_teeth(run, module) else None


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
            places, heights = outline[:-1] @ along, outline[:-1] @ out
            lowest = int(np.argmin(heights))
            run = _longest_run(np.roll(heights - heights[lowest], -lowest), np.roll(places, -lowest))
            if len(run) >= _FEWEST and _are_teeth(run, _pitch(run) / pi):
                middle, top = 0.5 * (run[0].place + run[-1].place), heights[lowest] + run[0].level
                point = outline[0] + (middle - places[0]) * along + (top - heights[0]) * out
                yield Rack(point, along, out, _pitch(run), abs(run[-1].place - run[0].place))


def _pitch(run: Sequence[_Tip]) -> float:
    return abs(run[-1].place - run[0].place) / (len(run) - 1)


def _are_teeth(run: Sequence[_Tip], module: float) -> bool:
    """Whether tips are as high as teeth of a module [m]."""
    return _HEIGHT[0] < run[len(run) // 2].height / module < _HEIGHT[1]


def _longest_run(levels: Array, places: Array) -> list[_Tip]:
    """The most tips in a row that are equally high and equally spaced, along an outline from its lowest point."""
    best: list[_Tip] = []
    run: list[_Tip] = []
    for tip in _tips(levels.tolist(), places.tolist()):
        if len(run) > 1:
            pitch = run[1].place - run[0].place
            even = abs(tip.place - run[-1].place - pitch) < _EQUAL_PITCH * abs(pitch)
            if not even or abs(tip.level - run[0].level) > _EQUAL_TIPS * run[1].height:
                run = run[-1:]
        run = [*run, tip]
        best = max(best, run, key=len)
    return best


def _tips(levels: Sequence[float], places: Sequence[float]) -> Iterator[_Tip]:
    """The tips along an outline that starts at its lowest point, each in the middle of its land."""
    least, flat = _LEAST_HEIGHT * max(levels), _FLAT * max(levels)
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
            yield _Tip(0.5 * (places[first] + places[last]), high, high - low)
            low, rises = level, False


class Gear(Struct, frozen=True, eq=False):
    """A part with teeth, or named a gear or a pulley, and its outer circle."""

    part: int
    axis: Axis
    radius: float
    """[m]."""
    teeth: int = 0
    """Number of drawn teeth all around, of which a sector has fewer; 0 if they are not drawn."""


class Mesh(Struct, frozen=True, eq=False):
    """Two gears that mesh, or two pulleys with one belt."""

    one: Gear
    two: Gear
    belt: str = ""
    """Path of the belt; empty for teeth."""

    @property
    def are_counted(self) -> bool:
        """Whether the teeth of both are drawn."""
        return self.one.teeth > 0 and self.two.teeth > 0

    @property
    def ratio(self) -> float:
        """Turns of the second gear for a turn of the first, without sign.

        That of the teeth if they are counted; else of the pitch circles, which touch: teeth are as high on both gears.
        """
        if self.are_counted:
            return round(self.one.teeth / self.two.teeth, 9)
        one, two = self.one.radius, self.two.radius
        excess = 0.0 if self.belt else 0.5 * (one + two - self.one.axis.distance(self.two.axis.point))
        return round((one - excess) / (two - excess), 4)


class RackMesh(Struct, frozen=True, eq=False):
    """A gear that meshes with a rack."""

    gear: Gear
    part: int
    rack: Rack
    radius: float
    """Of the gear's pitch circle [m]."""

    def advance(self, axis: Array, direction: Array) -> float:
        """What the rack moves along a direction while the gear turns about an axis, both unit vectors [m/rad]."""
        return float(cross(axis, -self.radius * self.rack.out) @ direction)


def find_gears(
    parts: Mapping[int, Part], rims: Mapping[int, Sequence[Rim]], lines: Sequence[CoaxialLine]
) -> Iterator[Gear]:
    """The gears among parts, by their rims, or by name and their largest round face."""
    for i, part in parts.items():
        toothed = rims.get(i, ())
        yield from (Gear(i, rim.axis, rim.tip, rim.teeth) for rim in toothed)
        if Role.GEAR not in part.roles:
            continue
        best: Gear | None = None
        for line in lines:
            outer = [f.radius for f in line.faces.get(i, ()) if not f.bore]
            if outer and (best is None or max(outer) > best.radius):
                best = Gear(i, line.axis, max(outer))
        if best is not None and not any(rim.tip > _OUTER * best.radius for rim in toothed):
            yield best


def find_meshes(
    scene: Scene, parts: Mapping[int, Part], gears: Sequence[Gear], belts: Sequence[Part]
) -> Iterator[Mesh]:
    """All pairs of gears that mesh, and of pulleys with one belt."""
    for one, two in combinations(gears, 2):
        if not one.axis.is_along(two.axis.d) or not _overlap(scene, one.part, two.part, one.axis.d):
            continue
        away, reach = one.axis.distance(two.axis.point), one.radius + two.radius
        if one.teeth and two.teeth:
            are_meshed = away > 0.0 and _is_pitch(away / (one.teeth + two.teeth), one, two)
        else:
            are_meshed = _MESHED * reach < away < _TEETH * reach
        if are_meshed:
            yield Mesh(one, two)
        elif away >= _TEETH * reach:
            boxes = [parts[gear.part].box for gear in (one, two)]
            around = (b for b in belts if all(box_gap(b.box, box) == 0.0 for box in boxes))
            belt = next(around, None)
            if belt is not None:
                yield Mesh(one, two, belt.path)


def find_rack_meshes(scene: Scene, gears: Iterable[Gear], racks: Mapping[int, Rack]) -> Iterator[RackMesh]:
    """All gears that mesh with racks: of one module, and as far apart as pitch circle and pitch line."""
    for gear in gears:
        for part, rack in racks.items() if gear.teeth else ():
            module, away = rack.pitch / pi, gear.axis.point - rack.point
            radius = 0.5 * module * gear.teeth
            tips = (gear.radius - radius) / module, (radius - float(away @ rack.out)) / module
            if (
                part != gear.part
                and all(abs(float(gear.axis.d @ line)) < PARALLEL for line in (rack.along, rack.out))
                and abs(float(away @ rack.along)) < 0.5 * rack.length + radius
                and all(_ADDENDUM[0] < tip < _ADDENDUM[1] for tip in tips)
                and _overlap(scene, gear.part, part, gear.axis.d)
            ):
                yield RackMesh(gear, part, rack, radius)


def _overlap(scene: Scene, one: int, two: int, direction: Array) -> bool:
    """Whether parts are beside each other at some place along a direction."""
    spans = [scene.span(part, direction) for part in (one, two)]
    return min(high for _, high in spans) > max(low for low, _ in spans)


def _is_pitch(share: float, one: Gear, two: Gear) -> bool:
    """Whether the tips of two gears are as far beyond their pitch circles as those of teeth, for half a module [m]."""
    return all(_ADDENDUM[0] < 0.5 * (gear.radius / share - gear.teeth) < _ADDENDUM[1] for gear in (one, two))
