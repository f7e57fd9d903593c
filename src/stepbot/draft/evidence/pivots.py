"""Pivots: the lines that parts are held on, each with the pins, screws, washers and bearings on it.

Knuckle hinges: two parts whose bores alternate along one line, as those of a lid and its box on one pin.
"""

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.contacts import CoaxialLine, FitKind, LineFace, Pair
from stepbot.draft.contacts.shafts import HALF_ROUND, HOLE_RATIO, neighbours_on
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Evidence, JointEvidence
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.geometry.spatial import perpendicular_frame
from stepbot.robot.model import JointKind
from stepbot.step.features.axes import ANGLE_TOLERANCE
from stepbot.step.features.axis_contacts import ENGAGED, LOOSEST, SLACK_SHARE, TIGHTEST
from stepbot.step.features.coaxial import Rays, coaxial

_AXLE = 0.05
"""Share of the assembly's volume up to which a turned part on a line is its pin, spacer or bearing."""
_CLIP, _RING = 2e-3, 2.5
"""The same for an open ring, and its outer radius in radii of its bore."""
_HOLE, _WIDEST_HOLE = 0.17, 7e-3
"""Clearance of the medium hole for a screw (ISO 273), as a share of its radius; the radius [m] of the widest."""
_THREAD = 0.285
"""Interference of a screw drawn as wide as its thread in the hole that it is tapped in (ISO 724), likewise."""
_REVIEW = "bores that alternate along one line: a hinge, unless something else holds it"
_SCORE = 0.91
"""Above that of faces that lock two parts: a closed lid lies on its box."""
_SCREWED = 0.89
"""Score of the weld of parts that several screws reach through: above that of a bearing."""
_KNUCKLES = 4
"""Number of bores that alternate, from which they are knuckles and not a fork with a bolt."""
_FORK = 3
"""Number of bores of one of several equal hinges on one line, which have enough together."""
_ONE_PIN = 1e-5
"""Difference of radii [m] up to which bores are for one pin."""


class Pivot(Struct, frozen=True, eq=False):
    """Parts that are held on one line, in their order along it."""

    axis: Axis
    hosts: tuple[int, ...]
    axles: tuple[int, ...] = ()
    """Pins, spacers and bearings on the line."""
    turns: bool = True
    """Whether they are fitted on the line; a seal between two faces only holds them."""


def find_pivots(survey: Survey) -> list[Pivot]:
    """The lines that two parts or more are fitted on, which pins and screws may join."""
    fitted: dict[int, list[Pair]] = defaultdict(list)
    for pair, fits in survey.contacts.fits.items():
        for fit in fits:
            if fit.kind != FitKind.FLUSH and fit.full:
                fitted[id(fit.axis.direction)].append(pair)  # which all fits on a line share
    return [
        pivot
        for line in survey.contacts.lines
        for pivot in _pivots(survey, line, fitted.get(id(line.axis.direction)) or list(_loose_pins(survey, line)))
    ]


def _loose_pins(survey: Survey, line: CoaxialLine) -> Iterator[Pair]:
    """Pairs of a pin and what it is in with the clearance of a bolt's hole, wider than that of a fit.

    Screws have such holes where they clamp, too.
    """
    bores = [(f, i) for i, faces in line.faces.items() for f in faces if f.bore and not f.cone and f.span > HALF_ROUND]
    pins = {
        i: faces for i, faces in line.faces.items() if i not in survey.small and survey.parts[i].is_balanced(line.axis)
    }
    shafts = [(f, i) for i, faces in pins.items() for f in faces if not f.bore and not f.cone]
    for bore, i in bores:
        for shaft, j in shafts if bore.radius < _WIDEST_HOLE else ():
            slack = (bore.radius - shaft.radius) / bore.radius
            if i != j and 0.0 < slack < _HOLE and min(bore.high, shaft.high) - max(bore.low, shaft.low) > bore.radius:
                yield min(i, j), max(i, j)


def in_holes(survey: Survey, screw: int, axis: Axis) -> list[int]:
    """The larger parts that a screw on an axis goes through with the clearance of its hole."""
    on = (line for line in survey.contacts.lines if screw in line.faces and line.axis.same(axis))
    return [i for line in on for i in _holes_around(survey, screw, line)]


