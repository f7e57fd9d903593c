"""A compiled MuJoCo model with its coordinates."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from stepbot.geometry.spatial import Pose

from .coordinates import Balls, Coordinates
from .model import NamedModel


@dataclass(frozen=True)
class Compiled(NamedModel):
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
        start, first, count = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
        vertices = model.mesh_vert[start : start + model.mesh_vertnum[mesh]]
        seen = vertices[model.mesh_face[first : first + count].ravel()]
        return bool((vertices.min(axis=0) < seen.min(axis=0)).any() or (vertices.max(axis=0) > seen.max(axis=0)).any())

    def data(self, q: Mapping[str, float]) -> Any:
        """State at a configuration, at rest, with the kinematics computed."""
        data = self.engine.MjData(self.model)
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
