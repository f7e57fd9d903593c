"""A PROTO of Webots as an observation, by the reference of its nodes and independent of the writer.

Poses and dynamics are computed by stepbot's kinematics from the joints, so they confirm the file, not the behaviour of
Webots. https://cyberbotics.com/doc/reference/nodes-and-functions
"""

from collections.abc import Iterator
from math import inf
from pathlib import Path

import numpy as np
from msgspec.structs import replace

from stepbot.engines.observation import ObservedShape
from stepbot.engines.resources import mesh_file_bounds
from stepbot.geometry.spatial import Pose, matrix3, rotation_about, unit, vector3
from stepbot.robot.bounding_boxes import Bounds, primitive_bounds
from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.model import Box, Capsule, Cylinder, JointDynamics, JointKind, Limit, Sphere
from stepbot.runtime.file import read_regular
from stepbot.version import __version__

from ..observation import (
    EngineCannotRead,
    EngineRefused,
    Observation,
    ObservedJoint,
    ObservedLink,
    ObservedSensor,
    Quantity,
    Request,
)
from ..parsed_motion import NOTE, with_motion
from ..resources import box_around
from . import ENGINE
from .vrml import Node, read_proto

NO_LIMIT = 1e9
"""Limits of this size stand for none."""
_KINDS = {"HingeJoint": "revolute", "SliderJoint": "prismatic", "BallJoint": "ball"}
_SENSORS = {"InertialUnit": "imu", "Camera": "camera", "Lidar": "lidar"}
_SUFFIX = "_sensor"
_NOT_RUN = {
    Quantity.SIMULATION: "a parser cannot simulate",
    Quantity.MIMIC: "coupled motors follow commands, not positions",
    Quantity.CLOSURES: "closures have no names in Webots",
    Quantity.ACTUATORS: "motors of Webots have no kind and no gains",
    Quantity.WARNINGS: "a parser has none",
    Quantity.CONTACTS: "the links of a robot do not collide in Webots",
}


def prepare() -> None:
    """Nothing to import."""


def observe(request: Request) -> Observation:
    """Parse the file and report its content.

    Raises:
        EngineRefused: The file is not VRML, or contradicts the reference.
        EngineCannotRead: It declares no robot.
    """
    file = Path(request.file)
    _, top = read_proto(_text(file))
    if top.type != "Robot":
        raise EngineCannotRead(f"the PROTO is a {top.type}, not a Robot")
    fixed = top.node("physics") is None
    root = _held(top) if fixed else top
    seen = _Tree(file)
    seen.add(root, root.text("name" if fixed else "model"))
    observation = Observation(
        engine=ENGINE.name,
        version=__version__,
        format=request.format,
        name=top.text("name"),
        base="fixed" if fixed else "floating",
        links=tuple(seen.links),
        joints=tuple(seen.joints),
        frames=seen.frames,
        sensors=tuple(seen.sensors),
        initial=seen.initial,
        missing_meshes=tuple(seen.missing),
        not_run=_NOT_RUN,
        notes=(NOTE,),
    )
    frames = {child: (X_PC, Pose()) for child, X_PC in seen.X_PC.items()}
    return with_motion(observation, frames, lambda _root: vector3(GRAVITY), request)


def _text(file: Path) -> str:
    try:
        return read_regular(file).decode("utf-8")
    except UnicodeDecodeError as error:
        raise EngineRefused(f"not UTF-8: byte {error.start} of the file") from error


def _held(robot: Node) -> Node:
    """The solid that Webots attaches to the world: the only child of a robot without physics.

    Raises:
        EngineCannotRead: There is none, or there are several.
    """
    solids = [node for node in robot.nodes("children") if node.type == "Solid"]
    if len(solids) != 1:
        raise EngineCannotRead(f"{len(solids)} solids in a robot without physics, one expected")
    return solids[0]


