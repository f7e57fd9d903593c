"""The relation of each pair of parts in contact: its free motion, and the common axis of its contacts.

Pure geometry; roles, names and the tree come later.
"""

from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.draft.contacts.concentric import concentric_axis
from stepbot.draft.contacts.contacts import Contacts, Fit, FitKind, Pair, Patch, Socket
from stepbot.draft.contacts.freedom import Freedom, FreedomKind, freedom
from stepbot.draft.parts.axis import SAME_LINE, Axis
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array, perpendicular_frame

SPIGOT = 0.5
"""Length of a shaft in its bore, in radii, below which it is centred but not guided."""
_PLAY = 1e-5
"""Difference of radii [m] from which a shaft has play in its bore."""
_LEAST_SIZE = 5e-3
"""Minimum extent [m] of contacts, used to compare lengths with angles."""
_TURNED_RADIUS, _BORED_RADIUS, _MOST_LINES = 1e-3, 2.5e-3, 24
"""Minimum radius [m] of shafts and bores on a possible axis of a part, and the maximum number of such axes."""
_EVEN = 0.02
"""Angle [rad] up to which holes are evenly spaced."""


class Via(StrEnum):
    """Kinds of possible motion between two parts."""

    BALL = "ball"
    SLIDE = "slide"
    """Shafts in bores leave one direction free."""
    GROOVE = "groove"
    """Planes leave one direction free."""
    PIN = "pin"
    """A shaft in a bore."""
    BOLT = "bolt"
    """Two coaxial holes."""
    FACE = "face"
    """A round face on a face."""
    RING = "ring"
    """A flange: holes in a circle about the axis."""
    SEAM = "seam"
    """Surfaces about one axis that do not touch."""
    NOTHING = ""


class Relation(Struct, frozen=True, eq=False):
    """Two parts, a < b, that touch or share a line."""

    a: int
    b: int
    fits: tuple[Fit, ...]
    patches: tuple[Patch, ...]
    sockets: tuple[Socket, ...]
    freedom: Freedom
    via: Via = Via.NOTHING
    axis: Axis | None = None
    """The axis of rotation or translation; None if there is none."""
    ring: int = 0
    """Number of holes in a circle about ``axis``."""
    ring_radius: float = 0.0
    length: float = 0.0
    """Engaged length [m] of the shaft in its bore."""
    radius: float = 0.0
    """Radius [m] of the fits on the axis."""

    def other(self, part: int) -> int:
        """The part on the other side."""
        return self.b if part == self.a else self.a

    @property
    def area(self) -> float:
        """[m^2] in contact."""
        return exact_sum(patch.area for patch in self.patches)

    @property
    def holes(self) -> int:
        """Number of coaxial pairs of holes."""
        return sum(fit.kind == FitKind.HOLES for fit in self.fits)

    @property
    def shafts(self) -> list[Fit]:
        """Shafts in bores."""
        return [fit for fit in self.fits if fit.kind == FitKind.SHAFT]

    @property
    def journals(self) -> list[Fit]:
        """Shafts on the axis that are guided all around, and drawn thinner than their bores."""
        guided = [fit for fit in self.shafts if fit.full and fit.length >= SPIGOT * fit.radius]
        loose = [fit for fit in guided if fit.clearance > _PLAY]
        return [fit for fit in loose if self.via == Via.PIN and (fit.radius_a < fit.radius_b) == (fit.shaft == fit.a)]

    @property
    def guided(self) -> float:
        """Length [m] over which a shaft is guided."""
        return max((fit.guided for fit in self.shafts), default=0.0)

    @property
    def is_piston(self) -> bool:
        """Whether a shaft with play has room to travel in a bore that is longer than it, and no face stops it."""
        return self.freedom.kind == FreedomKind.CYLINDRICAL and any(
            fit.full and fit.clearance > _PLAY and fit.travel >= max(fit.length, fit.radius) for fit in self.shafts
        )

    @property
    def turns(self) -> Axis | None:
        """The axis, if it is a line that all contacts are centred on."""
        about = self.via in (Via.PIN, Via.BOLT, Via.FACE, Via.RING, Via.SEAM)
        return self.axis if about and self.axis is not None and self.axis.direction is not None else None

    @property
    def is_rigid(self) -> bool:
        """Whether the contacts leave nothing free."""
        return self.freedom.kind == FreedomKind.RIGID


def find_relations(scene: Scene, contacts: Contacts) -> dict[Pair, Relation]:
    """The relation of every pair of parts that touch; that of the first of pairs which are placed likewise, shifted."""
    turned = turned_lines(contacts)
    known: dict[tuple[bytes, int, int, int], Relation] = {}
    relations = {}
    for (a, b), placed in scene.shifted(contacts.pairs()):
        fits, patches = contacts.fits.get((a, b), ()), contacts.patches.get((a, b), ())
        sockets = contacts.sockets.get((a, b), ())
        key = placed, len(fits), len(patches), len(sockets)
        if key not in known:
            known[key] = relate((a, b), fits, patches, sockets, [*turned.get(a, ()), *turned.get(b, ())])
        first, shift = known[key], scene.shift(known[key].a, a)
        free, axis = first.freedom, first.axis and replace(first.axis, point=first.axis.point + shift)
        free = free if free.point is None else replace(free, point=free.point + shift)
        touching = {"fits": tuple(fits), "patches": tuple(patches), "sockets": tuple(sockets)}
        relations[a, b] = replace(first, a=a, b=b, **touching, freedom=free, axis=axis)
    return relations


