"""Joints and closures of UsdPhysics: https://openusd.org/release/api/usd_physics_page_front.html.

Angles are in degrees, and so are speeds, gains and damping of joints that turn. UsdPhysics has neither passive forces
nor velocity limits nor mimics; they are in Newton's schemas, https://github.com/newton-physics/newton-usd-schemas,
whose attributes other programs ignore.

Tools of Isaac Sim list the robots, links, joints and sites of a stage by its robot schema, which others ignore:
https://docs.isaacsim.omniverse.nvidia.com/latest/omniverse_usd/robot_schema.html.
"""

from collections.abc import Mapping, Sequence
from math import degrees, isfinite, radians

from stepbot.geometry.spatial import IDENTITY, Pose, Vector3, perpendicular_frame
from stepbot.robot.gains import actuator_limit
from stepbot.robot.kinematics import initial_configuration
from stepbot.robot.model import Actuator, ActuatorKind, Base, Joint, JointKind, LoopClosure, Robot

from .usda import Names, Prim, named, quoted, single, singles

_TYPES: Mapping[JointKind, str] = {
    JointKind.FIXED: "PhysicsFixedJoint",
    JointKind.REVOLUTE: "PhysicsRevoluteJoint",
    JointKind.CONTINUOUS: "PhysicsRevoluteJoint",
    JointKind.PRISMATIC: "PhysicsPrismaticJoint",
    JointKind.BALL: "PhysicsSphericalJoint",
}
_AXES: Mapping[Vector3, str] = {(1.0, 0.0, 0.0): "X", (0.0, 1.0, 0.0): "Y", (0.0, 0.0, 1.0): "Z"}
JOINTS = "joints"
"""The scope of joints and closures."""
_WORLD_JOINT = "world_joint"


def joints(robot: Robot, top: str, paths: Mapping[str, str]) -> Prim:
    """All joints and closures.

    Args:
        top: Path of its prim.
        paths: Path of each link.
    """
    scope, names = Prim("Scope", JOINTS), Names()
    identifiers = {joint.name: names.of(joint.name) for joint in robot.joints}
    drawn = initial_configuration(robot)
    for joint in robot.joints:
        prim = scope.add(_joint(joint, identifiers[joint.name], paths))
        mark_joint(prim, joint.name)
        if joint.kind is not JointKind.FIXED:
            _passive(prim, joint)
            leader = f"{top}/{JOINTS}/{identifiers[joint.mimic.joint]}" if joint.mimic else ""
            _mimic(prim, joint, leader)
        if joint.kind.is_pair:
            actuators = [actuator for actuator in robot.actuators if actuator.joint == joint.name]
            _drive(prim, joint, actuators[0] if actuators else None, drawn[joint.name])
    for closure in robot.closures:
        scope.add(_closure(closure, names, paths))
    if robot.base is Base.FIXED:
        fixed = scope.add(Prim("PhysicsFixedJoint", names.of(_WORLD_JOINT)))
        mark_joint(fixed, fixed.name)
        fixed.set("rel physics:body1", f"<{paths[robot.root.name]}>")
        _frames(fixed, IDENTITY, IDENTITY)
    return scope


def _joint(joint: Joint, identifier: str, paths: Mapping[str, str]) -> Prim:
    prim = named(_TYPES[joint.kind], joint.name, Names(), identifier)
    turned = _axis(prim, joint.axis, moves=joint.kind.has_axis)
    _bodies(prim, paths[joint.parent], paths[joint.child])
    _frames(prim, joint.X_PC @ turned, turned)
    if joint.kind.bounded:
        for name, bound in (("lower", joint.limit.lower), ("upper", joint.limit.upper)):
            if isfinite(bound):
                prim.set(f"float physics:{name}Limit", single(stage_unit(joint, bound)))
    return prim


def _closure(closure: LoopClosure, names: Names, paths: Mapping[str, str]) -> Prim:
    """A joint that simulators with reduced coordinates enforce as a constraint."""
    prim = named(_TYPES[closure.kind], closure.name, names)
    turned = _axis(prim, closure.axis, moves=closure.kind.has_axis)
    _bodies(prim, paths[closure.link_a], paths[closure.link_b])
    _frames(prim, closure.X_AF @ turned, closure.X_BF @ turned)
    prim.set("uniform bool physics:excludeFromArticulation", "true")
    return prim


def _axis(prim: Prim, axis: Vector3, *, moves: bool) -> Pose:
    """Set the axis, and return the pose of the joint's frame: axes are X, Y or Z of that."""
    if not moves:
        return IDENTITY
    prim.set("uniform token physics:axis", quoted(_AXES.get(axis, "Z")))
    return IDENTITY if axis in _AXES else Pose.of(perpendicular_frame(axis))


def _bodies(prim: Prim, body0: str, body1: str) -> None:
    prim.set("rel physics:body0", f"<{body0}>")
    prim.set("rel physics:body1", f"<{body1}>")


def _frames(prim: Prim, X_0J: Pose, X_1J: Pose) -> None:
    """The joint's frame in both bodies."""
    for number, X in enumerate((X_0J, X_1J)):
        prim.set(f"point3f physics:localPos{number}", singles(X.position))
        prim.set(f"quatf physics:localRot{number}", singles(X.quaternion))


