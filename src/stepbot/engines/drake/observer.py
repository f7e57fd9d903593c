"""Drake as an observer of SDFormat, URDF and MJCF: libsdformat's poses and frames, and Drake's own plant.

Drake does not support joints that close loops: a robot with loops gets a separate file, with ball constraints. Warnings
about features that Drake does not support, such as joint friction, are noted; they are not faults of the file.
https://drake.mit.edu/pydrake/pydrake.multibody.parsing.html
"""

import re
from collections.abc import Mapping
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.primitives import primitive
from stepbot.geometry.spatial import Array, Pose, matrix3, shift_inertia, vector3
from stepbot.robot.bounding_boxes import Bounds, mesh_bounds, primitive_bounds
from stepbot.robot.dynamics import Rates
from stepbot.robot.model import JointDynamics, Limit
from stepbot.robot.surfaces import Surface

from ..ball_coordinates import inner_joints
from ..captured_output import logged
from ..distribution import provider
from ..observation import (
    Dynamics,
    EngineCannotRead,
    Observation,
    ObservedJoint,
    ObservedLink,
    ObservedShape,
    Quantity,
    Request,
)
from ..resources import joined_boxes, vertices_of
from ..urdf_versions import readable
from ..xml import xml_root
from . import ENGINE
from .coordinates import pose
from .plant import CHANGES, BuiltPlant, axis_of, build

_NOT_TOLD = "pydrake does not report it"
_EFFORTS = "Drake stores effort limits per actuator; they are compared as joint limits"
_NO_SENSORS = "Drake ignores sensors"
_NOT_RUN: Mapping[str, Mapping[Quantity, str]] = {
    "urdf": {
        Quantity.CLOSURES: "URDF cannot represent closed loops",
        Quantity.MIMIC: _NOT_TOLD,
        Quantity.ACTUATORS: _EFFORTS,
        Quantity.SENSORS: _NO_SENSORS,
    },
    "sdf": {
        Quantity.MIMIC: "Drake ignores <mimic> in SDFormat",
        Quantity.ACTUATORS: _EFFORTS,
        Quantity.SENSORS: _NO_SENSORS,
    },
    "mjcf": {
        Quantity.MIMIC: "Drake ignores joint equalities",
        Quantity.CLOSURES: "Drake ignores site equalities",
        Quantity.FRAMES: "Drake ignores sites",
        Quantity.ACTUATORS: "Drake reads motors only",
        Quantity.SENSORS: _NO_SENSORS,
        Quantity.LIMITS: "Drake ignores actuatorfrcrange",
    },
}
_SUFFIXES = {"urdf": ".urdf", "mjcf": ".xml"}
_GAP = re.compile(r"not (currently |yet )?support|unsupported|not implemented|(will be|element) ignored", re.IGNORECASE)
"""Drake's warnings about features that it reads but does not support."""
_PLACE = re.compile(r"^.*?(warning|error): ", re.DOTALL)


def prepare() -> None:
    """Import the engine's slow modules."""
    import pydrake.multibody.parsing
    import pydrake.multibody.plant  # noqa: F401


def observe(request: Request) -> Observation:
    """Parse the file and report its content; to be run in a worker, because Drake aborts on some invalid files.

    Raises:
        EngineRefused: Drake rejects the file.
        EngineCannotRead: The file has features that Drake is known not to read.
    """
    from .plant import closures_in, simulate

    path, suffix = Path(request.file), _SUFFIXES.get(request.format, ".sdf")
    if path.suffix != suffix:
        raise EngineCannotRead(f"Drake takes the format of a file from its name, which ends with {suffix} for this one")
    if request.format == "mjcf":
        _check_mjcf(path)
    unmoved = inner_joints(path) if request.format == "urdf" else ""
    if unmoved:
        raise EngineCannotRead(f"Drake names the coordinates of these joints itself, or gives them none: {unmoved}")
    with readable(request, changes=CHANGES.get(request.format, ())) as (request, replaced), logged("drake") as lines:
        built = build(request)
        observation = _static(built, request)
        if request.closures and request.format == "drake.sdf":
            observation = replace(observation, closures=closures_in(built, request))
        if request.simulate:
            observation = replace(observation, simulation_finite=simulate(built, request))
    messages = [_plain(line, Path(request.file).parent) for line in lines]
    gaps = [message for message in messages if _GAP.search(message)]
    warnings = [message for message in messages if message not in gaps]
    if built.rounded:
        words = "compared without Drake's rounding of axes less than 2e-8 rad from a coordinate axis:"
        replaced = (*replaced, f"{words} {', '.join(built.rounded)}")
    return replace(observation, warnings=tuple(dict.fromkeys(warnings)), notes=(*dict.fromkeys(gaps), *replaced))


