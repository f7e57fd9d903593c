"""SDFormat read back by stepbot's own parser, because no engine of the core install reads all of it.

It is written from the specification (http://sdformat.org/spec) and independent of the writer. It reports inertias,
limits, closing joints, frames and mimics, which PyBullet ignores; poses and dynamics are computed by stepbot's
kinematics from the parsed values, so they confirm the text, not the behaviour of an engine.
"""

from collections.abc import Iterable, Iterator, Sequence
from math import inf, isfinite, nan, pi
from pathlib import Path

import numpy as np
from msgspec.structs import replace

from stepbot.engines.observation import ObservedActuator, ObservedSensor
from stepbot.geometry.primitives import Primitive, primitive
from stepbot.geometry.spatial import ZERO3, Pose, matrix3, turn_inertia, unit, vector3
from stepbot.robot.bounding_boxes import Bounds, primitive_bounds
from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.model import ActuatorKind, JointDynamics, JointKind, Limit, Mimic
from stepbot.robot.sensors import SensorKind
from stepbot.robot.surfaces import Surface
from stepbot.version import __version__

from ..observation import (
    OBLIQUE,
    EngineRefused,
    Observation,
    ObservedClosure,
    ObservedJoint,
    ObservedLink,
    ObservedShape,
    Quantity,
    Request,
)
from ..parsed_motion import NOTE, with_motion
from ..resources import mesh_file_bounds, with_shapes
from ..xml import Element
from . import ENGINE
from .frames import MODEL, WORLD, Frames, bool_at, ends, number_at, numbers, read_pose, three_at
from .sensors import model_sensors
from .tree import closing_joints, joints_to_world, read_model, repeated_names

NO_LIMIT = 1e15
"""Limits beyond this are the format's value for unlimited, 1e16."""


def prepare() -> None:
    """Nothing to import."""
    import lxml.etree  # noqa: F401


def observe(request: Request) -> Observation:
    """Parse the file and report its content.

    Raises:
        EngineRefused: The file contradicts the specification.
        EngineCannotRead: It uses features that this reader does not support: <include>, several trees.
    """
    model = read_model(Path(request.file))
    frames = Frames(model)
    to_world = joints_to_world(model)
    joints = [joint for joint in model.findall("joint") if joint not in to_world]
    closing = closing_joints(joints)
    tree = [joint for joint in joints if joint not in closing]
    links, missing = [], []
    for link in model.findall("link"):
        observed, lost = _link(link, Path(request.file))
        links.append(observed)
        missing += lost
    observation = Observation(
        engine=ENGINE.name,
        version=__version__,
        format=request.format,
        base="fixed" if to_world or _is_held(model) else "floating",
        links=tuple(links),
        joints=tuple(_joint(joint, frames) for joint in tree),
        gravity=_gravity(model),
        closures=tuple(_closure(joint, frames) for joint in closing),
        frames={
            name: _frame(frame, frames)
            for frame in model.findall("frame")
            if not (name := frame.get("name", "")).endswith(MODEL)
        },
        actuators=tuple(plugin_actuators(model)),
        sensors=(*model_sensors(model, frames), *plugin_sensors(model)),
        missing_meshes=tuple(missing),
        not_run={Quantity.SIMULATION: "a parser cannot simulate"},
        warnings=tuple(repeated_names(model)),
        notes=(NOTE,),
    )
    return with_motion(
        observation,
        _joint_frames(observation, tree, frames),
        # The root link's pose in the world is its pose in the model.
        lambda root: vector3(frames.X_M(root).inverse().turn(GRAVITY)),
        request,
    )


def _is_held(model: Element) -> bool:
    """Whether a model without a joint to the world is fixed to it: static, or with a link that is the world."""
    return bool_at(model, "static", False) or any(link.get("name") == WORLD for link in model.findall("link"))


