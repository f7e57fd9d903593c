"""The robot's meshes, in a binary layer of their own (decision 0037), once each."""

import numpy as np

from stepbot.geometry.mesh import GRID_PER_METRE
from stepbot.geometry.shading import NORMAL_DECIMALS, shaded
from stepbot.robot.model import MeshAsset, MeshRef, Robot

from .crate import CrateAttribute, CratePrim, Singles, crate
from .usda import UNITS, Names, Prim, asset_path, written_by

MESH = "mesh"
"""Name of the mesh in the prim of an asset."""
_TOP = "meshes"


class MeshLayer:
    """The layer, and where its meshes are."""

    def __init__(self, robot: Robot, path: str = "", top: str = _TOP) -> None:
        """Lay it out.

        Args:
            path: Its file, relative to that of the layer that refers to it; empty for the one in ``meshes``.
        """
        names = Names()
        identifiers = {asset.name: names.of(asset.name) for asset in robot.meshes}
        geometries = [shape.geometry for shape in robot.distinct_shapes]
        used = {geometry.name for geometry in geometries if isinstance(geometry, MeshRef)}
        self._assets = {asset.name: asset for asset in robot.meshes if asset.name in used}
        self._identifiers = identifiers
        self._doc, self._top = written_by(robot), top
        self.path = path or f"meshes/{robot.name}.usdc"
        """Relative to the folder of the robot's file."""

    def reference(self, mesh: MeshRef, child: str = "") -> str:
        """A reference to the prim of a mesh, or to a child of it, as metadata."""
        path = "/".join(("", self._top, self._identifiers[mesh.name], *([child] if child else [])))
        return f"prepend references = {asset_path(f'./{self.path}')}<{path}>"

    def content(self) -> bytes | None:
        """The bytes of the layer; None without meshes."""
        prims = [_prim(asset, self._identifiers[name]) for name, asset in self._assets.items()]
        return crate(UNITS, self._doc, CratePrim("Xform", self._top, children=prims)) if prims else None

    def instances(self, layer: "MeshLayer") -> Prim:
        """The root prim of another layer, which has these meshes under the names that they have there."""
        top = Prim("Xform", layer._top)
        for name in self._assets:
            top.add(Prim("Xform", layer._identifiers[name], metadata=[self.reference(MeshRef(name))]))
        return top


def _prim(asset: MeshAsset, identifier: str) -> CratePrim:
    """A mesh, to be referred to: triangles with a normal at each corner, on the grid of the mesh files."""
    mesh = asset.mesh
    points = _singles(np.rint(mesh.vertices * GRID_PER_METRE) / GRID_PER_METRE)
    distinct, which = shaded(mesh)
    normals = _singles(distinct[which.ravel()] / 10.0**NORMAL_DECIMALS)
    corners = [points.min(axis=0), points.max(axis=0)] if len(points) else np.zeros((2, 3))
    attributes = (
        CrateAttribute("extent", "float3[]", np.asarray(corners, np.float32)),
        CrateAttribute("faceVertexCounts", "int[]", np.full(len(mesh.faces), 3, np.int32)),
        CrateAttribute("faceVertexIndices", "int[]", mesh.faces.ravel().astype(np.int32)),
        CrateAttribute("normals", "normal3f[]", normals, interpolation="faceVarying"),
        CrateAttribute("points", "point3f[]", points),
        CrateAttribute("subdivisionScheme", "token", "none", uniform=True),
    )
    return CratePrim("Xform", identifier, children=(CratePrim("Mesh", MESH, attributes),))


def _singles(rows: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Singles:
    """Rows of doubles in single precision, without a minus on zero."""
    return (rows + 0.0).astype(np.float32)
