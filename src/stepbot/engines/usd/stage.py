"""A stage as bodies: its rigid bodies, their names and poses, and what is below each of them, in SI."""

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array, Pose

from ..observation import EngineCannotRead, EngineRefused


class Body(Struct, frozen=True, eq=False):
    """A rigid body."""

    name: str
    prim: Any
    X_W: Pose
    """Pose of its prim in the stage, without scale."""
    scale: Array
    """Scale (3,) of its prim: coordinates in it times this are in stage units."""


class Stage:
    """An open stage."""

    def __init__(self, file: str) -> None:
        """Open it.

        Raises:
            EngineRefused: USD cannot open it.
            EngineCannotRead: It has no rigid bodies.
        """
        from pxr import Tf, Usd, UsdGeom, UsdPhysics

        try:
            self.stage = Usd.Stage.Open(file)
        except Tf.ErrorException as error:
            folder = f"{Path(file).parent.as_posix()}/"
            raise EngineRefused(error.args[0].commentary.replace(folder, "").strip()) from error
        self._usd, self._physics = Usd, UsdPhysics
        self.metres = float(UsdGeom.GetStageMetersPerUnit(self.stage))
        self.kilograms = float(UsdPhysics.GetStageKilogramsPerUnit(self.stage))
        self.up = np.array([0.0, 1.0, 0.0] if UsdGeom.GetStageUpAxis(self.stage) == "Y" else [0.0, 0.0, 1.0])
        self._places = UsdGeom.XformCache()
        if not self.bodies:
            raise EngineCannotRead("the stage has no rigid bodies")

    @property
    def newtons(self) -> float:
        """Force [N] of one unit of force."""
        return self.kilograms * self.metres

    @property
    def name(self) -> str:
        """Name of the robot: of the default prim, or of the root of the articulation."""
        prim = self.stage.GetDefaultPrim()
        roots = (one for one in self.prims() if one.HasAPI(self._physics.ArticulationRootAPI))
        return name_of(prim or next(roots, self.stage.GetPseudoRoot()))

    def prims(self) -> Iterator[Any]:
        """All prims, with the content of instances."""
        top = self.stage.GetPseudoRoot()
        yield from (prim for prim in self._usd.PrimRange(top, self._usd.TraverseInstanceProxies()) if prim != top)

    @cached_property
    def bodies(self) -> dict[str, Body]:
        """The rigid bodies by path."""
        bodies: dict[str, Body] = {}
        taken: set[str] = set()
        for prim in self.prims():
            if prim.HasAPI(self._physics.RigidBodyAPI):
                name = name_of(prim)
                name = str(prim.GetPath()) if name in taken else name
                taken.add(name)
                bodies[str(prim.GetPath())] = Body(name, prim, *self._place(prim))
        return bodies

    def body_of(self, prim: Any) -> Body | None:
        """The body that a prim is part of; None for a part of the world."""
        while prim and not prim.IsPseudoRoot():
            body = self.bodies.get(str(prim.GetPath()))
            if body is not None:
                return body
            prim = prim.GetParent()
        return None

    def content(self, body: Body) -> Iterator[Any]:
        """The prims below a body that are part of it, not of a body below."""
        prims = iter(self._usd.PrimRange(body.prim, self._usd.TraverseInstanceProxies()))
        for prim in prims:
            if prim == body.prim:
                continue
            if str(prim.GetPath()) in self.bodies:
                prims.PruneChildren()
            else:
                yield prim

    def in_body(self, prim: Any, body: Body) -> Array:
        """Homogeneous matrix (4, 4) from the prim's coordinates, in stage units, to those of the body [m]."""
        M = _columns(self._places.GetLocalToWorldTransform(prim))
        M[:3] *= self.metres
        return np.asarray(body.X_W.inverse().matrix @ M)

    def _place(self, prim: Any) -> tuple[Pose, Array]:
        X, scale = rigid(_columns(self._places.GetLocalToWorldTransform(prim)))
        return Pose.of(X.R, X.p * self.metres), scale


def name_of(prim: Any) -> str:
    """The display name of a prim, or else its own."""
    return str(prim.GetDisplayName() or prim.GetName())


def rigid(M: Array) -> tuple[Pose, Array]:
    """Rotation and translation of an affine transform (4, 4) without shear, and its scale (3,)."""
    scale = np.linalg.norm(M[:3, :3], axis=0)
    return Pose.of(M[:3, :3] / scale, M[:3, 3]), scale


def _columns(matrix: Any) -> Array:
    """A matrix of USD, which multiplies row vectors, for column vectors."""
    return np.array(matrix, dtype=np.float64).T
