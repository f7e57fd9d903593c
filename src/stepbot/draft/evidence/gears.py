"""Gears and racks by their teeth, gears and pulleys by name: which ones mesh, what they move on, and their ratio."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import pi

from stepbot.draft.contacts.survey import Survey
from stepbot.draft.contacts.teeth import Rack
from stepbot.draft.evidence.evidence import Apart, Evidence, JointEvidence
from stepbot.draft.parts.axis import PARALLEL, Axis
from stepbot.draft.parts.names import Role, is_belt
from stepbot.draft.parts.parts import box_gap
from stepbot.geometry.spatial import Array, cross
from stepbot.robot.model import JointKind

_REVIEW = "a gear that meshes with another one; no shaft is drawn"
_OF_RACK = "a rack that meshes with a gear: it slides along its teeth"
_SCORE, _APART, _KEYED = 0.7, 0.8, 0.9
"""Scores of a joint of a gear, of two gears that mesh being no link, and of a gear on a shaft that turns."""
_BEYOND = 6e-3
"""Gap [m] along its axis from a gear to a round face, up to which an undrawn shaft may be in both."""
_MESHED = 0.8
"""Ratio of the distance of two axes and the sum of the outer radii, from which teeth mesh up to where they touch."""
_TEETH = 1.15
"""The same ratio up to which they do, where the round faces are those at the roots of the teeth."""
_ADDENDUM = (0.2, 1.5)
"""Distance from the pitch circle to the tips of teeth, in modules: 1 of a standard gear, less with chamfers."""
_ALONG = 1e-2
"""Cosine up to which a face lets a rack slide."""
SAME_GEAR = 3e-4
"""Distance [m] up to which the axis of a gear is that of a joint."""


@dataclass(frozen=True, eq=False)
class Gear:
    """A part with teeth, or named a gear or a pulley, and its outer circle."""

    part: int
    axis: Axis
    radius: float
    """[m]."""
    teeth: int = 0
    """Number of drawn teeth all around, of which a sector has fewer; 0 if they are not drawn."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Two gears that mesh, or two pulleys with one belt."""

    one: Gear
    two: Gear
    belt: str = ""
    """Path of the belt; empty for teeth."""

    def pitch_radii(self) -> tuple[float, float]:
        """Radii [m] of both pitch circles, which touch: teeth are as high on both gears."""
        if self.belt:
            return self.one.radius, self.two.radius
        away = self.one.axis.distance(self.two.axis.point)
        if self.are_counted:
            share = away / (self.one.teeth + self.two.teeth)
            return share * self.one.teeth, share * self.two.teeth
        excess = 0.5 * (self.one.radius + self.two.radius - away)
        return self.one.radius - excess, self.two.radius - excess

    @property
    def are_counted(self) -> bool:
        """Whether the teeth of both are drawn."""
        return not self.belt and self.one.teeth > 0 and self.two.teeth > 0


@dataclass(frozen=True, eq=False)
class RackMesh:
    """A gear that meshes with a rack."""

    gear: Gear
    part: int
    rack: Rack
    radius: float
    """Of the gear's pitch circle [m]."""

    def advance(self, axis: Array, direction: Array) -> float:
        """What the rack moves along a direction while the gear turns about an axis, both unit vectors [m/rad]."""
        return float(cross(axis, -self.radius * self.rack.out) @ direction)


def rack_meshes(survey: Survey) -> Iterator[RackMesh]:
    """All gears that mesh with racks: of one module, and as far apart as pitch circle and pitch line."""
    for gear in _gears(survey) if survey.racks else ():
        for part, rack in survey.racks.items():
            module, away = rack.pitch / pi, gear.axis.point - rack.point
            radius = 0.5 * module * gear.teeth
            tips = (gear.radius - radius) / module, (radius - float(away @ rack.out)) / module
            spans = [survey.scene.span(i, gear.axis.d) for i in (gear.part, part)]
            if (
                gear.teeth
                and part != gear.part
                and all(abs(float(gear.axis.d @ line)) < PARALLEL for line in (rack.along, rack.out))
                and min(high for _, high in spans) > max(low for low, _ in spans)
                and abs(float(away @ rack.along)) < 0.5 * rack.length + radius
                and all(_ADDENDUM[0] < tip < _ADDENDUM[1] for tip in tips)
            ):
                yield RackMesh(gear, part, rack, radius)


def meshes(survey: Survey) -> list[Mesh]:
    """All pairs of gears that mesh, and of pulleys with one belt."""
    gears = list(_gears(survey))
    belts = [part for part in survey.parts.values() if is_belt(part.name) and survey.sources.names]
    found = []
    for one, two in combinations(gears, 2):
        if not one.axis.is_along(two.axis.d):
            continue
        away, reach = one.axis.distance(two.axis.point), one.radius + two.radius
        spans = [survey.scene.span(gear.part, one.axis.d) for gear in (one, two)]
        if min(high for _, high in spans) <= max(low for low, _ in spans):
            continue
        if one.teeth and two.teeth:
            if away > 0.0 and _is_pitch(away / (one.teeth + two.teeth), one, two):
                found.append(Mesh(one, two))
        elif _MESHED * reach < away < _TEETH * reach:
            found.append(Mesh(one, two))
        elif away >= _TEETH * reach:
            boxes = [survey.parts[gear.part].box for gear in (one, two)]
            around = (b for b in belts if all(box_gap(b.box, box) == 0.0 for box in boxes))
            belt = next(around, None)
            if belt is not None:
                found.append(Mesh(one, two, belt.path))
    return found


def _is_pitch(share: float, one: Gear, two: Gear) -> bool:
    """Whether the tips of two gears are as far beyond their pitch circles as those of teeth, for half a module [m]."""
    return all(_ADDENDUM[0] < 0.5 * (gear.radius / share - gear.teeth) < _ADDENDUM[1] for gear in (one, two))


