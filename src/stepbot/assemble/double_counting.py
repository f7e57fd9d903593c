"""Reports mass counted twice by overlapping solids: a warning if it is significant for a link, else a note.

Solids of a link that may overlap are pairs with overlapping boxes, grouped by relative pose. Intersecting them takes
most of the time needed to build a robot, and editing joints does not change the result, so it is cached. For new
geometry a worker process can search while this process continues.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.mesh_worker import report_death
from stepbot.geometry.solids.box_pairs import box_pairs, moved_boxes
from stepbot.geometry.solids.manifolds import TOUCHING
from stepbot.geometry.solids.overlapping import Candidate, Group, Overlaps, Pair, Search, overlaps_of
from stepbot.geometry.spatial import Pose, matrix_product, rotated
from stepbot.robot.model import ComponentMass
from stepbot.runtime.cache import Cache, Digest, TypedCache, environment
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import Worker, WorkerDied
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import quoted

from .binder import Binder, listed
from .claims import Claims
from .masses import MASS_TOLERANCE

MAX_FACES = 2_000_000
"""Maximum number of faces to intersect in one robot: about two seconds of work."""

_DECIMALS = 8
"""Decimals of relative poses [m] that are compared."""


_OfLinks = dict[str, Overlaps]
"""The overlaps of every link, in order."""


class OverlapSearch:
    """A running search for the overlaps of a robot."""

    def __init__(
        self,
        assembly: Assembly,
        parts: Mapping[str, Sequence[int]],
        masses: Mapping[int, ComponentMass],
        max_faces: int = MAX_FACES,
        cache: Cache | None = None,
        process: Worker | None = None,
    ) -> None:
        """Look the overlaps up in the cache or start to search; returns at once.

        Args:
            parts: Indices of the components of each link.
            masses: Mass of every component that has a volume; components without a mass or without triangles are left
                out.
            process: An idle worker of :mod:`stepbot.geometry.mesh_worker`; None to search in this process when the
                result is requested.
        """
        bodies = {index: assembly.bodies[assembly.components[index].body] for index in masses}
        # components without triangles are reported as SB601
        seen = {index for index, body in bodies.items() if len(body.mesh.faces)}
        weighed = {link: [index for index in indices if index in seen] for link, indices in parts.items()}
        self._results = TypedCache[_OfLinks](cache, _OfLinks)
        self._key = _key(assembly, weighed, masses, max_faces) if cache is not None else ""
        self._known = self._results.get(self._key) if self._key else None
        self._process: Worker | None = None
        if self._known is None:
            self._search = _search(assembly, weighed, masses, max_faces)
            if process is not None and self._search.groups:
                self._process = process.submit("overlaps", self._search, more=True)

    def result(self, timeout: float = DEFAULT_TIMEOUT) -> Mapping[str, Overlaps]:
        """The overlaps of each link, the heaviest pair first.

        Raises:
            WorkerDied: The process ended without a result, or took longer than ``timeout`` [s].
        """
        if self._known is None:
            self._known = overlaps_of(self._search) if self._process is None else self._process.result(timeout)
            assert self._known is not None
            self._results.put(self._key, self._known)
        return self._known


def _key(
    assembly: Assembly, weighed: Mapping[str, Sequence[int]], masses: Mapping[int, ComponentMass], max_faces: int
) -> str:
    """Key of everything that the overlaps depend on: meshes, poses and densities."""
    digest = Digest("solids that overlap").add(environment(), str(max_faces))
    bodies: dict[int, None] = {}
    for link, indices in weighed.items():
        components = [assembly.components[index] for index in indices]
        bodies.update(dict.fromkeys(component.body for component in components))
        numbers = np.array([(component.index, component.body) for component in components], dtype=np.int64)
        numbered = [(masses[index].density or 0.0, masses[index].volume) for index in indices]
        places = [component.X_WC.matrix for component in components]
        digest.add(link, numbers.tobytes(), np.array(numbered, float).tobytes(), np.array(places, float).tobytes())
    for body in bodies:
        mesh = assembly.bodies[body].mesh
        digest.add(str(body), mesh.vertices.tobytes(), mesh.faces.tobytes())
    return digest.key


def _search(
    assembly: Assembly, weighed: Mapping[str, Sequence[int]], masses: Mapping[int, ComponentMass], max_faces: int
) -> Search:
    groups: dict[bytes, tuple[Group, list[Candidate]]] = {}
    for link, indices in weighed.items():
        if len(indices) > 1:
            _collect(assembly, link, indices, masses, groups)
    collected = tuple(replace(group, candidates=tuple(candidates)) for group, candidates in groups.values())
    bodies = dict.fromkeys(body for group in collected for body in group.bodies)
    first = dict.fromkeys(candidate.first for group in collected for candidate in group.candidates)
    return Search(
        tuple(weighed),
        collected,
        {body: assembly.bodies[body].mesh for body in bodies},
        {index: assembly.components[index].X_WC for index in first},
        max_faces,
    )


def _collect(
    assembly: Assembly,
    link: str,
    indices: Sequence[int],
    masses: Mapping[int, ComponentMass],
    groups: dict[bytes, tuple[Group, list[Candidate]]],
) -> None:
    """Sort the pairs of a link with overlapping boxes into groups."""
    bodies = np.array([assembly.components[index].body for index in indices])
    R = np.array([assembly.components[index].X_WC.rotation for index in indices])
    p = np.array([assembly.components[index].X_WC.position for index in indices])
    density = np.array([masses[index].density or 0.0 for index in indices])
    volume = np.array([masses[index].volume for index in indices], float)
    extent = {body: assembly.bodies[body].mesh.bounds for body in dict.fromkeys(bodies.tolist())}
    extents = np.array([extent[body] for body in bodies.tolist()])
    low, high = moved_boxes(extents[:, 0], extents[:, 1], R, p)

    a, b = box_pairs(low, high, TOUCHING)
    a, b = np.where(bodies[a] <= bodies[b], (a, b), (b, a))
    lighter, denser = np.minimum(density[a], density[b]), np.maximum(density[a], density[b])
    twice = np.where(lighter > 0.0, lighter, denser)  # a density of 0 stands for a given mass
    a, b, twice = a[twice > 0.0], b[twice > 0.0], twice[twice > 0.0]
    smaller = np.minimum(volume[a], volume[b])
    shared = (np.minimum(high[a], high[b]) - np.maximum(low[a], low[b])).prod(axis=1)
    most = twice * np.minimum(shared, smaller)
    R_AB = matrix_product(R[a].transpose(0, 2, 1), R[b])
    p_AB = rotated(R[a].transpose(0, 2, 1), p[b] - p[a])
    # Adding zero turns -0.0 into 0.0.
    keys = np.column_stack([bodies[a], bodies[b], R_AB.reshape(-1, 9).round(_DECIMALS), p_AB.round(_DECIMALS)]) + 0.0
    for k, key in enumerate(map(bytes, keys)):
        if key not in groups:
            both = int(bodies[a[k]]), int(bodies[b[k]])
            groups[key] = Group(both, Pose.of(R_AB[k], p_AB[k]), float(smaller[k]), ()), []
        pair = Candidate(link, indices[a[k]], indices[b[k]], float(twice[k]), float(most[k]))
        groups[key][1].append(pair)


_CUT = "subtract one solid from the other in CAD"
_WEIGH = "or set a measured mass: `mass` in `parts`, or `inertial` on the link"


class DoubleCounting:
    """Overlaps in links with computed mass; a link with an ``inertial`` counts nothing twice."""

    def __init__(
        self,
        binder: Binder,
        claims: Claims,
        masses: Mapping[int, ComponentMass],
        max_faces: int = MAX_FACES,
        cache: Cache | None = None,
        process: Worker | None = None,
    ) -> None:
        """Start the search and return at once.

        Args:
            binder: Its collector receives SB512 to SB514, and SB902.
            masses: Mass of every component that has a volume.
            process: Worker that searches; see :class:`.OverlapSearch`.
        """
        self._binder, self._masses = binder, masses
        links = [name for name, link in binder.document.links.items() if link.inertial is None]
        self._parts = {link: claims.parts_of(link) for link in links}
        self._search = OverlapSearch(binder.assembly, self._parts, masses, max_faces, cache, process)

    def report(self, timeout: float = DEFAULT_TIMEOUT) -> None:
        """Wait for the search to end, and report the overlaps.

        Args:
            timeout: Maximum waiting time [s].
        """
        try:
            by_link = self._search.result(timeout)
        except WorkerDied as death:
            report_death(death, "intersects solids", self._binder.span(("links",)), self._binder.diagnostics)
            return
        slight: dict[str, Overlaps] = {}
        for link, overlaps in by_link.items():
            total = exact_sum(self._masses[index].mass or 0.0 for index in self._parts[link] if index in self._masses)
            if overlaps.mass >= MASS_TOLERANCE * total > 0.0:
                _warn(self._binder, link, overlaps, total)
            elif overlaps.pairs:
                slight[link] = overlaps
        if slight:
            _note_slight(self._binder, slight)
        unchecked = [pair for overlaps in by_link.values() for pair in overlaps.unchecked]
        if unchecked:
            _note_unchecked(self._binder, unchecked)


def _warn(binder: Binder, link: str, overlaps: Overlaps, total: float) -> None:
    repeated = [pair for pair in overlaps.pairs if pair.is_repeated]
    again = [quoted(binder.path(max(pair.first, pair.second))) for pair in repeated[:1]]
    once = [f"{path} is duplicated at the same place: `parts: {{{path}: {{ignore: true}}}}`" for path in again]
    binder.report(
        "SB512",
        ("links", link),
        f"solids overlap: {_weight(overlaps.mass)} of {_weight(total)} are counted twice",
        help=(*once, _CUT, _WEIGH),
        notes=listed(tuple(f"{_names(binder, pair)}: {_measure(pair)}" for pair in overlaps.pairs)),
    )


def _note_slight(binder: Binder, slight: Mapping[str, Overlaps]) -> None:
    count = sum(len(overlaps.pairs) for overlaps in slight.values())
    pairs = f"{count} pairs of solids overlap" if count > 1 else "one pair of solids overlaps"
    notes = (
        f"link '{link}': {_weight(overlaps.mass)} are counted twice, most of it in "
        f"{_names(binder, overlaps.pairs[0])}: {_measure(overlaps.pairs[0])}"
        for link, overlaps in slight.items()
    )
    message = f"{binder.assembly.source}: {pairs} by less than a thousandth of their link's mass"
    binder.diagnostics.add("SB513", message, binder.span(("links",)), notes=listed(tuple(notes)))


def _note_unchecked(binder: Binder, pairs: Sequence[Pair]) -> None:
    heaviest_first = sorted(pairs, key=lambda pair: -pair.mass)
    count = f"{len(pairs)} pairs of solids were" if len(pairs) > 1 else "one pair of solids was"
    notes = (
        f"{_names(binder, pair)}: {pair.unchecked}; at most {_weight(pair.mass)} are counted twice"
        for pair in heaviest_first
    )
    message = f"{binder.assembly.source}: {count} not checked for overlaps"
    binder.diagnostics.add("SB514", message, binder.span(("links",)), notes=listed(tuple(notes)))


def _names(binder: Binder, pair: Pair) -> str:
    first, second = sorted((pair.first, pair.second))
    return f"{quoted(binder.path(first))} and {quoted(binder.path(second))}"


def _measure(pair: Pair) -> str:
    return f"{pair.volume * 1e9:.4g} mm^3, {_weight(pair.mass)}"


def _weight(mass: float) -> str:
    """A mass [kg], formatted for messages."""
    return f"{mass:.3g} kg" if mass >= 1.0 else f"{mass * 1e3:.3g} g"
