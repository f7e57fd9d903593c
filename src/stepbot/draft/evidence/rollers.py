"""Rollers of omnidirectional wheels: equal round bodies around a hub that turn about axes of their own.

Rollers touch nothing, as often drawn without their pins, or are held about their own axes alone. These are normal to
the hub's radius and inclined to its axis: those of bearing rollers and spacers are parallel to it, those of spokes and
dowels are along the radius.

Wheels of a carriage run on both sides of a long body, in its grooves or on its edges: the carriage slides along it.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.concentric import fitted_circle
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.draft import CHOSEN
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import BY_SHAPE, Apart, Evidence, JointEvidence, Priority, Weld
from stepbot.draft.evidence.wheels import TREAD
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.parts import Boxes
from stepbot.geometry.spatial import Array, cross, unit
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Body
from stepbot.step.faces import FaceKind

_FEWEST = 4
"""Number of rollers from which a pattern counts."""
_EVEN = 0.01
"""Tolerance of a pattern: share of its radius, and of the volume of a roller."""
_ACROSS, _INCLINED = 0.02, 0.3
"""Cosine of the angle to the radius, up to which an axis is normal to it; sine of the least angle to the hub's axis."""
_CIRCLE = 1e-6
"""Tolerance of :func:`fitted_circle` for an outline."""
_BESIDE = 0.5
"""Gap between a roller and its hub, as a share of the roller's size."""
_LARGEST = 0.05
"""Share of the assembly's volume up to which a body may be a roller."""
_PIN = 0.78
"""Score of the weld of a roller's pin and its hub."""
_HELD = "held about its own axis alone: it may be fastened there"
"""What to review of each roller that touches something."""
REVIEW = "wheels on both sides of it: it may be fastened otherwise"
"""What to review of each slide on wheels."""
_ON_RAIL, _OFF_RAIL = 0.77, 0.785
"""Score of a slide on wheels, and that which keeps its wheels apart from the rail."""
_FEWEST_WHEELS = 3
"""Number of wheels that hold a carriage on a rail."""
_CLEAR = 0.05
"""Gap between rim and rail, as a share of the wheel's radius, up to which it runs on it."""


class _Roller(Struct, frozen=True, eq=False):
    part: int
    axis: Axis
    """Through its centroid."""
    volume: float
    held_by: tuple[int, ...]
    """Larger parts that it touches, such as its pin."""


def _may_hold(survey: Survey, hub: int, roller: _Roller) -> bool:
    """Whether nothing holds a roller, or the hub, or a part that touches the hub."""
    return not roller.held_by or any(i == hub or survey.relation(hub, i) is not None for i in roller.held_by)


@rule(190)
def roller_evidence(survey: Survey, evidence: Evidence) -> None:
    """Add the joints of all patterns of rollers, and their hubs as wheels."""
    free = [roller for i in survey.parts if (roller := _roller(survey, i)) is not None]
    sizes = _BESIDE * np.array([survey.parts[roller.part].size for roller in free])
    boxes = Boxes(np.array([survey.parts[roller.part].box for roller in free]).reshape(-1, 2, 3))
    taken: set[int] = set()
    pinned: list[Axis] = []
    """The axes of rollers."""
    for hub in sorted(survey.turned, key=lambda i: (-survey.parts[i].volume, i)):
        if len(free) - len(taken) < _FEWEST:
            return
        if hub in survey.small:
            continue
        # Only close ones: several wheels may be on one axis.
        near, gaps = boxes.within(survey.parts[hub].box, float(sizes.max()))
        around = [free[k] for k in near[gaps < sizes[near]].tolist() if free[k].part not in taken]
        for axis in survey.turned[hub] if len(around) >= _FEWEST else ():
            low, high = survey.scene.span(hub, axis.d)
            level = [
                one for one in around if low < float(one.axis.point @ axis.d) < high and _may_hold(survey, hub, one)
            ]
            # The larger ones first: their pins are in them.
            for rollers in sorted(_patterns(level, axis), key=lambda some: -some[0].volume):
                if any(roller.axis.same(known) for roller in rollers for known in pinned):
                    continue
                taken.update(roller.part for roller in rollers)
                pinned += [roller.axis for roller in rollers]
                evidence.wheels[hub] = axis
                why = f"one of {len(rollers)} equal rollers around '{survey.parts[hub].path}'"
                for roller in rollers:
                    a, b = sorted((hub, roller.part))
                    review = _HELD if survey.near.get(roller.part) else BY_SHAPE
                    hinge = JointEvidence(
                        0.6, a, b, JointKind.REVOLUTE, roller.axis, why, of_roller=True, review=review
                    )
                    hinge.priority = Priority.NEEDED
                    evidence.joint(hinge)
                    evidence.welds += [
                        Weld(_PIN, min(hub, pin), max(hub, pin), "a pin of a roller", priority=Priority.NEEDED)
                        for pin in roller.held_by
                        if pin != hub and survey.relation(hub, pin) is not None
                    ]


