"""Visuals and collisions of bodies: bounding boxes and colours."""

from typing import Any

import numpy as np

from stepbot.geometry.primitives import srgb_from_linear
from stepbot.geometry.spatial import bounds
from stepbot.robot.bounding_boxes import Bounds, primitive_bounds
from stepbot.robot.model import Box, Capsule, Cylinder, Sphere
from stepbot.robot.surfaces import Surface

from ..observation import ObservedShape
from .stage import Body, Stage, name_of, rigid

_TO_Z = {
    "X": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
    "Y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "Z": np.eye(3),
}
"""Rotations whose z is an axis."""


def shapes(stage: Stage, body: Body) -> tuple[tuple[ObservedShape, ...], tuple[ObservedShape, ...]]:
    """Visuals and collisions of a body; a shape can be both."""
    from pxr import UsdGeom, UsdPhysics

    visuals, collisions = list[ObservedShape](), list[ObservedShape]()
    for prim in stage.content(body):
        if not prim.IsA(UsdGeom.Gprim):
            continue
        name, bounds = name_of(_named(prim)), _bounds(stage, prim, body)
        if prim.HasAPI(UsdPhysics.CollisionAPI) and UsdPhysics.CollisionAPI(prim).GetCollisionEnabledAttr().Get():
            collisions.append(ObservedShape(name, bounds=bounds, surface=_surface(prim)))
        if UsdGeom.Imageable(prim).ComputePurpose() != UsdGeom.Tokens.guide:
            visuals.append(ObservedShape(name, _color(prim), bounds=bounds))
    return tuple(visuals), tuple(collisions)


def _surface(prim: Any) -> Surface:
    """Friction and restitution of the material that physics uses, as far as they are given."""
    from pxr import UsdPhysics, UsdShade

    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")
    if not material or not material.GetPrim().HasAPI(UsdPhysics.MaterialAPI):
        return Surface()
    api = UsdPhysics.MaterialAPI(material.GetPrim())
    friction, restitution = api.GetDynamicFrictionAttr(), api.GetRestitutionAttr()
    given = (float(one.Get()) if one.HasAuthoredValue() else None for one in (friction, restitution))
    sliding, bounce = given
    return Surface(sliding, restitution=bounce)


def _named(prim: Any) -> Any:
    """The prim that a shape has its name from: the instance that it is in, or itself."""
    while prim.IsInstanceProxy():
        prim = prim.GetParent()
    return prim


def _bounds(stage: Stage, prim: Any, body: Body) -> Bounds | None:
    """Lowest and highest corner [m] in the frame of the body; None if this reader does not know the shape."""
    from pxr import UsdGeom

    M = stage.in_body(prim, body)
    if prim.IsA(UsdGeom.Mesh):
        points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get() or (), dtype=np.float64).reshape(-1, 3)
        return bounds(points @ M[:3, :3].T + M[:3, 3]) if len(points) else None
    X, scale = rigid(M)
    if prim.IsA(UsdGeom.Cube):
        x, y, z = (scale * float(UsdGeom.Cube(prim).GetSizeAttr().Get())).tolist()
        return primitive_bounds(Box((x, y, z)), X)
    if float(np.ptp(scale)) > 1e-12 * float(scale.max()):
        return None
    size = float(scale[0])
    if prim.IsA(UsdGeom.Sphere):
        return primitive_bounds(Sphere(size * float(UsdGeom.Sphere(prim).GetRadiusAttr().Get())), X)
    for type_, kind in ((UsdGeom.Cylinder, Cylinder), (UsdGeom.Capsule, Capsule)):
        if prim.IsA(type_):
            shape = type_(prim)
            turned = _TO_Z[str(shape.GetAxisAttr().Get())]
            radius, height = (size * float(a.Get()) for a in (shape.GetRadiusAttr(), shape.GetHeightAttr()))
            return primitive_bounds(kind(radius, height), type(X).of(X.R @ turned, X.p))
    return None


def _color(prim: Any) -> tuple[float, ...]:
    """Colour and opacity of the bound material, or else the display colour; sRGB; empty if there is none."""
    from pxr import UsdGeom, UsdShade

    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    surface = material.ComputeSurfaceSource()[0] if material else None
    if surface and surface.GetIdAttr().Get() == "UsdPreviewSurface":
        color, opacity = (surface.GetInput(name) for name in ("diffuseColor", "opacity"))
        seen = color.Get() if color else None
        if seen is not None:
            alpha = opacity.Get() if opacity else None
            return (*map(srgb_from_linear, seen), 1.0 if alpha is None else float(alpha))
    shown = UsdGeom.Gprim(prim).GetDisplayColorAttr().Get()
    return (*map(srgb_from_linear, shown[0]), 1.0) if shown else ()