def _link(link: Element, file: Path) -> tuple[ObservedLink, list[str]]:
    inertial = link.find("inertial")
    X_LI = read_pose(inertial)
    mass = number_at(inertial, "mass", 1.0)  # the specification's default
    inertia = np.array([[_inertia(inertial, i, j) for j in "xyz"] for i in "xyz"])
    visuals, lost = shapes_of(link.findall("visual"), file)
    collisions, lost_too = shapes_of(link.findall("collision"), file)
    observed = ObservedLink(
        link.get("name", ""),
        mass,
        X_LI.position,
        matrix3(turn_inertia(X_LI.R, inertia)),
        gravity_compensation=0.0 if bool_at(link, "gravity", True) else 1.0,
    )
    return with_shapes(observed, visuals, collisions), lost + lost_too


def _gravity(model: Element) -> tuple[float, ...]:
    """Acceleration of gravity [m/s^2] in the world around a model; empty where there is no world, or it gives none.

    Raises:
        EngineRefused: It does not have three components.
    """
    world = model.getparent()
    text = None if world is None else world.findtext("gravity")
    gravity = numbers(text)
    if text is not None and len(gravity) != 3:
        raise EngineRefused(f"<gravity> has {len(gravity)} numbers, 3 expected")
    return tuple(gravity)


def _inertia(inertial: Element | None, i: str, j: str) -> float:
    tag = f"inertia/i{min(i, j)}{max(i, j)}"
    return number_at(inertial, tag, 1.0 if i == j else 0.0)


def _kind(joint: Element) -> str:
    """Its type; ``revolute2`` and ``universal`` are both two hinges at one point."""
    kind = joint.get("type", "")
    return "universal" if kind == "revolute2" else kind


_DECIMALS = 12
"""Digits [m] of a joint's position in its link: the product of its poses has rounding errors."""


def _joint(joint: Element, frames: Frames) -> ObservedJoint:
    parent, child = (frames.link_of(name) for name in ends(joint))
    name, axis, second = joint.get("name", ""), joint.find("axis"), joint.find("axis2")
    anchor = vector3(np.round((frames.X_M(child).inverse() @ frames.X_M(name)).p, _DECIMALS) + 0.0)
    if axis is None:
        return ObservedJoint(name, _kind(joint), parent, child, anchor=anchor, mimic_read=True)
    a_C = frames.X_M(child).inverse().turn(unit(frames.axis(joint, axis)))
    b_C = None if second is None else vector3(frames.X_M(child).inverse().turn(unit(frames.axis(joint, second))))
    limit, dynamics = _limit(axis), _dynamics(axis)
    if joint.get("type") == "continuous":  # such joints ignore them
        limit = replace(limit, lower=-inf, upper=inf)
    of_second = (limit, dynamics) if second is None else (_limit(second), _dynamics(second))
    of_both = (limit, dynamics), of_second
    if of_second[0] != limit:
        limit = Limit(nan, nan, nan, nan)  # no joint of the model has two
    observed = ObservedJoint(
        name,
        _kind(joint),
        parent,
        child,
        axis=vector3(a_C),
        axis2=b_C,
        anchor=anchor,
        pitch=number_at(joint, "screw_thread_pitch", 0.0) / (2.0 * pi) if _kind(joint) == "screw" else None,
        limit=limit,
        dynamics=dynamics,
        dynamics_fields=("damping", "friction", "stiffness", "spring_reference"),
        mimic=_mimic(axis),
        mimic_read=True,
    )
    return replace(observed, steps=_steps(observed, of_both)) if _kind(joint) == JointKind.UNIVERSAL else observed


def _steps(joint: ObservedJoint, of_both: Sequence[tuple[Limit, JointDynamics]]) -> tuple[ObservedJoint, ...]:
    """The hinges of a universal joint with limits, or with other forces about its second axis; else none.

    The universal joint of the model has no limits, and the same forces about both axes.
    """
    first, second = of_both
    if first == second and not (isfinite(first[0].lower) or isfinite(first[0].upper)):
        return ()
    return tuple(
        replace(
            joint,
            name=f"{joint.name}{suffix}",
            kind="revolute" if isfinite(limit.lower) or isfinite(limit.upper) else "continuous",
            axis=axis,
            axis2=None,
            limit=limit,
            dynamics=dynamics,
            mimic=None,
        )
        for suffix, axis, (limit, dynamics) in zip(
            JointKind.UNIVERSAL.chain, (joint.axis, joint.axis2), of_both, strict=True
        )
    )


