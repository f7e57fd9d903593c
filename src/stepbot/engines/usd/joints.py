"""Joints of UsdPhysics: their frames, limits, drives and mimics, as a tree and the closures of its loops.

Angles are in degrees; gains and damping of joints that turn are per degree.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import inf, radians
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.spatial import Array, Pose, Vector3, rotation_angle, vector3
from stepbot.robot.model import ActuatorKind, JointDynamics, JointKind, Limit, LoopClosure, Mimic

from ..observation import (
    EngineCannotRead,
    EngineRefused,
    ObservedActuator,
    ObservedClosure,
    ObservedJoint,
    turned_as_expected,
)
from .stage import Body, Stage, name_of, rigid

_KINDS = {
    "PhysicsFixedJoint": JointKind.FIXED.value,
    "PhysicsRevoluteJoint": JointKind.REVOLUTE.value,
    "PhysicsPrismaticJoint": JointKind.PRISMATIC.value,
    "PhysicsSphericalJoint": JointKind.BALL.value,
}
_UNITS = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}
_DECIMALS = 7
"""Digits [m] of a joint's position in its link, and of its axis: both are products of numbers of single precision."""
_RESIDUE = 1e-6
"""Position [rad], [m] below which a joint is at 0."""


class Connection(Struct, frozen=True, eq=False):
    """A joint between two bodies, or between the world and a body."""

    prim: Any
    kind: str
    """A :class:`.JointKind` value, or the type of the prim."""
    bodies: tuple[Body | None, Body | None]
    """None is the world."""
    frames: tuple[Pose, Pose]
    """Pose of the joint in both bodies, or in the stage."""
    closes: bool

    @property
    def name(self) -> str:
        """Its name."""
        return name_of(self.prim)

    @property
    def turns(self) -> bool:
        """Whether its positions are angles."""
        return self.kind in (JointKind.REVOLUTE, JointKind.CONTINUOUS)

    @property
    def local_axis(self) -> Vector3:
        """The axis in the joint's frame.

        Raises:
            EngineRefused: It is not X, Y or Z.
        """
        axis = str(self.prim.GetAttribute("physics:axis").Get() or "X")
        if axis not in _UNITS:
            raise EngineRefused(f"joint '{self.name}': axis '{axis}' is not X, Y or Z")
        return _UNITS[axis]

    def units(self, stage: Stage) -> tuple[float, float]:
        """One unit of force [N] and of mass [kg]; for a joint that turns, of torque [N m] and inertia [kg m^2]."""
        if self.kind == JointKind.PRISMATIC:
            return stage.newtons, stage.kilograms
        torque = stage.newtons * stage.metres
        return torque, torque

    def reversed(self) -> "Connection":
        """The connection with its bodies exchanged; its position has the opposite sign."""
        return replace(self, bodies=self.bodies[::-1], frames=self.frames[::-1])


class Branch(Struct, frozen=True, eq=False):
    """A connection of the tree, from parent to child."""

    connection: Connection
    parent: Body
    child: Body
    sign: float = 1.0
    """-1 if the file has parent and child the other way round."""

    @property
    def frames(self) -> tuple[Pose, Pose]:
        """Pose of the joint in the parent and in the child."""
        return self.connection.frames

    @property
    def axis(self) -> Vector3:
        """The axis in the child, in the direction of positive positions."""
        turned = np.array(self.connection.frames[1].turn(self.connection.local_axis)) * self.sign
        return vector3(np.round(turned, _DECIMALS) + 0.0)


def connections(stage: Stage) -> list[Connection]:
    """All enabled joints.

    Raises:
        EngineRefused: A joint has no body.
    """
    from pxr import UsdPhysics

    connected = []
    for prim in stage.prims():
        if not prim.IsA(UsdPhysics.Joint) or not UsdPhysics.Joint(prim).GetJointEnabledAttr().Get():
            continue
        joint = UsdPhysics.Joint(prim)
        ends = [_end(stage, joint, number) for number in (0, 1)]
        if ends[0][0] is ends[1][0]:
            raise EngineRefused(f"joint '{name_of(prim)}' does not connect two bodies")
        kind = _KINDS.get(str(prim.GetTypeName()), str(prim.GetTypeName()))
        if kind == JointKind.REVOLUTE and _range(prim) == (-inf, inf):
            kind = JointKind.CONTINUOUS.value
        closes = bool(joint.GetExcludeFromArticulationAttr().Get())
        bodies, frames = zip(*ends, strict=True)
        connected.append(Connection(prim, kind, bodies, frames, closes))
    return connected


