"""Wheels: round bodies that an assembly stands on, by their shape, or that are named so; and what they turn in.

Turned bodies whose axes are parallel to the ground and whose rims touch it, while all else is above, are wheels, if two
of them are equal: the wheel of a caster has a radius of its own. A wheel on an axle, a bolt or a shaft touches its fork
about that line alone: by itself such a line could be clamped, but a wheel turns.
"""

from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from itertools import product

import numpy as np

from stepbot.draft.contacts.freedom import FreedomKind
from stepbot.draft.contacts.relations import Relation
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Evidence, JointEvidence
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.scene import own_axes
from stepbot.geometry.spatial import Array, cross, perpendicular_frame
from stepbot.robot.model import JointKind
from stepbot.step.faces import FaceKind

REVIEW = "a wheel that one line holds: it may be clamped"
"""What to review of each such joint."""
_REVIEW_SWIVEL = "the swivel of a caster, which one line holds: it may be clamped"
_SCORE = 0.79
TREAD = 3.0
"""How far a tread may be from symmetric, in tolerances of a turned part."""
_FLAT, _EQUAL = 0.01, 0.01
"""Shares of the radius: how far a rim may be from the ground, and from the radius of another one."""
_WIDEST = 3.0
"""Width in radii up to which a round body is a wheel, not a roll or a shaft."""
_SLIGHT = 0.02
"""Share of the assembly's volume up to which what is on the ground beside wheels is a skid or a ball."""
_TRAIL = 2e-3
"""Distance [m] of a caster's wheel from the line of its swivel, from which it trails."""
_ROLLERS = 4
"""Number of wheels in several directions on one part, from which they are rollers around a hub."""
_SHARE = 0.2
"""Share of a link's volume from which a wheel in it makes it one."""
_TYRE, _THIN, _COVERED = 0.92, 0.5, 0.75
"""Score of the weld of a tyre; least shares of its outer radius, and of both widths, that its bore and its fit have."""
_PAIR = 2
"""Number of feet on one plane that wheels may have beside them, though no more wheels roll."""
_LEAST = 1e-3
"""Share of the assembly's volume from which a round body may be a wheel."""


def wheels(survey: Survey) -> dict[int, Axis]:
    """The axes of all wheels, by name or by shape."""
    axes = dict(rolling(survey))
    for i, part in survey.parts.items():
        if Role.WHEEL in part.roles and i not in survey.small and i not in axes:
            axis = _turned_about(survey, i)
            if axis is not None:
                axes[i] = axis
    return axes


def is_wheel(survey: Survey, known: Collection[int], members: Sequence[int], axis: Axis) -> bool:
    """Whether a considerable part of a link is a wheel that is turned about an axis."""
    parts = [survey.parts[i] for i in members if survey.parts[i].volume >= _SHARE * survey.total_volume(members)]
    return any(part.index in known and part.is_balanced(axis, TREAD) for part in parts)


@rule(30)
def wheel_evidence(survey: Survey, motors: Sequence[Motor], evidence: Evidence) -> None:
    """Add a joint for each wheel that is held about its axis alone by what is not turned about it."""
    driven = {h.b for h in evidence.joints if h.drives} | {i for motor in motors for i in motor.parts}
    of, hinges = wheels(survey), defaultdict(list)
    evidence.rolling = of
    for i, axis in of.items():
        if (rim := _rim_of(survey, i, axis)) is not None:
            evidence.weld(_TYRE, i, rim, "a tyre on its rim")
        for other, r in _held_by(survey, i, axis) if i not in driven else ():
            part = survey.parts[other]
            if other not in of and not part.is_balanced(axis, TREAD) and _turns_about(r, axis):
                a, b = sorted((i, other))
                why = "a wheel on one line"
                hinges[other].append(JointEvidence(_SCORE, a, b, JointKind.REVOLUTE, axis, why, r, review=REVIEW))
    for on_host in hinges.values():
        several = any(not h.axis.is_along(on_host[0].axis.d) for h in on_host)
        for h in on_host:
            h.of_roller = several and len(on_host) >= _ROLLERS
            evidence.joint(h)
    for host, (h, *others) in hinges.items():
        if not others and (swivel := _swivel(survey, host, h.axis)) is not None:
            evidence.joint(swivel)