def _plain(message: str, folder: Path) -> str:
    """One of Drake's messages, without folders and line numbers."""
    return " ".join(_PLACE.sub("", message, count=1).replace(f"{folder.as_posix()}/", "").split())


def _check_mjcf(path: Path) -> None:
    """Reject known failures of Drake: bodies with several joints or no mass, infinite ranges, meshes other than OBJ.

    Neither are bodies read that joints connect to the world, which Drake's models do not contain.

    Raises:
        EngineCannotRead: The file has one of them.
    """
    top = xml_root(path)
    if any(len(body.findall("joint")) > 1 for body in top.iter("body")):
        raise EngineCannotRead("Drake uses wrong axes for several joints in one body")
    if any("inf" in joint.get("range", "") for joint in top.iter("joint")):
        raise EngineCannotRead("Drake does not support infinite ranges in MJCF")
    if any(not mesh.get("file", "").lower().endswith(".obj") for mesh in top.iter("mesh") if mesh.get("file")):
        raise EngineCannotRead("Drake reads meshes of an MJCF as OBJ only")
    if any(float(inertial.get("mass") or 1.0) == 0.0 for inertial in top.iter("inertial")):
        raise EngineCannotRead("Drake aborts on a massless body in MJCF")
    hinged = (joint for world in top.iter("worldbody") for joint in world.iterfind("body/joint"))
    if any(joint.get("type") != "free" for joint in hinged):
        raise EngineCannotRead("Drake's models do not contain the world, to which a joint connects a body")


def _static(built: BuiltPlant, request: Request) -> Observation:
    format_name = "sdf" if request.format == "drake.sdf" else request.format
    held = any(joint.child_body().index() == built.root.index() for joint in built.joints)
    moving = build(request, bare=True, exact=True) if built.rounded else built
    return Observation(
        engine=ENGINE.name,
        **provider("pydrake"),
        format=request.format,
        name=built.name,
        base=None if format_name == "urdf" else "fixed" if held else "floating",
        links=tuple(_link(built, body) for body in built.bodies),
        joints=_joints(built),
        coordinates=moving.coordinates.names,
        poses=tuple(_poses(moving, q) for q in [*request.configurations, *request.closed]),
        dynamics=tuple(_dynamics(moving, *at) for at in request.moments),
        frames=_frames(built) if format_name == "sdf" else None,
        not_run=_NOT_RUN[format_name],
    )


def _link(built: BuiltPlant, body: Any) -> ObservedLink:
    spatial = body.default_spatial_inertia()
    mass = float(spatial.get_mass())
    inertia, com = np.zeros((3, 3)), np.zeros(3)
    if mass:
        com = np.array(spatial.get_com())
        inertia = shift_inertia(spatial.CalcRotationalInertia().CopyToFullMatrix3(), -mass, com)
    visuals = built.plant.GetVisualGeometriesForBody(body)
    collisions = built.plant.GetCollisionGeometriesForBody(body)
    seen, touched = (joined_boxes([bounds_of(built, shape) for shape in shapes]) for shapes in (visuals, collisions))
    named = built.request.format != "mjcf"  # Drake keeps no names of these shapes
    return ObservedLink(
        body.name(),
        mass,
        vector3(com),
        matrix3(inertia),
        visual_bounds=seen,
        collision_bounds=touched,
        has_visuals=bool(visuals),
        has_collisions=bool(collisions),
        visuals=tuple(observed_shape(built, shape, seen=True) for shape in visuals) if named else None,
        collisions=tuple(observed_shape(built, shape, seen=False) for shape in collisions) if named else None,
    )


def _poses(built: BuiltPlant, q: Mapping[str, float]) -> dict[str, Pose]:
    built.place(q)
    X_RW = built.X_WB(built.root).inverse()
    return {body.name(): X_RW @ built.X_WB(body) for body in built.bodies}


