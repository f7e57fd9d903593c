"""Solids of a link that may overlap: pairs with overlapping boxes, grouped by relative pose.

Intersecting them takes most of the time needed to build a robot, and editing joints does not change the result, so it
is cached. For new geometry a worker process can search while this process continues.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from stepbot.geometry.solids.box_pairs import box_pairs, moved_boxes
from stepbot.geometry.solids.manifolds import TOUCHING
from stepbot.geometry.solids.overlapping import Candidate, Group, Overlaps, Search, overlaps_of
from stepbot.geometry.spatial import Pose, matrix_product, rotated
from stepbot.robot.model import ComponentMass
from stepbot.runtime.cache import Cache, Digest, TypedCache, environment
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import Worker
from stepbot.step.assembly import Assembly

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
            max_faces: Maximum number of faces to intersect.
            cache: Cache for overlaps; None to disable it.
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