def _swivel(survey: Survey, fork: int, wheel: Axis) -> JointEvidence | None:
    """The swivel of a caster: a line across its wheel's axis and off it, that alone holds its fork."""
    held = [(other, r) for other, r in survey.around(fork) if r.turns is None or not r.turns.same(wheel)]
    axis = next((r.turns for _, r in held if r.turns is not None and r.fits), None)
    if axis is None or abs(float(axis.d @ wheel.d)) > _FLAT:
        return None
    trail = abs(float(cross(axis.d, wheel.d) @ (axis.point - wheel.point)))
    if trail < _TRAIL or not all(_turns_about(r, axis) for _, r in held):
        return None
    held += [row for pin, _ in held for row in survey.around(pin) if row[0] != fork and _turns_about(row[1], axis)]
    top, r = max(held, key=lambda row: (survey.parts[row[0]].volume, -row[0]))
    a, b = sorted((fork, top))
    return JointEvidence(
        *(_SCORE, a, b, JointKind.REVOLUTE, axis, "a fork whose wheel is behind its pivot", r), review=_REVIEW_SWIVEL
    )


def _rim_of(survey: Survey, wheel: int, axis: Axis) -> int | None:
    """The rim that a tyre is around, about as wide as it, with play up to a hundredth; None for any other wheel."""
    around = list(survey.around(wheel))
    if len(around) != 1 or not _turns_about(around[0][1], axis):
        return None
    other, r = around[0]
    widths = [float(np.ptp(survey.scene.span(i, axis.d))) for i in (wheel, other)]
    is_tyre = any(
        fit.shaft == other
        and fit.radius > _THIN * _radius(survey, wheel, axis)
        and fit.length > _COVERED * max(widths)
        and fit.clearance < _FLAT * fit.radius
        for fit in r.shafts
    )
    return other if is_tyre else None


def _held_by(survey: Survey, wheel: int, axis: Axis) -> list[tuple[int, Relation]]:
    """What touches a wheel, else what holds the axle or the screw that it is on, with the relation of this."""
    around = list(survey.around(wheel))
    if any(not survey.parts[other].is_balanced(axis, TREAD) for other, _ in around):
        return around
    if not around:
        around = [(r.other(wheel), r) for r in survey.near.get(wheel, ()) if r.fits]
        if not all(_turns_about(r, axis) for _, r in around):
            return []  # bolted on
    return [row for axle, r in around if _turns_about(r, axis) for row in survey.around(axle) if row[0] != wheel]


def _turns_about(r: Relation, axis: Axis) -> bool:
    """Whether all that holds two parts is fitted on a line, or faces that are normal to it."""
    if not r.fits or not all(fit.axis.same(axis) for fit in r.fits):
        return False
    free = r.freedom
    return free.kind in (FreedomKind.REVOLUTE, FreedomKind.CYLINDRICAL) and all(
        axis.is_along(p.normal) for p in r.patches
    )


def _turned_about(survey: Survey, i: int) -> Axis | None:
    """The axis of a part that is as wide as a wheel may be, about which it is turned."""
    part = survey.parts[i]
    for axis in survey.turned.get(i, ())[:3]:
        if part.is_balanced(axis, TREAD):
            low, high = survey.scene.span(i, axis.d)
            return axis if high - low < _WIDEST * _radius(survey, i, axis) else None
    return None


def _radius(survey: Survey, i: int, axis: Axis) -> float:
    """Half of the width [m] of a part across an axis: the least of two directions, and of those that it is drawn along.

    What is around a rounded tread is tight along these.
    """
    drawn = [d for d in survey.scene.component(i).X_WC.R.T if abs(float(d @ axis.d)) < _FLAT]
    spans = (survey.scene.span(i, d) for d in (*perpendicular_frame(axis.d).T[:2], *drawn))
    return 0.5 * min(high - low for low, high in spans)


def rolling(survey: Survey) -> Iterator[tuple[int, Axis]]:
    """The wheels that an assembly stands on, by their shape, with their axes."""
    drawn = [i for i, part in survey.parts.items() if part.size and i not in survey.small]
    if len(drawn) < 3:
        return
    round_ones = {
        i: axis for i in drawn if survey.parts[i].volume > _LEAST * survey.volume and (axis := _turned_about(survey, i))
    }
    radii = {i: _radius(survey, i, axis) for i, axis in round_ones.items()}
    for up in _ups(survey, drawn) if len(round_ones) > 1 else ():
        heights = np.array([survey.scene.span(i, up)[0] for i in drawn])
        ground = float(heights.min())
        rolling = [i for i, axis in round_ones.items() if _rolls(axis, radii[i], up, ground)]
        equal = [i for i in rolling if any(j != i and abs(radii[i] - radii[j]) < _EQUAL * radii[i] for j in rolling)]
        if len(equal) < 2:
            continue
        near = _FLAT * max(radii[i] for i in equal)
        others = [
            i for i, height in zip(drawn, heights.tolist(), strict=True) if height < ground + near and i not in rolling
        ]
        # More of them than that end along their axes in flat faces on one plane: they stand on it, and are feet.
        feet = max(Feet(survey).count_beside([i], round_ones[i]) for i in equal)
        if survey.total_volume(others) <= _SLIGHT * survey.volume and feet <= max(_PAIR, len(rolling)):
            yield from ((i, round_ones[i]) for i in rolling)
            return