def _frames(built: BuiltPlant) -> dict[str, tuple[str, Pose]]:
    frames = (built.plant.GetFrameByName(name) for name in built.frames)
    return {frame.name(): (frame.body().name(), pose(frame.GetFixedPoseInBodyFrame())) for frame in frames}


def _dynamics(built: BuiltPlant, q: Mapping[str, float], rates: Rates) -> Dynamics:
    """Mass matrix, gravity forces and inverse dynamics in the coordinates."""
    from pydrake.multibody.tree import MultibodyForces

    plant, context = built.plant, built.context
    built.place(q)
    E = built.coordinates.velocities.rates(q)
    M: Array = np.array(plant.CalcMassMatrix(context))
    gravity = -np.array(plant.CalcGravityGeneralizedForces(context))
    speeds, accelerations = built.coordinates.velocities.moving(q, rates)
    plant.SetVelocities(context, speeds)
    inverse = np.array(plant.CalcInverseDynamics(context, accelerations, MultibodyForces(plant))) + gravity
    return Dynamics(E.T @ M @ E, E.T @ gravity, E.T @ inverse)


_MEASURED = (".obj", ".vtk", ".gltf")
"""Suffixes of meshes that Drake makes hulls of."""


def bounds_of(built: BuiltPlant, geometry: Any) -> Bounds | None:
    """Bounding box [m] of a shape in its link's frame; of meshes that Drake only displays, from the file."""
    inspector = built.scene.model_inspector()
    X_LG, shape = pose(inspector.GetPoseInFrame(geometry)), inspector.GetShape(geometry)
    file = Path(str(shape.source().path())) if type(shape).__name__ == "Mesh" else None
    if file is not None and file.suffix.lower() not in _MEASURED:
        vertices = vertices_of(file)
        return None if vertices is None else mesh_bounds(np.array(shape.scale3()) * vertices, X_LG)
    key = (geometry,) if file is None else (file, *np.ravel(shape.scale3()).tolist())
    if key not in built.hulls:
        hull = inspector.GetConvexHull(geometry)  # of meshes only; that of a visual is computed on each request
        if hull is None:
            return _primitive_bounds(shape, X_LG)
        built.hulls[key] = np.array([hull.vertex(index) for index in range(hull.num_vertices())])
    return mesh_bounds(built.hulls[key], X_LG)


def observed_shape(built: BuiltPlant, geometry: Any, *, seen: bool) -> ObservedShape:
    """Name of a shape; colours of a visual, friction of a collision."""
    inspector = built.scene.model_inspector()
    given = inspector.GetName(geometry).removeprefix(f"{built.name}::")
    name = given if given in built.names else None
    if not seen:
        return ObservedShape(name, surface=_surface(built, geometry))
    properties = inspector.GetIllustrationProperties(geometry)
    shaded = built.request.format.endswith("sdf")
    return ObservedShape(name, _color(properties, "diffuse"), _color(properties, "ambient") if shaded else None)


def _surface(built: BuiltPlant, geometry: Any) -> Surface | None:
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
    if kind == "Ellipsoid":
        half = np.sqrt(((X_LG.R * np.array([shape.a(), shape.b(), shape.c()])) ** 2).sum(axis=1))
        return vector3(X_LG.p - half), vector3(X_LG.p + half)
    sizes = {name: getattr(shape, name)() for name in ("size", "radius", "length") if hasattr(shape, name)}
    known = primitive(kind.lower(), **sizes)
    if known is None:
        raise EngineCannotRead(f"Drake reports a shape of kind {kind}")
    return primitive_bounds(known, X_LG)


_KINDS = {
    "weld": "fixed",
    "revolute": "revolute",
    "prismatic": "prismatic",
    "screw": "screw",
    "universal": "universal",
    "ball_rpy": "ball",
    "planar": "planar",
}
_NO_LIMIT = 1e15
"""Limits beyond this are SDFormat's value for unlimited, 1e16."""


def _joints(built: BuiltPlant) -> tuple[ObservedJoint, ...]:
    """The joint above each link; a joint of the root to the world means that the base is fixed."""
    drives, springs = _drives(built), _springs(built)
    inside = [joint for joint in built.joints if joint.parent_body().name() != "world"]
    return tuple(_joint(built, joint, drives, springs) for joint in inside)


