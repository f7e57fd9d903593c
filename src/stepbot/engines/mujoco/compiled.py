"""A compiled MuJoCo model with its coordinates."""

from collections.abc import Mapping
from functools import cached_property
from itertools import combinations
from typing import Any

from stepbot.geometry.spatial import Pose, corners

from ..observation import sorted_pairs
from .coordinates import Balls, Coordinates
from .model import NamedModel


class Compiled(NamedModel, frozen=True, dict=True):
    """A compiled model that can be posed."""

    balls: Balls
    """Names of the coordinates of each ball joint."""

    @cached_property
    def coordinates(self) -> Coordinates:
        """The coordinates of the joints."""
        return Coordinates(self, self.balls)

    @cached_property
    def stray_meshes(self) -> frozenset[int]:
        """Meshes that vertices without faces make larger: their hulls have them, but nobody sees them."""
        return frozenset(mesh for mesh in range(self.model.nmesh) if self._has_strays(mesh))

    def _has_strays(self, mesh: int) -> bool:
        model = self.model
        vertices, first, count = self.vertices(mesh), model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
        (low, high), (lowest, highest) = (
            corners(vertices[model.mesh_face[first : first + count].ravel()]),
            corners(vertices),
        )
        return bool((lowest < low).any() or (highest > high).any())

    @cached_property
    def _data(self) -> Any:
        """The one state: to allocate another takes longer than all that is asked about it."""
        return self.engine.MjData(self.model)

    def data(self, q: Mapping[str, float]) -> Any:
        """State at a configuration, at rest, with the kinematics computed; valid until the next call."""
        data = self._data
        self.engine.mj_resetData(self.model, data)
        self.coordinates.place(data.qpos, q)
        self.engine.mj_kinematics(self.model, data)
        self.engine.mj_comPos(self.model, data)
        return data

    def X_WB(self, data: Any, body: int) -> Pose:
        """Pose of a body in the world."""
        return Pose.of(data.xmat[body].reshape(3, 3), data.xpos[body])

    def poses(self, data: Any) -> dict[str, Pose]:
        """Pose of every link relative to the first."""
        X_RW = self.X_WB(data, self.bodies[0]).inverse()
        return {self.name("BODY", body): X_RW @ self.X_WB(data, body) for body in self.bodies}


def excluded_pairs(compiled: "Compiled") -> tuple[tuple[str, str], ...]:
    """Pairs of links with collision geometry whose contacts MuJoCo excludes; sorted."""
    engine, model = compiled.engine, compiled.model
    excluded = {divmod(int(signature), 1 << 16) for signature in model.exclude_signature}
    follows_tree = not int(model.opt.disableflags) & int(engine.mjtDisableBit.mjDSBL_FILTERPARENT)

    def left_out(a: int, b: int) -> bool:
        if (a, b) in excluded or (b, a) in excluded:
            return True
        weld_a, weld_b = (int(model.body_weldid[body]) for body in (a, b))
        if weld_a == weld_b:
            return True
        above_a, above_b = (int(model.body_weldid[model.body_parentid[weld]]) for weld in (weld_a, weld_b))
        # Bodies fixed to the world count as part of it, and any moving body may touch the world.
        return follows_tree and 0 not in (weld_a, weld_b) and (above_a == weld_b or above_b == weld_a)

    bodies = [body for body in compiled.bodies if any(_masks(compiled, body))]
    return sorted_pairs(
        (compiled.name("BODY", a), compiled.name("BODY", b))
        for a, b in combinations(bodies, 2)
        if left_out(a, b) or not _may_touch(compiled, a, b)
    )


def _masks(compiled: "Compiled", body: int) -> tuple[int, int]:
    """The contact type and affinity bits of a body's geoms."""
    model = compiled.model
    types = affinities = 0
    for g in range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body]):
        types |= int(model.geom_contype[g])
        affinities |= int(model.geom_conaffinity[g])
    return types, affinities


def _may_touch(compiled: "Compiled", a: int, b: int) -> bool:
    (types_a, with_a), (types_b, with_b) = _masks(compiled, a), _masks(compiled, b)
    return bool(types_a & with_b or types_b & with_a)