def _ups(survey: Survey, drawn: Sequence[int]) -> Iterator[Array]:
    """The directions that may be up: along the axes of the assembly, then along those of its largest part."""
    first = max(drawn, key=lambda i: (survey.parts[i].volume, -i))
    own = survey.scene.component(first).X_WC.R @ survey.scene.of_definition(first, own_axes)
    for k, sign in product((2, 1, 0), (1, -1)):
        yield sign * np.eye(3)[k]
    for k, sign in product((2, 1, 0), (1, -1)):
        if np.abs(own[:, k]).max() < 1.0 - _FLAT**2:
            yield sign * own[:, k]


def _rolls(axis: Axis, radius: float, up: Array, ground: float) -> bool:
    """Whether the rim of a round body touches the ground, and its axis is parallel to it."""
    height = float(axis.point @ up) - ground
    return abs(float(axis.d @ up)) < _FLAT and abs(height - radius) < _FLAT * radius


_GROUND_PLANE, _ALIGNED = 1e-4, 1e-9
"""Thickness of the ground plane, as a share of the assembly's size; cosine of an axis that boxes are along, less 1."""


class Feet:
    """The outermost parts of an assembly along any direction."""

    def __init__(self, survey: Survey) -> None:
        self._survey, self._near = survey, _GROUND_PLANE * survey.extent
        self._parts = [i for i, part in survey.parts.items() if part.size and i not in survey.small]
        self._boxes = np.array([survey.parts[i].box for i in self._parts]).reshape(-1, 2, 3)

    def below(self, sides: Clusters, axis: Axis) -> list[tuple[int, float]]:
        """The sides that alone reach one end of the assembly along an axis, with the radius [m] of their faces there.

        At most two, each by its representative.
        """
        below = []
        for d in (-axis.d, axis.d):
            level, last = self._last(d)
            roots = {sides.find(i) if i in sides else -1 for i in last}
            if len(roots) == 1 and -1 not in roots:
                below.append((roots.pop(), self._width(last, Axis(axis.point, d), level)))
        return below

    def count_beside(self, members: Sequence[int], axis: Axis) -> int:
        """The number of parts that end along an axis in flat faces where some parts do: feet on one ground."""
        most = 0
        for d in (-axis.d, axis.d):
            level, last = self._last(d)
            mine, down = last.intersection(members), Axis(axis.point, d)
            if mine and self._width(mine, down, level):
                most = max(most, sum(self._width({i}, down, level) > 0.0 for i in last))
        return most

    def _last(self, d: Array) -> tuple[float, set[int]]:
        """How far [m] the assembly reaches along a direction, and the parts that end there."""
        reach = np.maximum(self._boxes[:, 0] * d, self._boxes[:, 1] * d).sum(axis=1)
        if np.abs(d).max() < 1.0 - _ALIGNED:  # boxes reach further than what is in them
            best = -np.inf
            for k in np.argsort(-reach, kind="stable").tolist():
                if reach[k] <= best - self._near:
                    break
                reach[k] = self._survey.scene.span(self._parts[k], d)[1]
                best = max(best, reach[k])
        level = float(reach.max())
        return level, {self._parts[k] for k in np.flatnonzero(reach > level - self._near).tolist()}

    def _width(self, parts: set[int], down: Axis, level: float) -> float:
        """The largest distance [m] from an axis of plane faces on the ground, which it points to."""
        scene = self._survey.scene
        grounded = [
            placed
            for part in sorted(parts)
            for placed in scene.faces_of(part, FaceKind.PLANE)
            if down.is_along(placed.direction) and float((placed.point * down.d).sum()) > level - self._near
        ]
        rings = [ring for placed in grounded for ring in scene.outline(placed.part, placed.face)]
        return max((float(down.distances(ring).max()) for ring in rings), default=0.0)