def _drives(built: BuiltPlant) -> dict[str, float]:
    """Effort limit of every joint that has an actuator."""
    actuators = [built.plant.get_joint_actuator(index) for index in built.plant.GetJointActuatorIndices()]
    return {actuator.joint().name(): float(actuator.effort_limit()) for actuator in actuators}


def _springs(built: BuiltPlant) -> dict[str, tuple[float, float]]:
    """Stiffness and rest position of every joint that has a spring."""
    from pydrake.multibody.tree import ForceElementIndex, PrismaticSpring, RevoluteSpring

    springs = {}
    for index in range(built.plant.num_force_elements()):
        element = built.plant.get_force_element(ForceElementIndex(index))
        if isinstance(element, RevoluteSpring):
            springs[element.joint().name()] = (
                float(element.default_stiffness()),
                float(element.default_nominal_angle()),
            )
        elif isinstance(element, PrismaticSpring):
            springs[element.joint().name()] = (float(element.stiffness()), float(element.nominal_position()))
    return springs


def _joint(
    built: BuiltPlant, joint: Any, drives: dict[str, float], springs: dict[str, tuple[float, float]]
) -> ObservedJoint:
    name, kind = joint.name(), _KINDS.get(joint.type_name(), joint.type_name())
    parent, child = joint.parent_body().name(), joint.child_body().name()
    sdf = built.request.format.endswith("sdf")
    if kind == "fixed" and built.request.format == "mjcf":
        name = ""  # MJCF has no fixed joints: this one is Drake's own
    if kind in ("fixed", "ball", "planar"):
        return ObservedJoint(name, kind, parent, child)
    axis, axis2 = _axes(built, joint, kind)
    lower, upper = float(joint.position_lower_limits()[0]), float(joint.position_upper_limits()[0])
    limit = Limit(lower, upper, float(joint.velocity_upper_limits()[0]), drives.get(name, 0.0))
    limit = limit.without_beyond(_NO_LIMIT)
    damping = joint.default_damping_vector()
    stiffness, reference = springs.get(name, (0.0, 0.0))
    sprung = sdf and kind in ("revolute", "prismatic")
    return ObservedJoint(
        name,
        "continuous" if kind == "revolute" and limit.lower == -inf and limit.upper == inf else kind,
        parent,
        child,
        axis=vector3(axis),
        axis2=None if axis2 is None else vector3(axis2),
        # Drake's pitch is the advance per turn.
        pitch=float(joint.screw_pitch()) / (2.0 * np.pi) if kind == "screw" else None,
        limit=limit,
        limit_fields=_limit_fields(built, kind, name in drives),
        dynamics=JointDynamics(
            float(damping[0]) if len(set(damping.tolist())) == 1 else nan,
            stiffness=stiffness,
            spring_reference=reference,
        ),
        dynamics_fields=("damping", *(("stiffness", "spring_reference") if sprung else ())),
    )


def _limit_fields(built: BuiltPlant, kind: str, driven: bool) -> tuple[str, ...]:
    """Effort limits from actuators, where Drake keeps them: one per joint of SDFormat and per transmission of URDF."""
    if kind == "universal":
        return ("lower", "upper")
    if kind == "screw":  # Drake sets no limit
        return ("effort",)
    sdf = built.request.format.endswith("sdf")
    return ("lower", "upper", "velocity", *(("effort",) if sdf or (driven and built.request.format == "urdf") else ()))


def _axes(built: BuiltPlant, joint: Any, kind: str) -> tuple[Array, Array | None]:
    """Axes in the child's frame; Drake turns about x and y of a universal joint's own frame."""
    R_CM: Array = joint.frame_on_child().GetFixedPoseInBodyFrame().rotation().matrix()
    if kind == "universal":
        return R_CM[:, 0], R_CM[:, 1]
    if kind == "screw":  # its axis is not reported: it is the direction that a rotation leaves unchanged
        built.place({joint.name(): 1.0})
        X_FM = built.plant.CalcRelativeTransform(built.context, joint.frame_on_parent(), joint.frame_on_child())
        R_FM: Array = X_FM.rotation().matrix()
        return R_CM @ (np.array([R_FM[2, 1], R_FM[0, 2], R_FM[1, 0]]) - [R_FM[1, 2], R_FM[2, 0], R_FM[0, 1]]), None
    axis = axis_of(joint)
    return np.full(3, nan) if axis is None else R_CM @ axis, None
