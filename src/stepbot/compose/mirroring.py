"""The mirror image of a robot through a coordinate plane of its root link's frame.

With M the reflection, every frame is conjugated: R' = M R M and p' = M p, proper rotations again, so that one
coordinate axis of each frame is the negative of its image and the others are the images themselves. Axes of rotation
are pseudovectors, a' = -M a, directions of translation are vectors, a' = M a. Then the same joint positions give the
mirrored pose, and limits, mimics, gains and initial positions stay. All of this is done by changes of signs, exactly:
mirroring twice gives the same links and joints, bit for bit.
"""

from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from typing import TypeVar

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.mesh import TriMesh, surface_moments
from stepbot.geometry.spatial import Array, Pose, Vector3, tidy
from stepbot.robot.mesh_names import UniqueNames
from stepbot.robot.model import (
    Actuator,
    Collision,
    Joint,
    JointKind,
    Limit,
    LoopClosure,
    MeshAsset,
    MeshRef,
    Robot,
    Visual,
)

NORMALS: Mapping[str, tuple[float, float, float]] = {
    "x": (-1.0, 1.0, 1.0),
    "y": (1.0, -1.0, 1.0),
    "z": (1.0, 1.0, -1.0),
}
"""Diagonal of the reflection, by the normal of its plane."""
_SUFFIX = "_mirrored"
_CLOSE = 2e-9
"""Distance [m] within which vertices coincide: they are on a grid of a nanometre, as is the middle of a shape."""
_FACES = 1e-3
"""Difference of the moments of two surfaces, in sizes of the mesh, up to which they are the same: the triangles between
equal vertices may divide a curved face along other diagonals."""
_DIRECTION = np.array([1.0, 2.0**0.5, 3.0**0.5])
"""A direction along which no two vertices of a drawn shape are at the same place, but equal ones."""

_Shape = TypeVar("_Shape", Visual, Collision)


def mirrored(robot: Robot, normal: str) -> Robot:
    """The mirror image; a mesh that is the same shape as its image, perhaps moved, keeps its asset.

    Args:
        normal: Normal of the plane: ``x``, ``y`` or ``z`` of the root link's frame.
    """
    m = np.array(NORMALS[normal])
    images = {asset.name: _image(asset.mesh, m) for asset in robot.meshes}
    chiral = _named(robot.meshes, images)

    def shape(one: _Shape) -> _Shape:
        if not isinstance(one.geometry, MeshRef):  # its own image; formats without capsules name their two ends along z
            return replace(one, X_LG=conjugated(one.X_LG, m, np.array(NORMALS["y"])))
        X_LG = conjugated(one.X_LG, m)
        image = images[one.geometry.name]
        if isinstance(image, Pose):
            return replace(one, X_LG=X_LG if image.is_identity else tidy(X_LG @ image))
        return replace(one, geometry=MeshRef(chiral[one.geometry.name].name), X_LG=X_LG)

    links = (
        replace(
            link,
            mass_properties=_mass(link.mass_properties, m),
            visuals=tuple(map(shape, link.visuals)),
            collisions=tuple(map(shape, link.collisions)),
        )
        for link in robot.links
    )
    assets = (chiral.get(asset.name, asset) for asset in robot.meshes)
    return replace(
        robot,
        links=tuple(links),
        joints=tuple(_joint(joint, m) for joint in robot.joints),
        closures=tuple(_closure(closure, m) for closure in robot.closures),
        frames=tuple(replace(frame, X_LF=conjugated(frame.X_LF, m)) for frame in robot.frames),
        sensors=tuple(replace(sensor, X_LS=conjugated(sensor.X_LS, m)) for sensor in robot.sensors),
        meshes=tuple(sorted(assets, key=lambda asset: asset.name)),
    )


def conjugated(pose: Pose, m: Array, of_child: Array | None = None) -> Pose:
    """M X M for a reflection with diagonal ``m`` (3,): signs change, and nothing is rounded.

    Args:
        of_child: Diagonal of the second reflection, if the frame that is placed is mirrored through another plane.
    """
    return Pose.of(pose.R * np.outer(m, m if of_child is None else of_child) + 0.0, pose.p * m + 0.0)


def unsymmetric(before: Robot, after: Robot) -> tuple[str, ...]:
    """Components whose meshes are not their own mirror image, in the order of the meshes."""
    kept = {asset.name for asset in after.meshes}
    return tuple(dict.fromkeys(asset.source or asset.name for asset in before.meshes if asset.name not in kept))