def _dynamics(axis: Element) -> JointDynamics:
    return JointDynamics(
        damping=number_at(axis, "dynamics/damping", 0.0),
        friction=number_at(axis, "dynamics/friction", 0.0),
        stiffness=number_at(axis, "dynamics/spring_stiffness", 0.0),
        spring_reference=number_at(axis, "dynamics/spring_reference", 0.0),
    )


def _limit(axis: Element) -> Limit:
    lower, upper = number_at(axis, "limit/lower", -inf), number_at(axis, "limit/upper", inf)
    velocity, effort = (number_at(axis, f"limit/{name}", inf) for name in ("velocity", "effort"))
    limit = Limit(lower, upper, inf if velocity < 0.0 else velocity, inf if effort < 0.0 else effort)
    return limit.without_beyond(NO_LIMIT)


def _mimic(axis: Element) -> Mimic | None:
    """The format relates follower = multiplier * (leader - reference) + offset."""
    mimic = axis.find("mimic")
    if mimic is None:
        return None
    multiplier = number_at(mimic, "multiplier", 1.0)
    offset = number_at(mimic, "offset", 0.0) - multiplier * number_at(mimic, "reference", 0.0)
    return Mimic(mimic.get("joint", ""), multiplier, offset)


def _closure(joint: Element, frames: Frames) -> ObservedClosure:
    """A closing joint; its frame is given in the child, and its frame in the parent is the same at q = 0."""
    parent, child = (frames.link_of(name) for name in ends(joint))
    has_axis = joint.get("type") not in ("fixed", "ball")
    X_MF, axis = frames.X_M(joint.get("name", "")), joint.find("axis") if has_axis else None
    return ObservedClosure.of_frames(
        joint.get("name", ""),
        _kind(joint),
        (parent, child),
        (frames.X_M(parent).inverse() @ X_MF, frames.X_M(child).inverse() @ X_MF),
        None if axis is None else vector3(X_MF.inverse().turn(unit(frames.axis(joint, axis)))),
    )


def _frame(frame: Element, frames: Frames) -> tuple[str, Pose]:
    link = frames.link_of(frame.get("name", ""))
    return link, frames.X_M(link).inverse() @ frames.X_M(frame.get("name", ""))


def _joint_frames(observation: Observation, tree: list[Element], frames: Frames) -> dict[str, tuple[Pose, Pose]]:
    """For each link with a parent, the pose of the joint above it in its parent, and in itself."""
    poses: dict[str, tuple[Pose, Pose]] = {}
    for observed, joint in zip(observation.joints, tree, strict=True):
        X_MJ = frames.X_M(joint.get("name", ""))
        parent, child = (frames.X_M(link).inverse() @ X_MJ for link in (observed.parent, observed.child))
        poses[observed.child] = parent, child
    return poses


_SYSTEMS = "gz::sim::systems::"


def plugin_actuators(model: Element) -> Iterator[ObservedActuator]:
    """The actuators, which have no names here; gains and bounds are those at the joint."""
    for plugin in model.findall("plugin"):
        joint = (plugin.findtext("joint_name") or "").strip()
        match _system(plugin):
            case "JointPositionController":
                yield _controlled(plugin, joint, ActuatorKind.POSITION, default_i=0.1, default_d=0.01)
            case "JointController":
                yield _controlled(plugin, joint, ActuatorKind.VELOCITY, default_i=0.0, default_d=0.0)
            case "ApplyJointForce":
                yield ObservedActuator("", joint, ActuatorKind.MOTOR.value, gear=None)


def plugin_sensors(model: Element) -> Iterator[ObservedSensor]:
    """Publishers of joint states: of the listed joints, or of all."""
    for plugin in model.findall("plugin"):
        if _system(plugin) == "JointStatePublisher":
            named = [(element.text or "").strip() for element in plugin.findall("joint_name")]
            moving = [joint.get("name", "") for joint in model.findall("joint") if joint.get("type") != "fixed"]
            for joint in named or moving:
                yield ObservedSensor("", SensorKind.JOINT.value, joint=joint)