def _passive(prim: Prim, joint: Joint) -> None:
    """Passive forces and the velocity limit, by Newton's schema."""
    given = {
        "armature": joint.dynamics.armature,
        "damping": per_stage_unit(joint, joint.dynamics.damping),
        "friction": joint.dynamics.friction,
    }
    if isfinite(joint.limit.velocity):
        given["velocityLimit"] = stage_unit(joint, joint.limit.velocity)
    prim.schemas.append("NewtonJointAPI")
    for name, value in given.items():
        if value or name == "velocityLimit":
            prim.set(f"float newton:{name}", single(value))


def _mimic(prim: Prim, joint: Joint, leader: str) -> None:
    """A mimic, by Newton's schema."""
    if joint.mimic is not None:
        prim.schemas.append("NewtonMimicAPI")
        prim.set("float newton:mimicCoef0", single(stage_unit(joint, joint.mimic.offset)))
        prim.set("float newton:mimicCoef1", single(joint.mimic.multiplier))
        prim.set("rel newton:mimicJoint", f"<{leader}>")


def _drive(prim: Prim, joint: Joint, actuator: Actuator | None, drawn: float) -> None:
    """The drive of a joint, which has the effort limit too: an actuator, or a limit alone."""
    effort = joint.limit.effort if actuator is None else actuator_limit(actuator, joint).effort
    if actuator is None and not isfinite(effort):
        return
    drive = "linear" if joint.kind is JointKind.PRISMATIC else "angular"
    prim.schemas.append(f"PhysicsDriveAPI:{drive}")
    if isfinite(effort):
        prim.set(f"float drive:{drive}:physics:maxForce", single(effort))
    if actuator is None:
        return
    prim.metadata.append(f"customData = {{ string actuator = {quoted(actuator.name)} }}")
    if actuator.kind is ActuatorKind.POSITION:
        prim.set(f"float drive:{drive}:physics:stiffness", single(per_stage_unit(joint, actuator.kp)))
        prim.set(f"float drive:{drive}:physics:targetPosition", single(stage_unit(joint, drawn)))
    if actuator.kind is not ActuatorKind.MOTOR:
        prim.set(f"float drive:{drive}:physics:damping", single(per_stage_unit(joint, actuator.kv)))


def stage_unit(joint: Joint, value: float) -> float:
    """A position [rad], [m] or speed of a joint in the stage's unit: degrees or metres."""
    return value if joint.kind is JointKind.PRISMATIC else degrees(value)


def per_stage_unit(joint: Joint, value: float) -> float:
    """A gain or damping per [rad] or [m] in the stage's unit: per degree or metre."""
    return value if joint.kind is JointKind.PRISMATIC else radians(value)


_ROBOT, _LINK, _JOINT, _SITE = "IsaacRobotAPI", "IsaacLinkAPI", "IsaacJointAPI", "IsaacSiteAPI"
_PINNED = "Manipulator"
"""The type of robots whose base is fixed. The types of others name what they are for, which the model does not have."""


def mark_robot(prim: Prim, robot: Robot, links: Sequence[str], joints: Sequence[str]) -> None:
    """Apply the schema of robots.

    Args:
        links: Paths of its links, the base first.
        joints: Paths of its joints, the one to the world first; without closures, which the articulation excludes.
    """
    prim.schemas.append(_ROBOT)
    stated = {
        "string isaac:description": robot.metadata.description,
        "token isaac:license": robot.metadata.license,
        "token isaac:robotType": _PINNED if robot.base is Base.FIXED else "",
        "string isaac:source": robot.source,
        "string isaac:version": robot.metadata.version,
    }
    for declaration, value in stated.items():
        if value:
            prim.set(declaration, quoted(value))
    for name, paths in (("robotJoints", joints), ("robotLinks", links)):
        if paths:  # prepended, so that a scene can add a tool's
            prim.set(f"prepend rel isaac:physics:{name}", f"[{', '.join(f'<{path}>' for path in paths)}]")


def mark_link(prim: Prim, name: str) -> None:
    """Apply the schema of links, with the name where the prim has another one."""
    prim.schemas.append(_LINK)
    if prim.name != name:
        prim.set("string isaac:nameOverride", quoted(name))


def mark_joint(prim: Prim, name: str) -> None:
    """Apply the schema of joints in the articulation, with the name where the prim has another one."""
    prim.schemas.append(_JOINT)
    if prim.name != name:
        prim.set("string isaac:NameOverride", quoted(name))


def mark_site(prim: Prim) -> None:
    """Apply the schema of frames: places of tools and sensors."""
    prim.schemas.append(_SITE)


def marked_joints(scope: Prim) -> list[str]:
    """Names of the prims of joints with the schema, the one to the world first."""
    marked = [prim for prim in scope.children if _JOINT in prim.schemas]
    rooted = sorted(marked, key=lambda prim: any(one.startswith("rel physics:body0") for one in prim.properties))
    return [prim.name for prim in rooted]
