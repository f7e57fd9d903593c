"""The shapes of a link as Drake has read them: bounding boxes, names, colours."""

from pathlib import Path
from typing import Any

import numpy as np

from stepbot.geometry.spatial import Pose, vector3
from stepbot.robot.bounding_boxes import Bounds, mesh_bounds, primitive_bounds
from stepbot.robot.model import Box, Capsule, Cylinder, Sphere
from stepbot.robot.surfaces import Surface

from ..observation import EngineCannotRead, ObservedShape
from ..shape_bounds import vertices_of
from .coordinates import pose
from .plant import Built

_MEASURED = (".obj", ".vtk", ".gltf")
"""Suffixes of meshes that Drake makes hulls of."""


def bounds_of(built: Built, geometry: Any) -> Bounds | None:
    """Bounding box [m] of a shape in its link's frame; of meshes that Drake only displays, from the file."""
    inspector = built.scene.model_inspector()
    X_LG, shape = pose(inspector.GetPoseInFrame(geometry)), inspector.GetShape(geometry)
    file = Path(str(shape.source().path())) if type(shape).__name__ == "Mesh" else None
    if file is not None and file.suffix.lower() not in _MEASURED:
        vertices = vertices_of(file)
        return None if vertices is None else mesh_bounds(np.array(shape.scale3()) * vertices, X_LG)
    hull = inspector.GetConvexHull(geometry)  # of meshes only
    if hull is not None:
        vertices = np.array([hull.vertex(index) for index in range(hull.num_vertices())])
        return mesh_bounds(vertices, X_LG)
    return _primitive_bounds(shape, X_LG)


def observed_shape(built: Built, geometry: Any, *, seen: bool) -> ObservedShape:
    """Name of a shape; colours of a visual, friction of a collision."""
    inspector = built.scene.model_inspector()
    name = inspector.GetName(geometry).removeprefix(f"{built.name}::")
    if not seen:
        return ObservedShape(name, surface=_surface(built, geometry))
    properties = inspector.GetIllustrationProperties(geometry)
    shaded = built.request.format.endswith("sdf")
    return ObservedShape(name, _color(properties, "diffuse"), _color(properties, "ambient") if shaded else None)


def _surface(built: Built, geometry: Any) -> Surface | None:
    """Friction of a collision; Drake reads that of SDFormat, and of URDF only its own."""
    properties = built.scene.model_inspector().GetProximityProperties(geometry)
    if not built.request.format.endswith("sdf") or not properties.HasProperty("material", "coulomb_friction"):
        return None
    return Surface(properties.GetProperty("material", "coulomb_friction").dynamic_friction())


def _color(properties: Any, name: str) -> tuple[float, ...]:
    """Red, green, blue and opacity; empty if the shape has no such colour."""
    if properties is None or not properties.HasProperty("phong", name):
        return ()
    color = properties.GetProperty("phong", name)
    return color.r(), color.g(), color.b(), color.a()


def _primitive_bounds(shape: Any, X_LG: Pose) -> Bounds:
    """Bounding box of a primitive.

    Raises:
        EngineCannotRead: The shape is of a type that the formats do not have.
    """
    kind = type(shape).__name__
    if kind == "Box":
        return primitive_bounds(Box(vector3(shape.size())), X_LG)
    if kind == "Sphere":
        return primitive_bounds(Sphere(shape.radius()), X_LG)
    if kind == "Cylinder":
        return primitive_bounds(Cylinder(shape.radius(), shape.length()), X_LG)
    if kind == "Capsule":
        return primitive_bounds(Capsule(shape.radius(), shape.length()), X_LG)
    if kind == "Ellipsoid":
        half = np.sqrt(((X_LG.R * np.array([shape.a(), shape.b(), shape.c()])) ** 2).sum(axis=1))
        return vector3(X_LG.p - half), vector3(X_LG.p + half)
    raise EngineCannotRead(f"Drake reports a shape of kind {kind}")
