"""yourdfpy as an observer of URDF: an independent parser with forward kinematics that supports mimics.

It has no dynamics; meshes are checked by the simulating engines only. https://github.com/clemense/yourdfpy
"""

from collections.abc import Mapping
from math import inf
from typing import Any

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.mass_properties import EXTRAS
from stepbot.geometry.spatial import Pose, matrix3, turn_inertia, unit, vector3
from stepbot.robot.joint_types import PAIRS
from stepbot.robot.model import JointDynamics, Limit, Mimic
from stepbot.runtime.import_path import import_lightly

from ..captured_output import logged
from ..distribution import provider
from ..observation import (
    EngineCannotRead,
    EngineRefused,
    Observation,
    ObservedJoint,
    ObservedLink,
    ObservedShape,
    Quantity,
    Request,
)
from ..urdf_versions import readable
from . import ENGINE

_NO_DYNAMICS = "yourdfpy has no dynamics"
_EXTENSION = "yourdfpy ignores the extension blocks that contain it"
_NOT_RUN: Mapping[Quantity, str] = {
    Quantity.MASS_MATRIX: _NO_DYNAMICS,
    Quantity.GRAVITY: _NO_DYNAMICS,
    Quantity.INVERSE_DYNAMICS: _NO_DYNAMICS,
    Quantity.SIMULATION: _NO_DYNAMICS,
    Quantity.MESHES: "checked by the simulating engines only",
    Quantity.CLOSURES: "URDF cannot represent closed loops",
    Quantity.ACTUATORS: _EXTENSION,
    Quantity.SENSORS: _EXTENSION,
}
_EIGHT_BITS = "out of bounds for uint8"
"""The end of numpy's message on a colour that yourdfpy converts for its scene."""


def prepare() -> None:
    """Import the engine's slow modules, without the extras of trimesh."""
    import_lightly("yourdfpy", EXTRAS)


def observe(request: Request) -> Observation:
    """Parse the file and report its content.

    Raises:
        EngineRefused: yourdfpy cannot build a tree from it.
        EngineCannotRead: It has colours outside of 0 to 1.
    """
    import yourdfpy as engine

    with readable(request, capsules=False) as (read, notes), logged("yourdfpy") as warnings:
        try:
            urdf = engine.URDF.load(read.file, load_meshes=False, build_collision_scene_graph=False)
            urdf.validate()
            joints = tuple(_joint(joint) for joint in urdf.robot.joints)
            chained = _mimic_chains(joints)
            poses = () if chained else tuple(_poses(urdf, q) for q in [*request.configurations, *request.closed])
        except OverflowError as error:
            if _EIGHT_BITS not in str(error):
                raise EngineRefused(f"OverflowError: {error}") from error
            raise EngineCannotRead("yourdfpy has no colours outside of 0 to 1") from error
        except (ArithmeticError, ValueError, LookupError, TypeError, AttributeError, engine.urdf.URDFError) as error:
            raise EngineRefused(f"{type(error).__name__}: {error}") from error
    not_run = dict(_NOT_RUN)
    if chained:
        not_run[Quantity.POSES] = f"yourdfpy does not follow a mimic of a mimic: {', '.join(chained)}"
        warnings = [text for text in warnings if "supposed to mimic" not in text]
    unmoved = [f"'{joint.name}' ({joint.kind})" for joint in joints if joint.kind in ("planar", "floating")]
    if unmoved:
        not_run[Quantity.POSES] = f"yourdfpy does not move these joints: {', '.join(unmoved)}"
    return Observation(
        engine=ENGINE.name,
        **provider("yourdfpy"),
        format=request.format,
        name=urdf.robot.name,
        links=tuple(_link(link) for link in urdf.robot.links),
        joints=joints,
        coordinates=tuple(joint.name for joint in joints if joint.kind in PAIRS),
        poses=poses,
        warnings=tuple(dict.fromkeys([*warnings, *(str(error) for error in urdf.errors)])),
        not_run=not_run,
        notes=notes,
    )


def _link(link: Any) -> ObservedLink:
    inertial = link.inertial
    bare = ObservedLink(
        link.name,
        0.0,
        has_visuals=bool(link.visuals),
        has_collisions=bool(link.collisions),
        visuals=tuple(ObservedShape(shape.name or "", _rgba(shape.material)) for shape in link.visuals),
        collisions=tuple(ObservedShape(shape.name or "") for shape in link.collisions),
    )
    if inertial is None:
        return bare
    X_LI = Pose() if inertial.origin is None else Pose.from_matrix(inertial.origin)
    inertia = np.zeros((3, 3)) if inertial.inertia is None else inertial.inertia
    return replace(
        bare, mass=float(inertial.mass or 0.0), com=X_LI.position, inertia=matrix3(turn_inertia(X_LI.R, inertia))
    )


def _rgba(material: Any) -> tuple[float, ...]:
    """The colour that is a visual's own."""
    if material is None or material.color is None:
        return ()
    return tuple(float(channel) for channel in material.color.rgba)


def _joint(joint: Any) -> ObservedJoint:
    if joint.type not in PAIRS:
        axis = vector3(unit(joint.axis)) if joint.type == "planar" else None
        return ObservedJoint(joint.name, joint.type, joint.parent, joint.child, axis=axis, mimic_read=True)
    mimic = joint.mimic
    return ObservedJoint(
        joint.name,
        joint.type,
        joint.parent,
        joint.child,
        axis=vector3(unit(joint.axis)),
        limit=_limit(joint),
        dynamics=JointDynamics(
            damping=float((joint.dynamics and joint.dynamics.damping) or 0.0),
            friction=float((joint.dynamics and joint.dynamics.friction) or 0.0),
        ),
        mimic=None if mimic is None else Mimic(mimic.joint, float(mimic.multiplier), float(mimic.offset)),
        mimic_read=True,
    )


def _limit(joint: Any) -> Limit:
    given = joint.limit
    if given is None:
        return Limit()
    bounded = joint.type != "continuous"
    return Limit(  # without both bounds, engines take the joint as unlimited; the file that is read has both or none
        lower=_number(given.lower, -inf) if bounded else -inf,
        upper=_number(given.upper, inf) if bounded else inf,
        velocity=_number(given.velocity, inf),
        effort=_number(given.effort, inf),
    )


def _number(value: float | None, default: float) -> float:
    return default if value is None else float(value)


def _mimic_chains(joints: tuple[ObservedJoint, ...]) -> list[str]:
    """Joints that mimic a mimicking joint."""
    followers = {joint.name for joint in joints if joint.mimic}
    return [joint.name for joint in joints if joint.mimic and joint.mimic.joint in followers]


def _poses(urdf: Any, q: Mapping[str, float]) -> dict[str, Pose]:
    """Pose of every link: the product of yourdfpy's transforms between links.

    The scene's own product leaves out transforms that differ from the identity by less than 1e-8.
    """
    urdf.update_cfg({name: q.get(name, 0.0) for name in urdf.actuated_joint_names})
    forest = urdf.scene.graph.transforms
    poses = {urdf.base_link: Pose()}
    for link in urdf.robot.links:
        path, name = list[str](), link.name
        while name not in poses:
            path.append(name)
            name = forest.parents[name]
        for child in reversed(path):
            matrix = forest.edge_data[forest.parents[child], child].get("matrix")
            poses[child] = poses[forest.parents[child]] @ (Pose() if matrix is None else Pose.from_matrix(matrix))
    return {link.name: poses[link.name] for link in urdf.robot.links}