def _holes_around(survey: Survey, screw: int, line: CoaxialLine, interference: float = 0.0) -> Iterator[int]:
    """The larger parts that a screw on a line goes through with the clearance of its hole, or an interference."""
    shanks = [f for f in line.faces[screw] if not f.bore and not f.cone]
    for i, faces in line.faces.items():
        bores = [f for f in faces if f.bore and f.span > HALF_ROUND and i not in survey.small]
        if any(
            -interference * bore.radius < bore.radius - shank.radius < _HOLE * bore.radius
            and min(bore.high, shank.high) - max(bore.low, shank.low) >= ENGAGED
            for bore in bores
            for shank in shanks
        ):
            yield i


def _pivots(survey: Survey, line: CoaxialLine, fitted: Sequence[Pair]) -> Iterator[Pivot]:
    """The groups of parts that are fitted on each other on a line, by the pairs of them."""
    touching = Clusters(sorted({i for pair in fitted for i in pair}))
    for a, b in fitted:
        touching.join(a, b)
    for members in touching.groups().values():
        hosts = [i for i in members if not _is_axle(survey, i, line.axis)]
        if len(hosts) >= 2:
            middle = {i: min(f.low for f in line.faces[i]) + max(f.high for f in line.faces[i]) for i in hosts}
            ordered = sorted(hosts, key=lambda i: (round(middle[i], 6), i))
            at = 0.25 * (middle[ordered[0]] + middle[ordered[-1]])
            axles = tuple(i for i in members if i not in hosts)
            if axles and _are_gaskets(survey, line, members, axles):
                continue
            yield Pivot(Axis(line.axis.point + line.axis.d * at, line.axis.d), tuple(ordered), axles)


def _are_gaskets(survey: Survey, line: CoaxialLine, members: Sequence[int], axles: Sequence[int]) -> bool:
    """Whether rings that nothing is in are all that is between parts on a line, as gaskets between flanges."""
    if any(all(not f.bore for f in line.faces[i]) for i in axles):
        return False
    fits = (fit for i in members for r in survey.near.get(i, ()) for fit in r.shafts)
    return not any(fit.axis.same(line.axis) for fit in fits)


def spaced_pivots(survey: Survey) -> Iterator[Pivot]:
    """Holes in line, or a hole and a round end, with a gap between them.

    A pin crosses it that is not drawn, with its spacers or washers. The gap is no longer than either is deep, or the
    pin would be guided in neither; the lines are as far apart as the play of a pin allows.
    """
    ends = [
        (line.axis, f, i)
        for line in survey.contacts.lines
        for i, faces in line.faces.items()
        for f in (_eyes(faces) if i not in survey.small else ())
    ]
    middles = [axis.point + axis.d * (0.5 * (f.low + f.high)) for axis, f, _ in ends]
    rays = Rays(np.array(middles).reshape(-1, 3), np.array([axis.d for axis, _, _ in ends]).reshape(-1, 3))
    for rows in coaxial(rays, LOOSEST, ANGLE_TOLERANCE):
        d, half = ends[rows[0]][0].d, {n: 0.5 * (ends[n][1].high - ends[n][1].low) for n in rows.tolist()}
        ordered = sorted(half, key=lambda n: (round(float(middles[n] @ d), 6), ends[n][2]))
        for n, m in pairwise(ordered):
            (_, one, a), (_, two, b) = ends[n], ends[m]
            gap = float((middles[m] - middles[n]) @ d) - half[n] - half[m]
            wide, thin = max(one.radius, two.radius), min(one.radius, two.radius)
            if a == b or not -TIGHTEST < gap < 2.0 * min(half[n], half[m]) + TIGHTEST or wide >= HOLE_RATIO * thin:
                continue
            slack = max(TIGHTEST, min(LOOSEST, SLACK_SHARE * thin))
            if (one.bore or two.bore) and Axis(middles[n], d).distance(middles[m]) < slack:
                yield Pivot(Axis(0.5 * (middles[n] + middles[m]), d), (a, b))


def _eyes(faces: Sequence[LineFace]) -> list[LineFace]:
    """The bores of a part on a line, of a stepped one the narrowest, which hold a pin; else its round ends."""
    full = [f for f in faces if not f.cone and f.span > HALF_ROUND]
    bores = [f for f in full if f.bore]
    least = min((f.radius for f in bores), default=0.0)
    return [f for f in bores if f.radius < least + TIGHTEST] or full


def held_by_faces(survey: Survey) -> Iterator[Pivot]:
    """Parts that a disk or seal between them, which is on no pin itself, touches about one axis."""
    for i in survey.parts:
        if any(r.fits for r in survey.near.get(i, ())):
            continue
        about = [(other, r.turns) for other, r in survey.around(i) if r.turns is not None]
        for n, (a, axis) in enumerate(about):
            yield from (Pivot(axis, (a, b), turns=False) for b, other in about[n + 1 :] if axis.same(other))