def _gears(survey: Survey) -> Iterator[Gear]:
    for i, part in survey.parts.items():
        if i in survey.small or is_belt(part.name):
            continue
        rims = survey.rims.get(i, ())
        yield from (Gear(i, rim.axis, rim.tip, rim.teeth) for rim in rims)
        if rims or Role.GEAR not in part.roles:
            continue
        best: Gear | None = None
        for line in survey.contacts.lines:
            outer = [f.radius for f in line.faces.get(i, ()) if not f.bore]
            if outer and (best is None or max(outer) > best.radius):
                best = Gear(i, line.axis, max(outer))
        if best is not None:
            yield best


def gear_evidence(survey: Survey, found: Evidence) -> None:
    """Add what gears indicate.

    Those that mesh move relative to each other. One without a shaft turns on the part with a round face on its line
    nearby. One on a shaft that turns, driven or in a bearing, is fixed to it.
    """
    _fix_to_shafts(survey, found)
    for pair in rack_meshes(survey):
        a, b = sorted((pair.gear.part, pair.part))
        found.apart.append(Apart(_APART, a, b))
        guide = _guide(survey, pair)
        if guide is not None:
            a, b = sorted((guide, pair.part))
            axis = Axis(pair.rack.point, pair.rack.along)
            why = f"the rack '{survey.parts[pair.part].path}' meshes with '{survey.parts[pair.gear.part].path}'"
            found.joint(JointEvidence(_APART, a, b, JointKind.PRISMATIC, axis, why, review=_OF_RACK))
    held = {i for h in found.joints for i in (h.a, h.b) if h.drives}
    found_meshes = meshes(survey)
    for mesh in found_meshes:
        a, b = sorted((mesh.one.part, mesh.two.part))
        found.apart.append(Apart(_APART, a, b))
    for gear in {gear.part: gear for mesh in found_meshes for gear in (mesh.one, mesh.two)}.values():
        on_axis = any(r.turns is not None and r.turns.same(gear.axis) for r in survey.near.get(gear.part, ()))
        host = None if on_axis or gear.part in held else _host(survey, gear)
        if host is not None:
            a, b = sorted((gear.part, host))
            why = f"the gear '{survey.parts[gear.part].path}' turns about its own axis"
            found.joint(JointEvidence(_SCORE, a, b, JointKind.REVOLUTE, gear.axis, why, review=_REVIEW))


def _guide(survey: Survey, mesh: RackMesh) -> int | None:
    """The part that a rack lies on, and that nothing but faces along its teeth holds; the one with most area."""
    along, ranked = mesh.rack.along, []
    for other, r in survey.around(mesh.part):
        is_free = all(abs(float(patch.normal @ along)) < _ALONG for patch in r.patches) and not r.sockets
        if other != mesh.gear.part and r.patches and is_free and all(fit.axis.is_along(along) for fit in r.fits):
            ranked.append((-round(r.area, 9), other))
    return min(ranked)[-1] if ranked else None


def _fix_to_shafts(survey: Survey, found: Evidence) -> None:
    turning = [h for h in found.joints if h.drives or h.through >= 0]
    for gear in _gears(survey):
        for shaft, r in survey.around(gear.part):
            if not r.shafts or max(r.shafts, key=lambda fit: fit.length).shaft != shaft:
                continue
            if any(shaft in (h.a, h.b) and gear.part not in (h.a, h.b) and h.axis.same(gear.axis) for h in turning):
                found.weld(_KEYED, gear.part, shaft, "a gear on a shaft that turns")


def _host(survey: Survey, gear: Gear) -> int | None:
    """The part whose round face on the line of a gear is nearest to it."""
    low, high = survey.scene.span(gear.part, gear.axis.d)
    ranked = []
    for line in survey.contacts.lines:
        if not line.axis.same(gear.axis):
            continue
        for part, faces in line.faces.items():
            if part == gear.part or part in survey.small or Role.GEAR in survey.parts[part].roles:
                continue
            spans = [sorted(_heights(line.axis, gear.axis, (f.low, f.high))) for f in faces]
            gap = min(max(0.0, bottom - high, low - top) for bottom, top in spans)
            if gap < _BEYOND:
                ranked.append((round(gap, 6), -survey.parts[part].volume, part))
    return min(ranked)[-1] if ranked else None


def _heights(line: Axis, axis: Axis, positions: Sequence[float]) -> list[float]:
    """Positions [m] along a line as heights along the direction of an axis."""
    return [float((line.point + line.d * at) @ axis.d) for at in positions]


def mesh_between(found: Sequence[Mesh], one: Sequence[int], two: Sequence[int], axes: tuple[Axis, Axis]) -> Mesh | None:
    """The mesh of gears of two bodies, each on the axis that its body turns about; the first body's gear is first."""
    for mesh in found:
        for first, second in ((mesh.one, mesh.two), (mesh.two, mesh.one)):
            on_axes = axes[0].same(first.axis, SAME_GEAR) and axes[1].same(second.axis, SAME_GEAR)
            if on_axes and first.part in one and second.part in two:
                return Mesh(first, second, mesh.belt)
    return None


def mark_geared(survey: Survey, joints: Sequence[tuple[JointEvidence, Sequence[int], Sequence[int]]]) -> None:
    """Mark the joints about the axes of gears that mesh; each is given with the parts of both of its links."""
    gears = [gear for mesh in meshes(survey) for gear in (mesh.one, mesh.two)]
    for h, *sides in joints:
        turns = h.type == JointKind.REVOLUTE
        h.is_geared = turns and any(
            gear.part in side and gear.axis.same(h.axis, SAME_GEAR) for gear in gears for side in sides
        )
