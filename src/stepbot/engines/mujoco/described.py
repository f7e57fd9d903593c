"""MJCF as MuJoCo compiles it, without the meshes and textures whose files are missing."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.model import Box, Capsule, Cylinder, Sphere

from ..description.description import DescribedShape, Description, Primitive
from ..observation import EngineRefused, Request
from .compiled import Compiled
from .observer import observe_model
from .warnings import collected_warnings


@collected_warnings()
def describe_mjcf(file: str, _packages: Iterable[Path] = ()) -> Description:
    """Read an MJCF, whose meshes are relative to it.

    Raises:
        EngineRefused: MuJoCo does not compile it, or it has no bodies.
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
    if model.nbody < 2:  # the first one is the world
        raise EngineRefused("the file has no bodies")
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


def _shapes(compiled: Compiled, body: int) -> Iterator[DescribedShape]:
    """Geoms of a body: visuals if they never collide."""
    model = compiled.model
    for g in range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body]):
        geometry = _geometry(compiled, g)
        if geometry is None:
            continue
        X_LG = Pose.from_quaternion(model.geom_quat[g].tolist(), model.geom_pos[g])
        name = compiled.name("GEOM", g) or compiled.name("MESH", int(model.geom_dataid[g]))
        collides = bool(model.geom_contype[g] or model.geom_conaffinity[g])
        material = int(model.geom_matid[g])
        r, g_, b, a = (model.geom_rgba[g] if material < 0 else model.mat_rgba[material]).tolist()
        yield DescribedShape(compiled.name("BODY", body), name, geometry, X_LG, (r, g_, b, a), collides)


def _geometry(compiled: Compiled, g: int) -> TriMesh | Primitive | None:
    engine, model = compiled.engine, compiled.model
    kind, size = engine.mjtGeom(model.geom_type[g]), model.geom_size[g].tolist()
    if kind == engine.mjtGeom.mjGEOM_MESH:
        mesh = model.geom_dataid[g]
        start, first = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
        vertices = model.mesh_vert[start : start + model.mesh_vertnum[mesh]]
        return TriMesh.of(vertices, model.mesh_face[first : first + model.mesh_facenum[mesh]])
    if kind == engine.mjtGeom.mjGEOM_ELLIPSOID:
        return _ellipsoid(np.array(size))
    if kind == engine.mjtGeom.mjGEOM_BOX:
        return Box((2.0 * size[0], 2.0 * size[1], 2.0 * size[2]))
    if kind == engine.mjtGeom.mjGEOM_SPHERE:
        return Sphere(size[0])
    if kind == engine.mjtGeom.mjGEOM_CYLINDER:
        return Cylinder(size[0], 2.0 * size[1])
    if kind == engine.mjtGeom.mjGEOM_CAPSULE:
        return Capsule(size[0], 2.0 * size[1])
    return None  # planes and height fields


def _ellipsoid(radii: Array) -> TriMesh:
    """An ellipsoid as triangles, for drawing."""
    rings, columns = 12, 24
    polar, around = np.meshgrid(np.linspace(0.0, np.pi, rings + 1), np.arange(columns) * 2.0 * np.pi / columns)
    points = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    index = np.arange((rings + 1) * columns).reshape(columns, rings + 1)
    a, b = index[:, :-1].ravel(), np.roll(index, -1, axis=0)[:, :-1].ravel()
    faces = np.concatenate([np.column_stack([a, a + 1, b + 1]), np.column_stack([a, b + 1, b])])
    return TriMesh.of(points.reshape(-1, 3) * radii, faces)