def flipped(robot: Robot, patterns: Iterable[str]) -> Robot:
    """The same robot with the positive direction of the matching joints reversed: their position changes its sign.

    Limits change sides, and so do those of their actuators; the multipliers of joints that follow them are negated.
    """
    names = {joint.name for joint in robot.joints if any(fnmatchcase(joint.name, pattern) for pattern in patterns)}

    def joint(one: Joint) -> Joint:
        leads = one.mimic is not None and one.mimic.joint in names
        sign = -1.0 if leads != (one.name in names) else 1.0
        if one.mimic is not None:
            offset = -one.mimic.offset if one.name in names else one.mimic.offset
            one = replace(one, mimic=replace(one.mimic, multiplier=sign * one.mimic.multiplier, offset=offset + 0.0))
        if one.name not in names:
            return one
        dynamics = replace(one.dynamics, spring_reference=0.0 - one.dynamics.spring_reference)
        axis, drawn = _signed(one.axis, (-1.0, -1.0, -1.0)), 0.0 - one.drawn_position
        return replace(one, axis=axis, limit=_reversed(one.limit), dynamics=dynamics, drawn_position=drawn)

    def actuator(one: Actuator) -> Actuator:
        return replace(one, limit=_reversed(one.limit)) if one.joint in names else one

    return replace(robot, joints=tuple(map(joint, robot.joints)), actuators=tuple(map(actuator, robot.actuators)))


def _reversed(limit: Limit) -> Limit:
    return replace(limit, lower=0.0 - limit.upper, upper=0.0 - limit.lower)


def _signed(vector: Vector3, signs: Iterable[float]) -> Vector3:
    x, y, z = (value * sign + 0.0 for value, sign in zip(vector, signs, strict=True))
    return x, y, z


def _mass(body: MassProperties, m: Array) -> MassProperties:
    inertia = np.array(body.inertia) * np.outer(m, m) + 0.0
    return MassProperties.of(body.mass, _signed(body.com, m), inertia)


def _joint(joint: Joint, m: Array) -> Joint:
    turns = joint.kind is not JointKind.PRISMATIC
    axis, axis2 = (_signed(one, -m if turns else m) for one in (joint.axis, joint.axis2))
    pitch = 0.0 - joint.pitch if joint.kind is JointKind.SCREW else joint.pitch
    return replace(joint, X_PC=conjugated(joint.X_PC, m), axis=axis, axis2=axis2, pitch=pitch)


def _closure(closure: LoopClosure, m: Array) -> LoopClosure:
    axis = _signed(closure.axis, m if closure.kind is JointKind.PRISMATIC else -m)
    X_AF, X_BF = conjugated(closure.X_AF, m), conjugated(closure.X_BF, m)
    return replace(closure, X_AF=X_AF, X_BF=X_BF, axis=axis)


def _named(assets: tuple[MeshAsset, ...], images: Mapping[str, TriMesh | Pose]) -> dict[str, MeshAsset]:
    """The asset of each image that is another shape; the image of an image has the first name again."""
    taken = UniqueNames(asset.name for asset in assets)
    named = {}
    for asset in assets:
        image = images[asset.name]
        if isinstance(image, TriMesh):
            is_back = asset.name.endswith(_SUFFIX)
            name = asset.name.removesuffix(_SUFFIX) if is_back else taken.unique(asset.name + _SUFFIX)
            named[asset.name] = replace(asset, name=name, mesh=image)
    return named


def _image(mesh: TriMesh, m: Array) -> TriMesh | Pose:
    """The image of a mesh; if it is the same shape at another place, that place in the frame of the mesh.

    A shape that is symmetric about a coordinate plane through its middle c is moved by its reflection: by R p + t with
    R = M M_k and t = M (c - M_k c), where M_k reflects through that plane.
    """
    low, high = (np.array(corner) for corner in mesh.bounds) if len(mesh.vertices) else (np.zeros(3), np.zeros(3))
    c = 0.5 * (low + high)
    for k in sorted((np.array(signs) for signs in NORMALS.values()), key=lambda signs: not np.array_equal(signs, m)):
        if _same_shape(mesh, (mesh.vertices - c) * k + c):
            return Pose.of(np.diag(m * k), m * (c - k * c) + 0.0)
    return TriMesh.of(mesh.vertices * m, mesh.faces[:, ::-1])


def _same_shape(mesh: TriMesh, moved: Array) -> bool:
    """Whether a mesh is the same shape with its vertices at ``moved`` (n, 3) [m], in another order."""
    order = (np.argsort(points @ _DIRECTION, kind="stable") for points in (mesh.vertices, moved))
    a, b = (points[index] for points, index in zip((mesh.vertices, moved), order, strict=True))
    size = float(np.abs(mesh.vertices).max(initial=0.0)) or 1.0
    if np.abs(a - b).max(initial=0.0) > _CLOSE:
        return False
    here, there = (_moments(points / size, mesh.faces) for points in (mesh.vertices, moved))
    return bool(np.allclose(here, there, rtol=0.0, atol=_FACES))


def _moments(points: Array, faces: NDArray[np.int32]) -> Array:
    """Twice the area, the first and the second moments of a surface, about the origin."""
    area, centroid, second = surface_moments(points, faces)
    about_origin = second + area * np.outer(centroid, centroid)
    return 2.0 * np.concatenate([[area], area * centroid, about_origin.ravel()])
