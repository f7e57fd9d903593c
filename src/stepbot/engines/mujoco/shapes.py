"""The shapes of a link as MuJoCo has read them: bounding boxes, names, colours."""

from math import inf, isclose
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.primitives import Primitive, primitive
from stepbot.geometry.spatial import Pose, vector3
from stepbot.robot.bounding_boxes import Bounds, mesh_bounds, primitive_bounds
from stepbot.robot.surfaces import Surface, restitution_of

from ..observation import OBLIQUE, ObservedShape

if TYPE_CHECKING:
    from .compiled import Compiled


_DEFAULT_COLOR = [0.5, 0.5, 0.5, 1.0]
_FRICTION, _CONDIM = (1.0, 0.005, 0.0001), 3
"""MuJoCo's defaults: sliding, torsional [m] and rolling [m] friction, without the last two."""
_TIMES = (0.02, 0.004)
"""Time constants [s] of contacts: MuJoCo's, and that of all files of stepbot."""
_SHOWN = 2
"""The last group of geoms that viewers show by default."""


def observed_shapes(compiled: "Compiled", body: int, *, touched: bool, mjcf: bool) -> tuple[ObservedShape, ...]:
    """The collision shapes, or the visual ones; for URDF, MuJoCo keeps no names of them."""
    shapes = []
    for g in geoms(compiled, body):
        if not (collides(compiled, g) if touched else is_visual(compiled, g, mjcf=mjcf)):
            continue
        model = compiled.model
        X_LG = Pose.from_quaternion(model.geom_quat[g].tolist(), model.geom_pos[g])
        shape = ObservedShape()
        if touched or stray_mesh(compiled, g) is None:
            upright, oblique = (geom_bounds(compiled, g, X) for X in (X_LG, OBLIQUE @ X_LG))
            shape = ObservedShape(bounds=upright, oblique=oblique)
        if mjcf:
            rgba = None if touched else color_of(compiled, g)
            flags = (model.geom_group, model.geom_contype, model.geom_conaffinity)
            shape = replace(
                shape, name=compiled.name("GEOM", g), rgba=rgba, groups=tuple(int(each[g]) for each in flags)
            )
        if mjcf and touched:
            shape = replace(shape, surface=surface_of(compiled, g))
        shapes.append(shape)
    return tuple(shapes)


def color_of(compiled: "Compiled", g: int) -> tuple[float, float, float, float]:
    """Colour of a geom: its own, or that of its material if its own is MuJoCo's default."""
    model = compiled.model
    own, material = model.geom_rgba[g].tolist(), int(model.geom_matid[g])
    r, g_, b, a = own if material < 0 or own != _DEFAULT_COLOR else model.mat_rgba[material].tolist()
    return r, g_, b, a


def surface_of(compiled: "Compiled", g: int) -> Surface:
    """The contact properties of a geom that are not MuJoCo's own, nor stepbot's for all geoms."""
    model, condim = compiled.model, int(compiled.model.geom_condim[g])
    sliding, torsional, rolling = (float(value) for value in model.geom_friction[g])
    stated = bool(model.geom_priority[g]) or condim != _CONDIM or (sliding, torsional, rolling) != _FRICTION
    time, ratio = model.geom_solref[g].tolist()
    softness = None if min(time, ratio) <= 0.0 else time * min(ratio, 1.0)
    return Surface(
        friction=(sliding if condim > 1 else 0.0) if stated else None,
        torsional=torsional if condim >= 4 else None,
        rolling=rolling if condim == 6 else None,
        restitution=restitution_of(ratio) if 0.0 < ratio < 1.0 else None,
        softness=None if softness is None or any(isclose(softness, one) for one in _TIMES) else softness,
    )


def geoms(compiled: "Compiled", body: int) -> range:
    """The geoms of a body."""
    model = compiled.model
    return range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body])


def collides(compiled: "Compiled", g: int) -> bool:
    """Whether a geom collides with anything."""
    return bool(compiled.model.geom_contype[g] or compiled.model.geom_conaffinity[g])


def is_visual(compiled: "Compiled", g: int, *, mjcf: bool) -> bool:
    """Whether a geom is a visual: it never collides, or viewers show it although it does; URDF has no such shapes."""
    return not collides(compiled, g) or (mjcf and int(compiled.model.geom_group[g]) <= _SHOWN)


def stray_mesh(compiled: "Compiled", g: int) -> str | None:
    """The mesh of a geom if it is one of :attr:`Compiled.stray_meshes`."""
    engine, model = compiled.engine, compiled.model
    is_mesh = engine.mjtGeom(model.geom_type[g]) == engine.mjtGeom.mjGEOM_MESH
    mesh = int(model.geom_dataid[g])
    return compiled.name("MESH", mesh) if is_mesh and mesh in compiled.stray_meshes else None


def geom_bounds(compiled: "Compiled", g: int, X_LG: Pose) -> Bounds:
    """Bounding box of a geom in a frame L."""
    engine, model = compiled.engine, compiled.model
    kind, size = engine.mjtGeom(model.geom_type[g]), model.geom_size[g].tolist()
    if kind == engine.mjtGeom.mjGEOM_MESH:
        # MuJoCo stores vertices about the mesh's centre and adds the offset to the pose of the geom.
        return mesh_bounds(np.asarray(compiled.vertices(model.geom_dataid[g]), dtype=np.float64), X_LG)
    if kind == engine.mjtGeom.mjGEOM_ELLIPSOID:
        half = np.sqrt(((X_LG.R * np.array(size)) ** 2).sum(axis=1))
        return vector3(X_LG.p - half), vector3(X_LG.p + half)
    shape = primitive_of(compiled, g)
    return ((-inf, -inf, -inf), (inf, inf, inf)) if shape is None else primitive_bounds(shape, X_LG)


def primitive_of(compiled: "Compiled", g: int) -> Primitive | None:
    """The shape of a geom, of which MuJoCo has half lengths; None for meshes, ellipsoids, planes and height fields."""
    kind, size = compiled.engine.mjtGeom(compiled.model.geom_type[g]), compiled.model.geom_size[g].tolist()
    edges = (2.0 * size[0], 2.0 * size[1], 2.0 * size[2])
    return primitive(kind.name.removeprefix("mjGEOM_").lower(), size=edges, radius=size[0], length=edges[1])
