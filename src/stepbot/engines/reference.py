"""The reference: stepbot's own model as an Observation, in the same form as an engine's."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from stepbot.geometry.spatial import Pose, join_bounds
from stepbot.robot.actuators import control_range, force_range
from stepbot.robot.bounding_boxes import Bounds, mesh_bounds, primitive_bounds
from stepbot.robot.closures import closure_gap
from stepbot.robot.dynamics import equations_of_motion
from stepbot.robot.kinematics import TURNING, Tree, initial_configuration, link_poses, without_contacts
from stepbot.robot.loop_sensitivity import loop_sensitivity
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Collision,
    Joint,
    JointKind,
    Link,
    LoopClosure,
    MeshRef,
    Robot,
    Visual,
)
from stepbot.robot.sensors import PLACED, SEEING, Sensor, SensorKind
from stepbot.version import __version__

from .observation import (
    Dynamics,
    Observation,
    ObservedActuator,
    ObservedClosure,
    ObservedJoint,
    ObservedLink,
    ObservedSensor,
    ObservedShape,
    Request,
)

NAME = "model"

_WITHOUT_AXIS = (JointKind.FIXED, JointKind.BALL, JointKind.FLOATING)


def observe_robot(robot: Robot, request: Request) -> Observation:
    """Everything that an engine should report for a file of this robot.

    Raises:
        KeyError: A configuration names a joint that does not exist.
    """
    tree = Tree(robot)
    closed = [q for way in request.ways for q in way]
    poses = tuple(link_poses(robot, q, tree) for q in [*request.configurations, *closed])
    sensitivity = loop_sensitivity(robot, closed, request.driven)
    equations = [equations_of_motion(robot, q, rates, tree=tree) for q, rates in request.moments]
    return Observation(
        engine=NAME,
        version=__version__,
        format=request.format,
        name=robot.name,
        base=robot.base.value,
        links=tuple(_link(robot, link, shaded=request.format.endswith("sdf")) for link in robot.links),
        joints=tuple(_joint(joint) for joint in robot.joints),
        gravity=(),
        coordinates=tree.joints,
        poses=poses,
        dynamics=tuple(Dynamics(one.mass_matrix, one.gravity, one.inverse) for one in equations),
        closures=tuple(
            replace(_closure(closure, poses[len(request.configurations) :]), sensitivity=sensitivity)
            for closure in robot.closures
        ),
        frames={frame.name: (frame.link, frame.X_LF) for frame in robot.frames},
        actuators=tuple(_actuator(robot, actuator) for actuator in robot.actuators),
        sensors=tuple(_sensor(sensor) for sensor in robot.sensors),
        initial=initial_configuration(robot),
        excluded_pairs=_excluded_pairs(robot),
    )


def _link(robot: Robot, link: Link, *, shaded: bool) -> ObservedLink:
    body = link.mass_properties
    return ObservedLink(
        link.name,
        body.mass,
        body.com,
        body.inertia,
        _bounds(robot, link.visuals),
        _bounds(robot, link.collisions),
        gravity_compensation=0.0,
        has_visuals=bool(link.visuals),
        has_collisions=bool(link.collisions),
        visuals=tuple(
            ObservedShape(shape.name, shape.rgba, shape.rgba if shaded else None, _bounds(robot, (shape,)), 2)
            for shape in link.visuals
        ),
        collisions=tuple(
            ObservedShape(shape.name, bounds=_bounds(robot, (shape,)), group=3) for shape in link.collisions
        ),
    )


def _excluded_pairs(robot: Robot) -> tuple[tuple[str, str], ...]:
    touching = {link.name for link in robot.links if link.collisions}
    return tuple(sorted((min(pair), max(pair)) for pair in without_contacts(robot) if pair <= touching))


def _bounds(robot: Robot, shapes: Iterable[Visual | Collision]) -> Bounds | None:
    boxes = []
    for shape in shapes:
        if isinstance(shape.geometry, MeshRef):
            boxes.append(mesh_bounds(robot.mesh_by_name[shape.geometry.name].mesh.vertices, shape.X_LG))
        else:
            boxes.append(primitive_bounds(shape.geometry, shape.X_LG))
    return join_bounds(boxes) if boxes else None


def _joint(joint: Joint) -> ObservedJoint:
    fixed = joint.kind is JointKind.FIXED
    axis = None if joint.kind in _WITHOUT_AXIS else joint.axis
    return ObservedJoint(
        joint.name,
        joint.kind.value,
        joint.parent,
        joint.child,
        axis=axis,
        axis2=joint.axis2 if joint.kind is JointKind.UNIVERSAL else None,
        pitch=joint.pitch if joint.kind is JointKind.SCREW else None,
        limit=None if fixed else joint.limit,
        dynamics=None if fixed else joint.dynamics,
        dynamics_fields=("damping", "friction", "stiffness", "spring_reference", "armature"),
        mimic=joint.mimic,
        mimic_read=True,
    )


def _closure(closure: LoopClosure, poses: Sequence[Mapping[str, Pose]]) -> ObservedClosure:
    """The closure, and its gap in the closed poses, caused by the CAD's own inaccuracy."""
    gaps = [closure_gap(closure, X_W[closure.link_a], X_W[closure.link_b])[0] for X_W in poses]
    held = ObservedClosure.of_frames(
        closure.name,
        closure.kind.value,
        (closure.link_a, closure.link_b),
        (closure.X_AF, closure.X_BF),
        closure.axis if closure.kind in TURNING else None,
    )
    return replace(held, axis=closure.axis, residual=max(gaps, default=0.0), angle_error=0.0)


def _actuator(robot: Robot, actuator: Actuator) -> ObservedActuator:
    joint = robot.joint_by_name[actuator.joint]
    motor = actuator.kind is ActuatorKind.MOTOR
    return ObservedActuator(
        actuator.name,
        actuator.joint,
        actuator.kind.value,
        0.0 if actuator.kind is not ActuatorKind.POSITION else actuator.kp,
        0.0 if motor else actuator.kv,
        actuator.gear,
        control_range(actuator, joint),
        None if motor else force_range(actuator, joint),  # a motor's input is its force
    )


def _sensor(sensor: Sensor) -> ObservedSensor:
    seen = ObservedSensor(
        sensor.name,
        sensor.kind.value,
        sensor.link if sensor.kind is not SensorKind.JOINT else None,
        sensor.joint or None,
        sensor.X_LS if sensor.kind in PLACED else None,
        sensor.rate,
    )
    view = sensor.view
    if sensor.kind not in SEEING:
        return seen
    return replace(
        seen, fov=view.fov, columns=view.columns, rows=view.rows, nearest=view.nearest, farthest=view.farthest
    )
