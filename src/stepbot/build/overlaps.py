"""Solids of one link that overlap: what they have in common is weighed twice.

Each two bodies are intersected once for each relative pose, what could weigh most first. Where two densities meet, the
lighter material is taken to give way to the denser one, as plastic does to a screw. Of a mass that was measured nothing
is counted twice. Faces that touch are no overlap, whatever their meshes say: :attr:`.Intersection.noise`.

That is most of the time that it takes to build a robot, and edits of joints change nothing about it: it is kept.
manifold3d works on all cores by itself, by threads that no process inherits: whatever was forked after it was used
would wait for them forever.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..cache import Cache, Digest, Shelf, environment
from ..cad.assembly import Assembly
from ..spatial import IDENTITY, Pose
from .box_pairs import box_pairs, moved_boxes
from .manifolds import TOUCHING, Intersection, Solid, union_volume
from .masses import PartMass

SMALLEST = 1e-3
"""Share of the smaller solid from which on an overlap counts."""
MAX_FACES = 2_000_000
"""Faces of all pairs together that are intersected in one robot: about two seconds of work."""

_DECIMALS = 8
"""Of relative poses [m] that count as the same."""


@dataclass(frozen=True)
class Pair:
    """Two components of one link that overlap, or may."""

    first: int
    second: int
    mass: float
    """What is counted twice [kg]; where the pair was not checked, the most that it can be."""
    volume: float = 0.0
    """What they have in common [m^3]."""
    is_repeated: bool = False
    """Whether both are the same part at the same place."""
    unchecked: str = ""
    """Why the pair was not checked; empty where it was."""


@dataclass(frozen=True)
class Overlaps:
    """The overlaps of one link."""

    pairs: tuple[Pair, ...] = ()
    mass: float = 0.0
    """What is counted more than once [kg]; less than the pairs together where three solids share something."""
    unchecked: tuple[Pair, ...] = ()


@dataclass(frozen=True)
class FoundOverlaps:
    """The overlaps of a robot."""

    by_link: Mapping[str, Overlaps]
    """Of every link, in order."""


def find_overlaps(
    assembly: Assembly,
    parts: Mapping[str, Sequence[int]],
    masses: Mapping[int, PartMass],
    max_faces: int = MAX_FACES,
    cache: Cache | None = None,
) -> Mapping[str, Overlaps]:
    """What overlaps in each link, the heaviest pair first.

    Args:
        assembly: What the STEP holds.
        parts: For each link the indices of its components.
        masses: Mass of every component that has a volume; the others overlap nothing, nor do those without triangles.
        max_faces: Limit of the work.
        cache: Where it is kept; None for nowhere.
    """
    bodies = {index: assembly.bodies[assembly.components[index].body] for index in masses}
    seen = {index for index, body in bodies.items() if len(body.mesh.faces)}  # SB601 says of others that none are there
    weighed = {link: [index for index in indices if index in seen] for link, indices in parts.items()}
    shelf = Shelf(cache, FoundOverlaps)
    key = _key(assembly, weighed, masses, max_faces) if cache is not None else ""
    known = shelf.get(key) if key else None
    if known is None:
        groups: dict[bytes, _Group] = {}
        for link, indices in weighed.items():
            if len(indices) > 1:
                _collect(assembly, link, indices, masses, groups)
        _intersect(assembly, groups.values(), max_faces)
        known = FoundOverlaps(_by_link(assembly, parts, groups.values()))
        shelf.put(key, known)
    return known.by_link


def _key(
    assembly: Assembly, weighed: Mapping[str, Sequence[int]], masses: Mapping[int, PartMass], max_faces: int
) -> str:
    """Key of all that the overlaps depend on: meshes, where each is, and what it is made of."""
    digest = Digest("solids that overlap").add(environment(), str(max_faces))
    bodies: dict[int, None] = {}
    for link, indices in weighed.items():
        components = [assembly.components[index] for index in indices]
        bodies.update(dict.fromkeys(component.body for component in components))
        numbers = np.array([(component.index, component.body) for component in components], dtype=np.int64)
        numbered = [(masses[index].density, masses[index].volume) for index in indices]
        places = [component.X_WC.matrix for component in components]
        digest.add(link, numbers.tobytes(), np.array(numbered, float).tobytes(), np.array(places, float).tobytes())
    for body in bodies:
        mesh = assembly.bodies[body].mesh
        digest.add(str(body), mesh.vertices.tobytes(), mesh.faces.tobytes())
    return digest.key


@dataclass(frozen=True)
class _Candidate:
    """A pair whose boxes overlap."""

    link: str
    first: int
    second: int
    density: float
    """[kg/m^3] at which what they have in common is counted twice."""
    most: float
    """What that can weigh [kg], judged by their boxes."""


@dataclass(eq=False)
class _Group:
    """Pairs of the same two bodies in the same relative pose: they have the same in common."""

    bodies: tuple[int, int]
    X_AB: Pose
    smaller: float
    """Volume [m^3] of the smaller one."""
    candidates: list[_Candidate] = field(default_factory=list)
    common: Intersection | None = None
    """None where that is nothing, or not enough to count."""
    unchecked: str = ""

    @property
    def is_repeated(self) -> bool:
        """Whether both are the same body at the same place."""
        return self.bodies[0] == self.bodies[1] and max(self.X_AB.distance_to(IDENTITY)) <= TOUCHING


def _collect(
    assembly: Assembly, link: str, indices: Sequence[int], masses: Mapping[int, PartMass], groups: dict[bytes, _Group]
) -> None:
    """Sort the pairs of a link whose boxes overlap into groups."""
    bodies = np.array([assembly.components[index].body for index in indices])
    R = np.array([assembly.components[index].X_WC.rotation for index in indices])
    p = np.array([assembly.components[index].X_WC.position for index in indices])
    density = np.array([masses[index].density for index in indices])
    volume = np.array([masses[index].volume for index in indices])
    extent = {body: assembly.bodies[body].mesh.bounds for body in dict.fromkeys(bodies.tolist())}
    extents = np.array([extent[body] for body in bodies.tolist()])
    low, high = moved_boxes(extents[:, 0], extents[:, 1], R, p)

    a, b = box_pairs(low, high, TOUCHING)
    a, b = np.where(bodies[a] <= bodies[b], (a, b), (b, a))
    lighter, denser = np.minimum(density[a], density[b]), np.maximum(density[a], density[b])
    twice = np.where(lighter > 0.0, lighter, denser)  # a density of 0 is that of a measured mass
    a, b, twice = a[twice > 0.0], b[twice > 0.0], twice[twice > 0.0]
    smaller = np.minimum(volume[a], volume[b])
    shared = (np.minimum(high[a], high[b]) - np.maximum(low[a], low[b])).prod(axis=1)
    most = twice * np.minimum(shared, smaller)
    R_AB = R[a].transpose(0, 2, 1) @ R[b]
    p_AB = np.einsum("kji,kj->ki", R[a], p[b] - p[a])
    # Adding zero turns -0.0 into 0.0.
    keys = np.column_stack([bodies[a], bodies[b], R_AB.reshape(-1, 9).round(_DECIMALS), p_AB.round(_DECIMALS)]) + 0.0
    for k, key in enumerate(map(bytes, keys)):
        if key not in groups:
            groups[key] = _Group((int(bodies[a[k]]), int(bodies[b[k]])), Pose.of(R_AB[k], p_AB[k]), float(smaller[k]))
        pair = _Candidate(link, indices[a[k]], indices[b[k]], float(twice[k]), float(most[k]))
        groups[key].candidates.append(pair)


def _intersect(assembly: Assembly, groups: Iterable[_Group], max_faces: int) -> None:
    """Find what the bodies of each group have in common, until the work is too much."""
    solids: dict[int, Solid] = {}
    spent = 0
    for group in sorted(groups, key=lambda group: -sum(pair.most for pair in group.candidates)):
        for body in group.bodies:
            if body not in solids:
                solids[body] = Solid(assembly.bodies[body].mesh)
        a, b = (solids[body] for body in group.bodies)
        if not a.may_meet(b, group.X_AB):
            continue
        work = a.face_count + b.face_count
        if spent + work > max_faces:
            group.unchecked = f"all pairs together have more than {max_faces:,} faces"
        elif not (a.is_sound and b.is_sound):
            group.unchecked = "a mesh is not closed"
        else:
            spent += work
            common = a.intersection(b, group.X_AB)
            if common.volume > SMALLEST * group.smaller and common.volume > common.noise:
                group.common = common


def _by_link(assembly: Assembly, links: Iterable[str], groups: Iterable[_Group]) -> dict[str, Overlaps]:
    checked: dict[str, list[Pair]] = {link: [] for link in links}
    unchecked: dict[str, list[Pair]] = {link: [] for link in checked}
    twice = dict.fromkeys(checked, 0.0)
    shares: dict[tuple[str, int], list[_Share]] = {}
    for group in groups:
        for c in group.candidates:
            if group.unchecked:
                unchecked[c.link].append(Pair(c.first, c.second, c.most, unchecked=group.unchecked))
            elif group.common is not None:
                mass = c.density * group.common.volume
                checked[c.link].append(Pair(c.first, c.second, mass, group.common.volume, group.is_repeated))
                share = _Share(mass, group.common, assembly.components[c.first].X_WC)
                shares.setdefault((c.link, max(c.first, c.second)), []).append(share)
    for (link, _), of_one in shares.items():
        twice[link] += _shared_once(of_one)
    return {
        link: Overlaps(_heaviest_first(checked[link]), twice[link], _heaviest_first(unchecked[link]))
        for link in checked
    }


def _heaviest_first(pairs: Iterable[Pair]) -> tuple[Pair, ...]:
    return tuple(sorted(pairs, key=lambda pair: (-pair.mass, pair.first, pair.second)))


@dataclass(frozen=True, eq=False)
class _Share:
    """What a solid has in common with one of those before it, placed by X_WA."""

    mass: float
    common: Intersection
    X_WA: Pose


def _shared_once(shares: Sequence[_Share]) -> float:
    """Mass [kg] that a solid has in common with those before it; where these overlap each other too, only once."""
    mass = sum(share.mass for share in shares)
    if len(shares) == 1:
        return mass
    union = union_volume([(share.common, share.X_WA) for share in shares])
    return mass * union / sum(share.common.volume for share in shares)