def _end(stage: Stage, joint: Any, number: int) -> tuple[Body | None, Pose]:
    """A body of a joint, and the joint's frame in it."""
    targets = (joint.GetBody0Rel() if number == 0 else joint.GetBody1Rel()).GetTargets()
    position = (joint.GetLocalPos0Attr() if number == 0 else joint.GetLocalPos1Attr()).Get()
    rotation = (joint.GetLocalRot0Attr() if number == 0 else joint.GetLocalRot1Attr()).Get()
    prim = stage.stage.GetPrimAtPath(targets[0]) if targets else None
    if targets and not prim:
        raise EngineRefused(f"joint '{name_of(joint.GetPrim())}': no prim {targets[0]}")
    body = stage.body_of(prim) if prim else None
    if not any(wxyz(rotation)):
        raise EngineRefused(f"joint '{name_of(joint.GetPrim())}': a quaternion of length 0")
    local = Pose.from_quaternion(wxyz(rotation), position)
    if body is None:
        return None, Pose.of(local.R, local.p * stage.metres)
    M = stage.in_body(prim, body)
    return body, Pose.of(rigid(M)[0].R @ local.R, M[:3, :3] @ local.p + M[:3, 3])


def wxyz(quaternion: Any) -> tuple[float, float, float, float]:
    """A quaternion (w, x, y, z)."""
    x, y, z = quaternion.GetImaginary()
    return float(quaternion.GetReal()), float(x), float(y), float(z)


def grown(stage: Stage, connections: Sequence[Connection]) -> tuple[list[Branch], list[Connection], Body, bool]:
    """The tree, the closures, the root, and whether the root is fixed to the world.

    Raises:
        EngineCannotRead: A joint to the world moves, or bodies are not connected.
    """
    to_world = [connection for connection in connections if None in connection.bodies and not connection.closes]
    moving = [one.name for one in to_world if one.kind != JointKind.FIXED]
    if moving:
        raise EngineCannotRead(f"joints to the world that move are not supported: {', '.join(moving)}")
    inner = [connection for connection in connections if None not in connection.bodies]
    open_ = [one for one in inner if not one.closes]
    below = {id(one.bodies[1]) for one in open_}
    held = [body for one in to_world for body in one.bodies if body is not None]
    root = next(iter([*held, *(body for body in stage.bodies.values() if id(body) not in below)]), None)
    root = root or next(iter(stage.bodies.values()))
    branches, reached, waiting = dict[int, Branch](), {id(root)}, [root]
    for body in waiting:  # grows during the loop
        for number, one in enumerate(open_):
            for sign, way in ((1.0, one), (-1.0, one.reversed())):
                parent, child = way.bodies
                if parent is body and child is not None and id(child) not in reached and number not in branches:
                    branches[number] = Branch(way, body, child, sign)
                    reached.add(id(child))
                    waiting.append(child)
    rest = [body.name for body in stage.bodies.values() if id(body) not in reached]
    if rest:
        raise EngineCannotRead(f"bodies that are not connected to '{root.name}': {', '.join(rest)}")
    closing = [one for one in inner if one.closes] + [one for i, one in enumerate(open_) if i not in branches]
    return [branches[number] for number in sorted(branches)], closing, root, bool(held)


def observed_joint(stage: Stage, branch: Branch, leaders: Mapping[str, tuple[str, float]]) -> ObservedJoint:
    """A joint of the tree.

    Args:
        leaders: Name and sign (:attr:`Branch.sign`) of the joint at each path.
    """
    one, prim = branch.connection, branch.connection.prim
    anchor = vector3(np.round(branch.frames[1].p, _DECIMALS) + 0.0)
    bare = ObservedJoint(one.name, one.kind, branch.parent.name, branch.child.name, anchor=anchor, mimic_read=True)
    if one.kind == JointKind.FIXED:
        return bare
    force, mass = one.units(stage)
    dynamics = JointDynamics(
        damping=_per_unit(one, _number(prim, "newton:damping")) * mass,
        friction=_number(prim, "newton:friction") * force,
        armature=_number(prim, "newton:armature") * mass,
    )
    bare = replace(bare, dynamics=dynamics, dynamics_fields=("damping", "friction", "armature"))
    if one.kind not in (JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.PRISMATIC):
        return bare
    lower, upper = (_in_si(stage, one, bound) for bound in _range(prim))
    if branch.sign < 0.0:
        lower, upper = -upper, -lower
    velocity = min(_number(prim, name, inf) for name in ("newton:velocityLimit", "physxJoint:maxJointVelocity"))
    drive = _drive(stage, one)
    limit = Limit(lower, upper, _in_si(stage, one, velocity), inf if drive is None else drive.force)
    # The force limit of an actuator is its own.
    fields = ("lower", "upper", "velocity") if drive is not None and drive.actuates else bare.limit_fields
    return replace(bare, axis=branch.axis, limit=limit, limit_fields=fields, mimic=_mimic(stage, branch, leaders))


def _mimic(stage: Stage, branch: Branch, leaders: Mapping[str, tuple[str, float]]) -> Mimic | None:
    prim = branch.connection.prim
    targets = prim.GetRelationship("newton:mimicJoint").GetTargets() if "NewtonMimicAPI" in _schemas(prim) else []
    if not targets or prim.GetAttribute("newton:mimicEnabled").Get() is False:
        return None
    if str(targets[0]) not in leaders:
        raise EngineRefused(f"joint '{branch.connection.name}' mimics {targets[0]}, which is not a joint")
    leader, sign = leaders[str(targets[0])]
    offset = _in_si(stage, branch.connection, _number(prim, "newton:mimicCoef0"))
    return Mimic(leader, branch.sign * sign * _number(prim, "newton:mimicCoef1", 1.0), branch.sign * offset)