class _Tree:
    """What is found below the root."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.links: list[ObservedLink] = []
        self.joints: list[ObservedJoint] = []
        self.sensors: list[ObservedSensor] = []
        self.frames: dict[str, tuple[str, Pose]] = {}
        self.initial: dict[str, float] = {}
        self.missing: list[str] = []
        self.names: set[str] = set()
        self.X_PC: dict[str, Pose] = {}

    def add(self, solid: Node, name: str) -> None:
        """Add a solid and all below it.

        Raises:
            EngineCannotRead: Two solids have one name, or a solid is below a node of another type than those read.
        """
        if name in self.names:
            raise EngineCannotRead(f"duplicate solid '{name}'")
        self.names.add(name)
        self.links.append(self._link(solid, name))
        for child in solid.nodes("children"):
            if child.type in _KINDS:
                self._joint(child, name)
            elif child.type == "Solid" and child.node("physics") is None:
                self.frames[child.text("name")] = (name, child.pose())
            elif child.type == "Solid":
                below = child.text("name")
                self.X_PC[below] = child.pose()
                self.joints.append(ObservedJoint("", "fixed", name, below))
                self.add(child, below)
            elif child.type in _SENSORS:
                self.sensors.append(_sensor(child, name))
            elif child.type.endswith("Joint") or any(
                node.type in (*_KINDS, "Solid") for node in child.nodes("children")
            ):
                raise EngineCannotRead(f"solids below a {child.type} are not supported")

    def _link(self, solid: Node, name: str) -> ObservedLink:
        physics = solid.node("physics")
        if physics is None or physics.number("density", 1000.0) != -1.0:
            raise EngineCannotRead(f"solid '{name}' has no mass of its own")
        xx, yy, zz, xy, xz, yz = physics.numbers("inertiaMatrix", (0.0,) * 6)
        visuals, lost = visuals_of(solid, self.file)
        collisions, lost_too = collisions_of(solid, self.file)
        self.missing += [*lost, *lost_too]
        return ObservedLink(
            name,
            physics.number("mass", -1.0),
            vector3(physics.numbers("centerOfMass", (0.0, 0.0, 0.0))),
            matrix3(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])),
            box_around(visuals),
            box_around(collisions),
            has_visuals=bool(visuals),
            has_collisions=bool(collisions),
            gravity_compensation=0.0,
        )

    def _joint(self, node: Node, parent: str) -> None:
        end, parameters = node.node("endPoint"), node.node("jointParameters") or Node("JointParameters")
        if end is None or end.type == "SolidReference":
            return
        child, kind = end.text("name"), _KINDS[node.type]
        devices = node.nodes("device")
        X_PC, q = end.pose(), parameters.number("position", 0.0)
        name = next((device.text("name") for device in devices if device.type == "PositionSensor"), "").removesuffix(
            _SUFFIX
        )
        seen = ObservedJoint(name, kind, parent, child)
        if kind != JointKind.BALL:
            given = parameters.numbers("axis", (1.0, 0.0, 0.0) if kind == JointKind.REVOLUTE else (0.0, 0.0, 1.0))
            if not any(given):
                raise EngineRefused(f"the axis of the joint above '{child}' is zero")
            axis = unit(given)
            if kind == JointKind.REVOLUTE:
                anchor = np.array(parameters.numbers("anchor", (0.0, 0.0, 0.0)))
                turn = rotation_about(axis, -q)
                X_PC = Pose.of(turn, anchor - turn @ anchor) @ X_PC
            else:
                X_PC = Pose.of(position=-q * axis) @ X_PC
            self.initial[name] = q
            damping, friction = parameters.number("dampingConstant", 0.0), parameters.number("staticFriction", 0.0)
            seen = replace(
                seen,
                axis=vector3(X_PC.inverse().turn(axis)),
                limit=_limit(parameters, devices),
                limit_fields=("lower", "upper", "velocity"),  # the effort is that of the actuator
                dynamics=JointDynamics(damping=damping, friction=friction),
            )
        if kind in (JointKind.REVOLUTE, JointKind.BALL):
            place = parameters.numbers("anchor", (0.0, 0.0, 0.0))
            seen = replace(seen, anchor=vector3(np.round(X_PC.inverse().apply(place), 12) + 0.0))
        self.X_PC[child] = X_PC
        self.joints.append(seen)
        self.add(end, child)


def _limit(parameters: Node, devices: list[Node]) -> Limit:
    """The limits of a joint: its stops, or else those of its motor."""
    motor = next((device for device in devices if device.type.endswith("Motor")), Node("none"))
    bounds = [(parameters, "minStop", "maxStop"), (motor, "minPosition", "maxPosition")]
    pairs = [(node.number(low, 0.0), node.number(high, 0.0)) for node, low, high in bounds]
    lower, upper = next((pair for pair in pairs if any(pair)), (-inf, inf))
    effort = motor.number("maxForce" if motor.type == "LinearMotor" else "maxTorque", inf)
    velocity = motor.number("maxVelocity", inf)
    return Limit(lower, upper, velocity, effort).without_beyond(NO_LIMIT, NO_LIMIT)


def _sensor(node: Node, link: str) -> ObservedSensor:
    seen = ObservedSensor(node.text("name"), _SENSORS[node.type], link, X_LS=node.pose(), rate=0.0)
    if node.type == "InertialUnit":
        return seen
    camera = node.type == "Camera"
    near, far = ("near", "far") if camera else ("minRange", "maxRange")
    columns = node.number("width" if camera else "horizontalResolution", 64.0)
    rows = node.number("height" if camera else "numberOfLayers", 64.0 if camera else 4.0)
    return replace(
        seen,
        fov=node.number("fieldOfView", 0.7854),
        columns=int(columns),
        rows=int(rows),
        nearest=node.number(near, 0.01),
        farthest=node.number(far, 0.0),
    )


_GROUPS = ("Pose", "Transform", "Group")


def visuals_of(solid: Node, file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    """The shapes of a solid that are seen, in its frame, and the missing mesh files."""
    return _observed([shape for child in solid.nodes("children") for shape in _shapes(child, Pose())], file)


def collisions_of(solid: Node, file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    """The shapes of a solid's bounding object, in its frame, and the missing mesh files."""
    bounding = solid.node("boundingObject")
    return _observed([] if bounding is None else list(_shapes(bounding, Pose(), geometries=True)), file)