def _system(plugin: Element) -> str:
    """The class of a plugin, if it comes from its own library: ``gz-sim-<class-in-lower-case>-system``."""
    name = plugin.get("name", "").removeprefix(_SYSTEMS)
    library = "".join(f"-{letter.lower()}" if letter.isupper() else letter for letter in name)
    return name if plugin.get("filename") == f"gz-sim{library}-system" else ""


def _controlled(
    plugin: Element, joint: str, kind: ActuatorKind, *, default_i: float, default_d: float
) -> ObservedActuator:
    """An actuator with a PID controller; one with further features is reported as another kind."""
    p, i, d = (
        number_at(plugin, f"{letter}_gain", default)
        for letter, default in (("p", 1.0), ("i", default_i), ("d", default_d))
    )
    high, low = number_at(plugin, "cmd_max", 1000.0), number_at(plugin, "cmd_min", -1000.0)
    word = kind.value
    if kind is ActuatorKind.VELOCITY and plugin.findtext("use_force_commands", "").strip() not in ("true", "1"):
        word = "velocity without a force limit"
    if i or (d and kind is ActuatorKind.VELOCITY) or plugin.findtext("use_velocity_commands", "").strip() == "true":
        word = f"{word}, controlled otherwise"
    gains = (p, d) if kind is ActuatorKind.POSITION else (0.0, p)
    return ObservedActuator("", joint, word, *gains, gear=None, force=(low, high))


def shapes_of(shapes: Iterable[Element], file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    """All shapes in the link's frame, and the missing mesh files.

    A shape has no box if this reader cannot determine its extent.
    """
    seen: list[ObservedShape] = []
    missing: list[str] = []
    for shape in shapes:
        geometry, X_LG = shape.find("geometry"), read_pose(shape)
        bounds, lost = _bounds(geometry, X_LG, file)
        oblique, _ = _bounds(geometry, OBLIQUE @ X_LG, file)
        missing += lost
        rgba, ambient = (_color(shape, name) if shape.tag == "visual" else None for name in ("diffuse", "ambient"))
        surface = surface_of(shape) if shape.tag == "collision" else None
        seen.append(ObservedShape(shape.get("name", ""), rgba, ambient, bounds, oblique, surface=surface))
    return tuple(seen), missing


def surface_of(shape: Element) -> Surface:
    """Friction and restitution of a collision, if they are given."""
    paths = {"friction": "surface/friction/ode/mu", "restitution": "surface/bounce/restitution_coefficient"}
    given = {name: path for name, path in paths.items() if shape.find(path) is not None}
    return Surface(**{name: number_at(shape, path, 0.0) for name, path in given.items()})


def _color(shape: Element, name: str) -> tuple[float, ...]:
    """Red, green, blue and opacity; empty if the file gives none."""
    values = numbers(shape.findtext(f"material/{name}"))
    return tuple(values if len(values) != 3 else (*values, 1.0))


def _bounds(geometry: Element | None, X_LG: Pose, file: Path) -> tuple[Bounds | None, list[str]]:
    """The bounding box of a shape, if known, and its mesh file if missing."""
    mesh = None if geometry is None else geometry.find("mesh")
    if geometry is None:
        return None, []
    if mesh is None:
        shape = primitive_of(geometry)
        return (None if shape is None else primitive_bounds(shape, X_LG)), []
    uri, scale = (mesh.findtext("uri") or "").strip(), three_at(mesh, "scale", "1 1 1")
    return mesh_file_bounds(uri, file, X_LG, scale)


def primitive_of(geometry: Element) -> Primitive | None:
    """The primitive in a `<geometry>`; None for a mesh, and for shapes that the model does not have."""
    for shape in geometry:
        size = three_at(shape, "size", "0 0 0") if shape.tag == "box" else ZERO3
        radius, length = number_at(shape, "radius", 0.0), number_at(shape, "length", 0.0)
        if made := primitive(str(shape.tag), size=size, radius=radius, length=length):
            return made
    return None
