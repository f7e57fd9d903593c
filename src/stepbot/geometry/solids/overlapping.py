"""Overlapping solids, whose common volume would be weighed twice.

Each pair of bodies is intersected once per relative pose, the potentially heaviest pair first. Where two densities
meet, the denser material is assumed to displace the lighter one, as a screw does in plastic. Given masses are not
corrected. Touching faces are not an overlap, whatever their meshes do: :attr:`.Intersection.noise`.

Many pairs are intersected in forked processes, one per core and each with one thread: manifold3d's own threads take
half as much processor time again, and longer.
"""

from collections.abc import Iterable, Mapping, Sequence

from msgspec import Struct

from stepbot.geometry.fixed_point import exact_sum
from stepbot.runtime.parallel import results_of

from ..mesh import TriMesh
from ..spatial import IDENTITY, Pose
from .manifolds import TOUCHING, Solid, union_volume, use_one_thread

SMALLEST = 1e-3
"""Share of the smaller solid from which an overlap counts."""
_SAME_PLACE = 9
"""Decimals [m] of relative poses that are the same: meshes are on a grid of a nanometre."""
_MANY = 20_000
"""Faces of all pairs from which it is worth while to start processes."""


class Candidate(Struct, frozen=True):
    """Two components with overlapping boxes."""

    link: str
    first: int
    second: int
    density: float
    """[kg/m^3] at which their common volume is counted twice."""
    most: float
    """Upper bound of its mass [kg], from their boxes."""


class Group(Struct, frozen=True):
    """Candidates of the same two bodies in the same relative pose, which have the same intersection."""

    bodies: tuple[int, int]
    X_AB: Pose
    smaller: float
    """Volume [m^3] of the smaller one."""
    candidates: tuple[Candidate, ...]

    @property
    def is_repeated(self) -> bool:
        """Whether both are the same body at the same place."""
        return self.bodies[0] == self.bodies[1] and max(self.X_AB.distance_to(IDENTITY)) <= TOUCHING


class Search(Struct, frozen=True):
    """The pairs to intersect."""

    links: tuple[str, ...]
    groups: tuple[Group, ...]
    meshes: Mapping[int, TriMesh]
    """Of the bodies in the groups."""
    poses: Mapping[int, Pose]
    """Of the first component of each candidate."""
    max_faces: int
    """Maximum number of faces of all pairs together."""


class Pair(Struct, frozen=True):
    """Two components of one link that overlap, or may overlap."""

    first: int
    second: int
    mass: float
    """Mass counted twice [kg]; its upper bound if the pair was not checked."""
    volume: float = 0.0
    """Common volume [m^3]."""
    is_repeated: bool = False
    """Whether both are the same part at the same place."""
    unchecked: str = ""
    """Why the pair was not checked; empty if it was."""


class Overlaps(Struct, frozen=True):
    """The overlaps of one link."""

    pairs: tuple[Pair, ...] = ()
    mass: float = 0.0
    """Mass counted more than once [kg]; less than the sum of the pairs if three solids share a region."""
    unchecked: tuple[Pair, ...] = ()


def overlaps_of(search: Search) -> dict[str, Overlaps]:
    """The overlaps of every link, the heaviest pair first."""
    return _by_link(search, zip(search.groups, _intersect(search), strict=True))


class _Common(Struct, frozen=True, eq=False):
    """The intersection of two bodies, in the frame of the first."""

    volume: float
    """[m^3]."""
    mesh: TriMesh


_Share = tuple[float, _Common, Pose]
"""Mass [kg] of the intersection of a solid with a previous one, the intersection, and its pose X_WA."""


def _intersect(search: Search) -> list[_Common | str | None]:
    """For each group the intersection of its bodies, None if it does not count, or why it was not checked."""
    use_one_thread()
    solids = {body: Solid(mesh) for body, mesh in search.meshes.items()}
    groups = search.groups
    outcomes: list[_Common | str | None] = [None] * len(groups)
    wanted, weights, spent = list[int](), list[float](), 0
    for number in sorted(range(len(groups)), key=lambda i: -exact_sum(pair.most for pair in groups[i].candidates)):
        a, b = (solids[body] for body in groups[number].bodies)
        if not a.may_meet(b, groups[number].X_AB):
            continue
        work = a.face_count + b.face_count
        if spent + work > search.max_faces:
            outcomes[number] = f"all pairs together have more than {search.max_faces:,} faces"
        elif not (a.is_sound and b.is_sound):
            outcomes[number] = "a mesh is not watertight"
        else:
            spent += work
            wanted.append(number)
            weights.append(work)

    def common(number: int) -> _Common | None:
        a, b = (solids[body] for body in groups[number].bodies)
        region = a.intersection(b, groups[number].X_AB)
        if region.volume > max(SMALLEST * groups[number].smaller, region.noise):
            return _Common(region.volume, region.mesh)
        return None

    results = list(map(common, wanted)) if spent < _MANY else results_of(common, wanted, weights, "overlaps")
    for number, result in zip(wanted, results, strict=True):
        outcomes[number] = result
    return outcomes


def _by_link(search: Search, results: Iterable[tuple[Group, _Common | str | None]]) -> dict[str, Overlaps]:
    checked: dict[str, list[Pair]] = {link: [] for link in search.links}
    unchecked: dict[str, list[Pair]] = {link: [] for link in checked}
    twice = dict.fromkeys(checked, 0.0)
    shares: dict[tuple[str, int], list[_Share]] = {}
    for group, common in results:
        for c in group.candidates:
            if isinstance(common, str):
                unchecked[c.link].append(Pair(c.first, c.second, c.most, unchecked=common))
            elif common is not None:
                mass = c.density * common.volume
                checked[c.link].append(Pair(c.first, c.second, mass, common.volume, group.is_repeated))
                share = mass, common, search.poses[c.first]
                shares.setdefault((c.link, max(c.first, c.second)), []).append(share)
    unions: dict[tuple[tuple[int, bytes], ...], float] = {}
    for (link, _), of_one in shares.items():
        twice[link] += _shared_once(of_one, unions)
    return {
        link: Overlaps(_heaviest_first(checked[link]), twice[link], _heaviest_first(unchecked[link]))
        for link in checked
    }


def _heaviest_first(pairs: Iterable[Pair]) -> tuple[Pair, ...]:
    return tuple(sorted(pairs, key=lambda pair: (-pair.mass, pair.first, pair.second)))


def _shared_once(shares: Sequence[_Share], unions: dict[tuple[tuple[int, bytes], ...], float]) -> float:
    """Mass [kg] that a solid shares with the previous ones; regions shared with several count once.

    ``unions`` are the volumes [m^3] known so far: instances of an assembly share the same regions.
    """
    mass = exact_sum(mass for mass, _, _ in shares)
    if len(shares) == 1:
        return mass
    X_FW = shares[0][2].inverse()
    placed = [(common, X_FW @ X_WA) for _, common, X_WA in shares]
    key = tuple((id(common), (X_FA.matrix.round(_SAME_PLACE) + 0.0).tobytes()) for common, X_FA in placed)
    if key not in unions:
        unions[key] = union_volume([(common.mesh, X_FA) for common, X_FA in placed])
    return mass * unions[key] / exact_sum(common.volume for common, _ in placed)