def turned_lines(contacts: Contacts) -> dict[int, list[Axis]]:
    """For each part, the lines of its wider faces of revolution, the widest first."""
    lines: dict[int, list[tuple[float, int]]] = {}
    for number, line in enumerate(contacts.lines):
        for part, faces in line.faces.items():
            radius = max((f.radius for f in faces if not f.bore or f.radius > _BORED_RADIUS), default=0.0)
            if radius >= _TURNED_RADIUS:
                lines.setdefault(part, []).append((-round(radius, 9), number))
    return {part: [contacts.lines[n].axis for _, n in sorted(rows)[:_MOST_LINES]] for part, rows in lines.items()}


def merged(relations: Iterable[Relation], pair: Pair, lines: Sequence[Axis]) -> Relation:
    """The relation of two bodies that consist of several parts."""
    parts = list(relations)
    return relate(
        pair,
        [fit for r in parts for fit in r.fits],
        [patch for r in parts for patch in r.patches],
        [socket for r in parts for socket in r.sockets],
        lines,
    )


def relate(
    pair: Pair, fits: Sequence[Fit], patches: Sequence[Patch], sockets: Sequence[Socket], lines: Sequence[Axis]
) -> Relation:
    """The relation of two bodies from their contacts; ``lines`` are tried as axes if only plane faces touch."""
    points = np.concatenate(
        [*(fit.axis.point[None] for fit in fits), *(s.point[None] for s in sockets), *(p.hull for p in patches)]
    )
    about, size = points.mean(axis=0), max(_LEAST_SIZE, float(np.ptp(points, axis=0).max()))
    free = freedom(fits, patches, sockets, about, size)
    relation = Relation(*pair, tuple(fits), tuple(patches), tuple(sockets), free)
    shafts = relation.shafts
    if sockets and (free.kind == FreedomKind.BALL or not (shafts or patches)):
        centre = Axis(sockets[0].point, None)
        if all(centre.distance(s.point) < SAME_LINE for s in sockets):
            return replace(relation, via=Via.BALL, axis=centre, radius=sockets[0].radius)
    axis = concentric_axis(fits, patches, lines)
    # A ring of holes is a bolt pattern even if the faces leave a direction free.
    if free.kind == FreedomKind.PRISMATIC and (axis is None or relation.holes < 3):
        return _sliding(relation)
    return relation if axis is None else _turning(relation, axis)


def _sliding(r: Relation) -> Relation:
    """Two parts with one free direction between them; coaxial holes without a shaft are a bolt pattern."""
    shafts = r.shafts
    if r.holes and not shafts:
        return r
    point = max(shafts, key=lambda f: f.radius_a).axis.point if shafts else r.patches[0].point
    assert r.freedom.direction is not None
    length = max((f.length for f in shafts), default=0.0)
    via = Via.SLIDE if shafts else Via.GROOVE
    radius = max((f.radius for f in shafts), default=0.0)
    return replace(r, via=via, axis=Axis(point, r.freedom.direction), length=length, radius=radius)


def _turning(r: Relation, axis: Axis) -> Relation:
    """Two parts whose contacts are all centred on one axis."""
    on = [fit for fit in r.fits if axis.distance(fit.axis.point) < SAME_LINE]
    off = [fit for fit in r.fits if axis.distance(fit.axis.point) >= SAME_LINE]
    shafts = [fit for fit in on if fit.kind == FitKind.SHAFT]
    if off:
        via = Via.RING
    elif shafts:
        via = Via.PIN
    elif any(fit.kind == FitKind.HOLES for fit in on):
        via = Via.BOLT
    else:
        via = Via.FACE
    ring_radius = float(np.median([axis.distance(fit.axis.point) for fit in off])) if off else 0.0
    radius = max((fit.radius for fit in on), default=0.0)
    if via == Via.FACE and not radius:
        radius = reach(axis, [r])
    length = max((fit.length for fit in shafts), default=0.0)
    return replace(r, via=via, axis=axis, ring=len(off), ring_radius=ring_radius, length=length, radius=radius)


def reach(axis: Axis, relations: Iterable[Relation]) -> float:
    """Largest distance [m] of the contacts from an axis."""
    points: list[Array] = []
    for r in relations:
        points += [fit.axis.point[None] for fit in r.fits]
        points += [patch.hull for patch in r.patches]
    return float(axis.distances(np.concatenate(points)).max()) if points else 0.0


def neighbours(relations: Mapping[Pair, Relation]) -> dict[int, list[Relation]]:
    """For each part, all its relations."""
    near: dict[int, list[Relation]] = {}
    for (a, b), relation in relations.items():
        near.setdefault(a, []).append(relation)
        near.setdefault(b, []).append(relation)
    return near


def is_even(r: Relation, axis: Axis) -> bool:
    """Whether the gaps between holes around an axis are multiples of the smallest one."""
    x, y, _ = perpendicular_frame(axis.d).T
    away = [fit.axis.point - axis.point for fit in r.fits if axis.distance(fit.axis.point) >= SAME_LINE]
    angles = np.sort([np.arctan2(float(at @ y), float(at @ x)) for at in away])
    gaps = np.diff(np.append(angles, angles[0] + 2.0 * np.pi))
    gaps = gaps[gaps > _EVEN]  # one hole may be on both sides of a flange
    return not len(gaps) or bool(np.abs(gaps - gaps.min() * np.round(gaps / gaps.min())).max() < _EVEN)