def _shapes(node: Node, X: Pose, *, geometries: bool = False) -> Iterator[tuple[Node, Node | None, Pose]]:
    """Geometry, appearance and pose of the shapes in a node; solids and joints have shapes of their own."""
    if node.type in _GROUPS:
        for child in node.nodes("children"):
            yield from _shapes(child, X @ node.pose(), geometries=geometries)
    elif node.type == "Shape":
        geometry = node.node("geometry")
        if geometry is not None:
            yield geometry, node.node("appearance"), X
    elif geometries:
        yield node, None, X


def _observed(placed: list[tuple[Node, Node | None, Pose]], file: Path) -> tuple[tuple[ObservedShape, ...], list[str]]:
    seen, missing = list[ObservedShape](), list[str]()
    for geometry, appearance, X in placed:
        bounds, lost = _bounds(geometry, X, file)
        missing += lost
        seen.append(ObservedShape("", _color(appearance), bounds=bounds))
    return tuple(seen), missing


def _color(appearance: Node | None) -> tuple[float, ...] | None:
    if appearance is None:
        return None
    return (*appearance.numbers("baseColor", (1.0, 1.0, 1.0)), 1.0 - appearance.number("transparency", 0.0))


def _bounds(geometry: Node, X: Pose, file: Path) -> tuple[Bounds | None, list[str]]:
    """The bounding box of a shape, if known, and its mesh file if missing."""
    match geometry.type:
        case "Box":
            x, y, z = geometry.numbers("size", (0.1, 0.1, 0.1))
            return primitive_bounds(Box((x, y, z)), X), []
        case "Sphere":
            return primitive_bounds(Sphere(geometry.number("radius", 0.1)), X), []
        case "Cylinder" | "Capsule":
            kind = Cylinder if geometry.type == "Cylinder" else Capsule
            return primitive_bounds(kind(geometry.number("radius", 0.1), geometry.number("height", 0.2)), X), []
        case "Mesh":
            return mesh_file_bounds(_url(geometry), file, X)
        case _:
            return None, []


def _url(mesh: Node) -> str:
    """The file of a mesh; of several the first."""
    urls = mesh.fields.get("url", [])
    return next((str(url).strip('"') for url in (urls if isinstance(urls, list) else [urls])), "")
