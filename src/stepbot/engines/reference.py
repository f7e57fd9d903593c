"""The reference: stepbot's own model as an Observation, in the same form as an engine's."""

from collections.abc import Mapping, Sequence
from typing import Any

from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.bounding_boxes import Bounds, mesh_bounds, primitive_bounds
from stepbot.robot.closures import closure_gap
from stepbot.robot.dynamics import Equations, equations_at
from stepbot.robot.gains import control_range, force_range
from stepbot.robot.kinematics import Tree, initial_configuration, link_poses_at, without_contacts
from stepbot.robot.loop_followers import loop_sensitivity
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Collision,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    LoopClosure,
    MeshRef,
    Robot,
    Visual,
)
from stepbot.robot.sensors import PLACED, SEEING, Sensor, SensorKind
from stepbot.version import __version__

from .observation import (
    OBLIQUE,
    Dynamics,
    Observation,
    ObservedActuator,
    ObservedClosure,
    ObservedJoint,
    ObservedLink,
    ObservedSensor,
    ObservedShape,
    Request,
    sorted_pairs,
)
from .resources import with_shapes

NAME = "model"


def observe_robot(robot: Robot, request: Request, *, dynamics: bool = True) -> Observation:
    """Everything that an engine should report for a file of this robot.

    Args:
        dynamics: Whether to compute the equations of motion, whose cost grows with the cube of the number of joints.

    Raises:
        KeyError: A configuration names a joint that does not exist.
    """
    return Reference().observe(robot, request, dynamics=dynamics)


class _Motion(Struct, frozen=True, eq=False):
    """Poses and equations of motion of a mechanism."""

    inputs: tuple[Any, ...]
    """Everything that they depend on."""
    coordinates: tuple[str, ...]
    poses: tuple[Mapping[str, Pose], ...]
    equations: tuple[Equations, ...]


class Reference:
    """The reference for several files of one robot: poses and boxes that two formats share are computed once."""

    def __init__(self) -> None:
        self._motions: list[_Motion] = []
        self._boxes: dict[tuple[Any, Pose], Bounds] = {}

    def observe(self, robot: Robot, request: Request, *, dynamics: bool = True) -> Observation:
        """See :func:`observe_robot`."""
        closed = request.closed
        motion = self._motion(robot, request, closed, request.moments if dynamics else ())
        sensitivity = loop_sensitivity(robot, closed, request.driven)
        closed_poses = motion.poses[len(request.configurations) :]
        touching = {link.name for link in robot.links if link.collisions}
        return Observation(
            engine=NAME,
            version=__version__,
            format=request.format,
            name=robot.name,
            base=robot.base.value,
            links=tuple(self._link(robot, link, shaded=request.format.endswith("sdf")) for link in robot.links),
            joints=tuple(_joint(joint) for joint in robot.joints),
            gravity=(),
            coordinates=motion.coordinates,
            poses=motion.poses,
            dynamics=tuple(
                Dynamics(equation.mass_matrix, equation.gravity, equation.inverse) for equation in motion.equations
            ),
            closures=tuple(
                replace(_closure(closure, closed_poses), sensitivity=sensitivity) for closure in robot.closures
            ),
            frames={frame.name: (frame.link, frame.X_LF) for frame in robot.frames},
            actuators=tuple(_actuator(robot, actuator) for actuator in robot.actuators),
            sensors=tuple(_sensor(sensor) for sensor in robot.sensors),
            initial=initial_configuration(robot),
            excluded_pairs=sorted_pairs(pair for pair in without_contacts(robot) if pair <= touching),
        )

    def _motion(
        self, robot: Robot, request: Request, closed: Sequence[Mapping[str, float]], moments: Sequence[Any]
    ) -> _Motion:
        """Limits and dynamics of joints, which formats express differently, have no influence on it."""
        joints = [replace(joint, limit=Limit(), dynamics=JointDynamics()) for joint in robot.joints]
        bodies = [(link.name, link.mass_properties) for link in robot.links]
        inputs = (joints, bodies, request.configurations, moments, closed)
        known = next((motion for motion in self._motions if motion.inputs == inputs), None)
        if known is None:
            tree = Tree(robot)
            poses = tuple(link_poses_at(robot, [*request.configurations, *closed], tree))
            equations = tuple(equations_at(robot, moments, tree=tree)) if moments else ()
            known = _Motion(inputs, tree.joints, poses, equations)
            self._motions.append(known)
        return known

    def _link(self, robot: Robot, link: Link, *, shaded: bool) -> ObservedLink:
        body = link.mass_properties
        observed = ObservedLink(link.name, body.mass, body.com, body.inertia, gravity_compensation=0.0)
        visuals = (
            replace(
                self._shape(robot, shape), rgba=shape.rgba, ambient=shape.rgba if shaded else None, groups=(2, 0, 0)
            )
            for shape in link.visuals
        )
        collisions = (
            replace(self._shape(robot, shape), groups=(3, 1, 1), surface=shape.surface) for shape in link.collisions
        )
        return with_shapes(observed, tuple(visuals), tuple(collisions))

    def _shape(self, robot: Robot, shape: Visual | Collision) -> ObservedShape:
        boxes = self._box(robot, shape), self._box(robot, shape, OBLIQUE)
        return ObservedShape(shape.name, bounds=boxes[0], oblique=boxes[1])

    def _box(self, robot: Robot, shape: Visual | Collision, X_FL: Pose = IDENTITY) -> Bounds:
        """The bounding box of a shape in its link's frame, or in another."""
        geometry, X_LG = shape.geometry, X_FL @ shape.X_LG if X_FL is not IDENTITY else shape.X_LG
        drawn = robot.mesh_by_name[geometry.name].mesh if isinstance(geometry, MeshRef) else geometry
        if (drawn, X_LG) not in self._boxes:
            if isinstance(drawn, TriMesh):
                self._boxes[drawn, X_LG] = mesh_bounds(drawn.vertices, X_LG)
            else:
                self._boxes[drawn, X_LG] = primitive_bounds(drawn, X_LG)
        return self._boxes[drawn, X_LG]


def _joint(joint: Joint) -> ObservedJoint:
    fixed = joint.kind is JointKind.FIXED
    axis = joint.axis if joint.kind.has_axis else None
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
        closure.axis if closure.kind.is_hinge else None,
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