def _is_axle(survey: Survey, i: int, axis: Axis) -> bool:
    """Whether a part is a pin, a screw, a washer or a bearing on a line, and not what turns on it."""
    part = survey.parts[i]
    if i in survey.small or Role.BEARING in part.roles:
        return True
    fits = (fit for r in survey.near.get(i, ()) for fit in r.fits if fit.kind != FitKind.FLUSH and fit.full)
    if any(not fit.axis.same(axis) for fit in fits):
        return False  # what something else is held on is no pin
    if part.is_balanced(axis):
        return 0.0 < part.volume < _AXLE * survey.volume
    return 0.0 < part.volume < _CLIP * survey.volume and _is_ring(survey, i, axis)


def _is_ring(survey: Survey, i: int, axis: Axis) -> bool:
    """Whether a part is hardly wider than its bore, as a circlip or a spring washer, which are open rings."""
    bores = [fit.radius for r in survey.near.get(i, ()) for fit in r.shafts if fit.shaft != i and fit.axis.same(axis)]
    across = perpendicular_frame(axis.d)[:, :2].T
    ends = [abs(end - float(axis.point @ d)) for d in across for end in survey.scene.span(i, d)]
    return bool(bores) and max(ends) < _RING * max(bores)


@rule(20)
def knuckle_evidence(survey: Survey, evidence: Evidence) -> None:
    """Add a joint for each pair of parts with knuckles on one line, and on no other."""
    for line in survey.contacts.lines:
        parts = {i for i in line.faces if i not in survey.small and survey.parts[i].volume > 0.0}
        parts = {i for i in parts if Role.BEARING not in survey.parts[i].roles}
        # Bores that alternate are beside each other.
        runs = {(a, b): _alternations(line, a, b) for a, b in neighbours_on(line) if parts.issuperset((a, b))}
        kinds = Counter(survey.equal.kinds(pair) for pair, count in runs.items() if count >= _FORK)
        for (a, b), count in runs.items():
            least = _FORK if kinds[survey.equal.kinds((a, b))] > 1 else _KNUCKLES
            if count < least or _other_lines(survey, line, a, b):
                continue
            middle = min(f.low for f in line.faces[a])
            axis = Axis(line.axis.point + line.axis.d * middle, line.axis.d)
            relation = survey.relation(a, b)
            why = "knuckles that alternate on one line"
            evidence.joint(JointEvidence(_SCORE, a, b, JointKind.REVOLUTE, axis, why, relation, review=_REVIEW))


def _alternations(line: CoaxialLine, a: int, b: int) -> int:
    """Number of runs of bores of one radius along a line, by turns of both parts; none if they overlap."""
    bores = [(f.low, f.high, f.radius, i) for i in (a, b) for f in line.faces[i] if f.bore and f.span > HALF_ROUND]
    bores = [row for row in sorted(bores) if not bores or abs(row[2] - bores[0][2]) < _ONE_PIN]
    if any(here[1] > after[0] + _ONE_PIN for here, after in pairwise(bores)):
        return 0
    owners = [row[3] for row in bores]
    return 1 + sum(one != two for one, two in pairwise(owners)) if owners else 0


def _other_lines(survey: Survey, line: CoaxialLine, a: int, b: int) -> bool:
    """Whether fits on other lines hold both parts."""
    relation = survey.relation(a, b)
    return relation is not None and any(not fit.axis.same(line.axis) for fit in relation.fits)


def screwed(survey: Survey) -> dict[Pair, list[Axis]]:
    """The lines of the screws that are through or in two parts each."""
    through: dict[Pair, list[Axis]] = defaultdict(list)
    for line in survey.contacts.lines:
        for screw in sorted(survey.small.intersection(line.faces)):
            fitted = {other for other, r in survey.around(screw) if any(f.axis.same(line.axis) for f in r.shafts)}
            for pair in combinations(sorted(fitted.union(_holes_around(survey, screw, line, _THREAD))), 2):
                if not any(line.axis.same(axis) for axis in through[pair]):
                    through[pair].append(line.axis)
    return through


@rule(90)
def screwed_evidence(survey: Survey, evidence: Evidence) -> None:
    """Two parts with several screws through or in both are one, also across spacers or gaskets."""
    for (a, b), axes in screwed(survey).items():
        if len(axes) > 1:
            evidence.weld(_SCREWED, a, b, f"{len(axes)} screws through both")