@rule(200)
def rail_evidence(survey: Survey, evidence: Evidence) -> None:
    """Add a slide for each body whose wheels run on both sides of another one, longer than their row."""
    carried: dict[int, dict[int, Axis]] = defaultdict(dict)
    for h in evidence.joints:
        if h.type == JointKind.REVOLUTE and h.score >= CHOSEN:
            for wheel, carriage in ((h.a, h.b), (h.b, h.a)):
                if survey.parts[wheel].is_balanced(h.axis, TREAD) and not survey.parts[carriage].is_balanced(h.axis):
                    carried[carriage][wheel] = h.axis
    for carriage, wheels in carried.items():
        first = next(iter(wheels.values()))
        wheels = {i: axis for i, axis in wheels.items() if axis.is_along(first.d)}
        near = survey.parts_near(survey.box_of(wheels), 0.0) if len(wheels) >= _FEWEST_WHEELS else []
        for rail in sorted(i for i in near if i not in {carriage, *wheels, *survey.small}):
            along = _runs_along(survey, rail, wheels)
            if along is not None:
                a, b = sorted((carriage, rail))
                why = f"{len(wheels)} wheels on both sides of a rail"
                evidence.joint(JointEvidence(_ON_RAIL, a, b, JointKind.PRISMATIC, along, why, review=REVIEW))
                evidence.apart.extend(Apart(_OFF_RAIL, min(rail, i), max(rail, i)) for i in wheels)


def _runs_along(survey: Survey, rail: int, wheels: Mapping[int, Axis]) -> Axis | None:
    """The line along a body, on both sides of which all wheels with parallel axes run, two of them in a row."""
    turned = next(iter(wheels.values())).d
    frame = survey.scene.component(rail).X_WC.R
    spans = [survey.scene.span(rail, frame[:, k]) for k in range(3)]
    along = frame[:, max(range(3), key=lambda k: spans[k][1] - spans[k][0])]
    if abs(float(along @ turned)) > _ACROSS:
        return None
    side = unit(cross(turned, along))
    (start, end), (low, high), (bottom, top) = (survey.scene.span(rail, d) for d in (along, side, turned))
    rows: dict[int, list[float]] = {1: [], -1: []}
    for i in wheels:
        at, (near, far) = survey.parts[i].com, survey.scene.span(i, side)
        sign = 1 if float(at @ side) > 0.5 * (low + high) else -1
        outside = float(at @ side) - high if sign > 0 else low - float(at @ side)
        radius = 0.5 * (far - near)
        if not 0.0 < outside < (1.0 + _CLEAR) * radius or not bottom < float(at @ turned) < top:
            return None
        rows[sign].append(float(at @ along))
    every = sorted(rows[1] + rows[-1])
    is_row = max((max(row) - min(row) for row in rows.values() if row), default=0.0) > high - low
    if not rows[1] or not rows[-1] or not is_row or not start < every[0] < every[-1] < end:
        return None
    return Axis(survey.parts[rail].com, along)


def _roller(survey: Survey, index: int) -> _Roller | None:
    """A body that is symmetric about the axis of a round face or outline, and held about it alone, if at all."""
    part = survey.parts[index]
    if index in survey.small or not 0.0 < part.volume < _LARGEST * survey.volume:
        return None
    around = dict(survey.around(index))
    held = [relation.turns for relation in around.values()]
    X = survey.scene.component(index).X_WC
    outlined = (Axis(X.apply(centre), X.turn(d)) for centre, d in survey.scene.of_definition(index, _outlined))
    for axis in (*survey.turned.get(index, ())[:3], *outlined):
        if part.is_balanced(axis) and all(line is not None and line.same(axis) for line in held):
            centre = axis.point + axis.d * float((part.com - axis.point) @ axis.d)
            return _Roller(index, Axis(centre, axis.d), part.volume, tuple(around))
    return None


def _outlined(body: Body) -> list[tuple[Array, Array]]:
    """Centres and directions of a body's planes with a round outline, in its own frame."""
    return [
        (circle[0], np.array(face.direction))
        for face in body.faces
        if face.kind == FaceKind.PLANE
        and face.rings
        and (circle := fitted_circle(face.rings[0], np.array(face.direction), _CIRCLE)) is not None
    ]


def _patterns(rollers: Sequence[_Roller], hub: Axis) -> Iterator[list[_Roller]]:
    """Rollers that are equal and evenly spaced on a circle about the hub's axis."""
    if len(rollers) < _FEWEST:
        return
    centres, axes = np.array([r.axis.point for r in rollers]), np.array([r.axis.d for r in rollers])
    heights = (centres - hub.point) @ hub.d
    spokes = centres - hub.point - np.outer(heights, hub.d)
    radii = np.linalg.norm(spokes, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        across = np.abs(np.einsum("ij,ij->i", axes, spokes)) < _ACROSS * radii
    along = np.abs(axes @ hub.d)
    volumes = np.array([r.volume for r in rollers])
    left = np.flatnonzero(across & (along < np.sqrt(1.0 - _INCLINED**2)))
    while len(left) >= _FEWEST:
        first = left[0]
        size = _EVEN * radii[first]
        alike = (np.abs(radii[left] - radii[first]) < size) & (np.abs(heights[left] - heights[first]) < size)
        alike &= np.abs(volumes[left] - volumes[first]) < _EVEN * volumes[first]
        alike &= np.abs(along[left] - along[first]) < _EVEN
        rows = left[alike]
        if len(rows) >= _FEWEST and _is_even(spokes[rows], radii[first]):
            yield [rollers[k] for k in rows.tolist()]
        left = left[~alike]


def _is_even(spokes: Array, radius: float) -> bool:
    """Whether vectors (n, 3) from the axis to rollers cancel out, as those of an even pattern do."""
    return float(np.linalg.norm(spokes.mean(axis=0))) < _EVEN * radius