class _Drive(Struct, frozen=True):
    """The drive of a joint, in SI."""

    name: str
    """Name of the actuator; empty for none."""
    stiffness: float
    damping: float
    force: float

    @property
    def actuates(self) -> bool:
        """Whether it is an actuator, and not a limit of the force alone."""
        return bool(self.name or self.stiffness or self.damping)


def _drive(stage: Stage, connection: Connection) -> _Drive | None:
    from pxr import UsdPhysics

    name = "linear" if connection.kind == JointKind.PRISMATIC else "angular"
    if not connection.prim.HasAPI(UsdPhysics.DriveAPI, name):
        return None
    drive, (force, gain) = UsdPhysics.DriveAPI(connection.prim, name), connection.units(stage)
    stiffness, damping = (
        _per_unit(connection, float(a.Get())) for a in (drive.GetStiffnessAttr(), drive.GetDampingAttr())
    )
    actuator = str(connection.prim.GetCustomDataByKey("actuator") or "")
    return _Drive(actuator, stiffness * gain, damping * gain, float(drive.GetMaxForceAttr().Get()) * force)


def actuators(stage: Stage, branches: Sequence[Branch], joints: Sequence[ObservedJoint]) -> Iterator[ObservedActuator]:
    """The drives that control a joint; their inputs are bounded by the joints."""
    for branch, joint in zip(branches, joints, strict=True):
        drive = _drive(stage, branch.connection) if joint.limit is not None else None
        if drive is None or not drive.actuates or joint.limit is None:
            continue
        force = (-drive.force, drive.force)
        if drive.stiffness:
            kind, control = ActuatorKind.POSITION, (joint.limit.lower, joint.limit.upper)
        elif drive.damping:
            kind, control = ActuatorKind.VELOCITY, (-joint.limit.velocity, joint.limit.velocity)
        else:
            kind, control = ActuatorKind.MOTOR, force
        bound = None if kind is ActuatorKind.MOTOR else force
        yield ObservedActuator(drive.name, joint.name, kind.value, drive.stiffness, drive.damping, None, control, bound)


def observed_closure(connection: Connection, loops: Sequence[LoopClosure]) -> ObservedClosure:
    """A joint that closes a loop, in the frames of the expected one."""
    ends = [body.name for body in connection.bodies if body is not None]
    axis = connection.local_axis if connection.turns or connection.kind == JointKind.PRISMATIC else None
    # Without limits, a pin that closes a loop is continuous in UsdPhysics, and revolute in the model.
    kind = JointKind.REVOLUTE.value if connection.kind == JointKind.CONTINUOUS else connection.kind
    return turned_as_expected(connection.name, kind, (ends[0], ends[1]), connection.frames, axis, loops)


def without_residue(q: float) -> float:
    """A position [rad], [m]; 0 in place of the rounding of single precision."""
    return 0.0 if abs(q) < _RESIDUE else q


def position(branch: Branch) -> float:
    """The position [rad], [m] at which the bodies are in the stage."""
    X_PJ, X_CJ = branch.frames
    X = X_PJ.inverse() @ branch.parent.X_W.inverse() @ branch.child.X_W @ X_CJ
    axis: Array = np.array(branch.connection.local_axis)
    if branch.connection.kind == JointKind.PRISMATIC:
        return without_residue(branch.sign * float(axis @ X.p))
    skew = np.array([X.R[2, 1] - X.R[1, 2], X.R[0, 2] - X.R[2, 0], X.R[1, 0] - X.R[0, 1]])
    return without_residue(branch.sign * float(np.copysign(rotation_angle(X.R), axis @ skew)))


def _range(prim: Any) -> tuple[float, float]:
    return _number(prim, "physics:lowerLimit", -inf), _number(prim, "physics:upperLimit", inf)


def _number(prim: Any, name: str, default: float = 0.0) -> float:
    value = prim.GetAttribute(name).Get() if prim.HasAttribute(name) else None
    try:
        return default if value is None else float(value)
    except (TypeError, ValueError) as error:
        raise EngineRefused(f"'{name}' of '{name_of(prim)}' is not a number") from error


def _schemas(prim: Any) -> set[str]:
    """Applied schemas, including those that USD does not have the definition of."""
    listed = prim.GetMetadata("apiSchemas")
    return set(prim.GetAppliedSchemas()) | set(listed.GetAddedOrExplicitItems() if listed else ())


def _in_si(stage: Stage, connection: Connection, value: float) -> float:
    return radians(value) if connection.turns else value * stage.metres


def _per_unit(connection: Connection, value: float) -> float:
    """A gain per degree as one per radian; others are unchanged."""
    return value / radians(1.0) if connection.turns else value
