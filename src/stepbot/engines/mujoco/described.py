"""MJCF as MuJoCo compiles it, without the meshes and textures whose files are missing."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from stepbot.geometry.spatial import Array, Pose

from ..description.description import DescribedShape, Description
from ..description.meshes import corners
from ..observation import EngineRefused, Request
from .compiled import Compiled
from .observer import observe_model


def describe_mjcf(file: str) -> Description:
    """Read an MJCF.

    Raises:
        EngineRefused: MuJoCo does not compile it.
    """
    import mujoco as engine

    from .motion import close_by_newton

    path = Path(file)
    try:
        spec = engine.MjSpec.from_file(file)
        unread = _drop_missing(spec, path.parent)
        model = spec.compile()
    except ValueError as error:
        raise EngineRefused(str(error).replace(f"{path.parent.as_posix()}/", "").strip()) from error
    compiled = Compiled(engine, model, {})
    request = Request(file, "mjcf", configurations=({},), simulate=0.0)
    observation = replace(observe_model(compiled, request), closures=close_by_newton(compiled, request))
    poses = observation.poses[0]
    X_PC = {
        joint.child: poses[joint.parent].inverse() @ poses[joint.child]
        for joint in observation.joints
        if joint.parent in poses
    }
    shapes = tuple(shape for body in compiled.bodies for shape in _shapes(compiled, body))
    return Description(observation, X_PC, shapes, unread)


def _drop_missing(spec: Any, folder: Path) -> tuple[str, ...]:
    """Remove references to missing meshes, height fields and textures; returns the files as in the description."""
    missing = set()
    for mesh in list(spec.meshes):
        if mesh.file and not _is_there(folder, spec.meshdir, mesh.file):
            missing.add(mesh.file)
            for geom in [geom for geom in spec.geoms if geom.meshname == mesh.name]:
                spec.delete(geom)
            spec.delete(mesh)
    gone = {
        texture.name
        for texture in spec.textures
        if any(name and not _is_there(folder, spec.texturedir, name) for name in (texture.file, *texture.cubefiles))
    }
    for material in spec.materials:
        material.textures = ["" if name in gone else name for name in material.textures]
    for texture in [texture for texture in spec.textures if texture.name in gone]:
        spec.delete(texture)
    return tuple(sorted(missing))


def _is_there(folder: Path, below: str, name: str) -> bool:
    return (folder / below / name).is_file() or (folder / name).is_file()


def _shapes(compiled: Compiled, body: int) -> list[DescribedShape]:
    """Geoms of a body that are visual only; all geoms if there are none."""
    model = compiled.model
    geoms = list(range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body]))
    seen = [g for g in geoms if not (model.geom_contype[g] or model.geom_conaffinity[g])]
    found = []
    for g in seen or geoms:
        points = _points(compiled, g)
        if points is not None:
            X_LG = Pose.from_quaternion(model.geom_quat[g].tolist(), model.geom_pos[g])
            name = compiled.name("GEOM", g) or compiled.name("MESH", int(model.geom_dataid[g]))
            found.append(DescribedShape(compiled.name("BODY", body), name, X_LG.apply(points)))
    return found


def _points(compiled: Compiled, g: int) -> Array | None:
    engine, model = compiled.engine, compiled.model
    kind, size = engine.mjtGeom(model.geom_type[g]), model.geom_size[g].tolist()
    if kind == engine.mjtGeom.mjGEOM_MESH:
        mesh = model.geom_dataid[g]
        start = model.mesh_vertadr[mesh]
        return np.asarray(model.mesh_vert[start : start + model.mesh_vertnum[mesh]], dtype=np.float64)
    if kind in (engine.mjtGeom.mjGEOM_BOX, engine.mjtGeom.mjGEOM_ELLIPSOID):
        return corners((size[0], size[1], size[2]), Pose())
    if kind == engine.mjtGeom.mjGEOM_SPHERE:
        return corners((size[0], size[0], size[0]), Pose())
    if kind in (engine.mjtGeom.mjGEOM_CYLINDER, engine.mjtGeom.mjGEOM_CAPSULE):
        ends = size[0] if kind == engine.mjtGeom.mjGEOM_CAPSULE else 0.0
        return corners((size[0], size[0], size[1] + ends), Pose())
    return None  # planes and height fields
