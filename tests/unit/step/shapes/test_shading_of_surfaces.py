"""Pictures of meshes with the normals that are written, against pictures of the exact surfaces."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from stepbot.geometry.shading import corner_normals
from stepbot.step.assembly import MeshTolerance
from stepbot.step.shapes.tessellation import diagonal, fineness, tessellated
from tests.solids import box, cylinder, sphere

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("embreex")

SIDE = 48
"""Pixels on a side of a picture."""
EYE = np.array((0.48, -0.64, 0.6))
"""Towards the camera, which is orthographic; the light comes from there and from above."""
LIGHT = np.array((0.0, -0.6, 0.8))


def housing() -> Any:
    """A box with rounded edges and a bore: planes, cylinders and spheres that meet smoothly and at a sharp edge."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    solid = box(60.0, 40.0, 30.0).shape
    fillet, edges = BRepFilletAPI_MakeFillet(solid), TopExp_Explorer(solid, TopAbs_EDGE)
    while edges.More():
        fillet.Add(6.0, TopoDS.Edge(edges.Current()))
        edges.Next()
    return BRepAlgoAPI_Cut(fillet.Shape(), cylinder(8.0, 100.0).at(0.0, 0.0, -50.0).shape).Shape()


def torus() -> Any:
    """A ring."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus

    return BRepPrimAPI_MakeTorus(30.0, 9.0).Shape()


def rays(shape: Any) -> np.ndarray:
    """The origin of the ray of each pixel [mm], in front of the shape. Shape (n, 3)."""
    across = np.cross((0.0, 0.0, 1.0), EYE) / np.linalg.norm(np.cross((0.0, 0.0, 1.0), EYE))
    size = diagonal(shape)
    steps = (np.arange(SIDE) + 0.5) / SIDE * size - size / 2
    u, v = (grid.ravel()[:, None] for grid in np.meshgrid(steps, steps))
    return EYE * size + u * across + v * np.cross(EYE, across)


def exact_normals(shape: Any, origins: np.ndarray) -> np.ndarray:
    """Outward normals of the surfaces where rays meet them first; NaN where they meet none. Shape (n, 3)."""
    from OCP.BRepGProp import BRepGProp_Face
    from OCP.gp import gp_Dir, gp_Lin, gp_Pnt, gp_Vec
    from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector

    search = IntCurvesFace_ShapeIntersector()
    search.Load(shape, 1e-7)
    found = np.full(origins.shape, np.nan)
    for row, origin in enumerate(origins):
        search.PerformNearest(gp_Lin(gp_Pnt(*map(float, origin)), gp_Dir(*map(float, -EYE))), 0.0, 1e6)
        if search.NbPnt():
            point, normal = gp_Pnt(), gp_Vec()
            BRepGProp_Face(search.Face(1)).Normal(search.UParameter(1), search.VParameter(1), point, normal)
            found[row] = np.array((normal.X(), normal.Y(), normal.Z())) / normal.Magnitude()
    return found


def mesh_normals(shape: Any, origins: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normals of the mesh where rays meet it first: between those of the corners, as renderers compute them, and flat.

    Shape (n, 3) each.
    """
    mesh = tessellated(shape, fineness((MeshTolerance(),), diagonal(shape))).mesh
    vertices, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int32)
    solid = trimesh.Trimesh(vertices, faces, process=False)
    at, ray, face = solid.ray.intersects_location(origins, np.broadcast_to(-EYE, origins.shape), multiple_hits=False)
    weights = trimesh.triangles.points_to_barycentric(solid.triangles[face], at)
    between = np.einsum("nc,ncd->nd", weights, corner_normals(vertices, faces)[face])
    smooth, flat = np.full(origins.shape, np.nan), np.full(origins.shape, np.nan)
    smooth[ray] = between / np.linalg.norm(between, axis=1)[:, None]
    flat[ray] = solid.face_normals[face]
    return smooth, flat


def shade(normals: np.ndarray) -> np.ndarray:
    """Brightness of a matt surface; the background is 0."""
    return np.nan_to_num(0.2 + 0.8 * np.clip(normals @ LIGHT, 0.0, 1.0))


@pytest.mark.parametrize("drawn", [housing, torus, lambda: sphere(25.0).shape, lambda: cylinder(20.0, 50.0).shape])
def test_pictures_are_those_of_the_exact_surfaces(drawn: Callable[[], Any]) -> None:
    """Within 1 of 256 levels on average; on rounds, the normals of triangles are off by half as much again."""
    shape = drawn()
    origins = rays(shape)
    exact, (smooth, flat) = exact_normals(shape, origins), mesh_normals(shape, origins)
    seen = ~np.isnan(exact[:, 0]) & ~np.isnan(smooth[:, 0])
    assert seen.sum() > SIDE**2 / 6
    assert (np.isnan(exact[:, 0]) != np.isnan(smooth[:, 0])).mean() < 0.01, "outlines"
    levels = {
        name: 255.0 * np.abs(shade(exact) - shade(normals))[seen]
        for name, normals in (("smooth", smooth), ("flat", flat))
    }
    assert levels["smooth"].mean() < 1.0
    planes = (np.abs(exact[seen]) > 1.0 - 1e-9).any(axis=1)
    assert levels["smooth"][planes].max(initial=0.0) < 1e-6, "planes are shaded evenly up to the rounds beside them"
    rounds = {name: off[~planes].mean() for name, off in levels.items()}
    assert rounds["flat"] > 1.5 * rounds["smooth"]
