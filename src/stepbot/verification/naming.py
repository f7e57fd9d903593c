"""The coordinates of a file's joints: their own names, or those of a multi-dof joint's chain."""

from collections.abc import Iterable, Mapping
from functools import cached_property

from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines.observation import Observation, ObservedJoint
from stepbot.geometry.spatial import vector3
from stepbot.robot.joint_types import kinds_with
from stepbot.robot.kinematics import moving_joints
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Joint, JointKind, Limit, Link, Robot
from stepbot.robot.multi_dof import ball_coordinates, universal_coordinates

_KINDS = frozenset((*kinds_with(coordinates=1), *kinds_with(about="point")))
"""Types of joints with coordinates of these names in the engines."""


class Naming(Struct, frozen=True, dict=True):
    """The joints of a file, each on a link of its own: the minimum robot from which coordinates are named."""

    robot: Robot

    @cached_property
    def balls(self) -> Mapping[str, tuple[str, str, str]]:
        """Coordinates of each ball joint: yaw, pitch, roll."""
        return ball_coordinates(self.robot)

    @cached_property
    def universals(self) -> Mapping[str, tuple[str, str]]:
        """Coordinates of each universal joint, about the first axis and about the second."""
        return universal_coordinates(self.robot)


def naming(observation: Observation) -> Naming:
    """Names of the coordinates of a file."""
    known = [step for joint in observation.joints for step in steps_of(joint) if step.name and step.kind in _KINDS]
    taken = {"", *(joint.child for joint in observation.joints)}
    joints = []
    for step in {step.name: step for step in known}.values():
        taken.discard(step.child)
        joints.append(
            Joint(
                step.name,
                JointKind(step.kind),
                "",
                free_name(step.child, "_", taken),
                axis=vector3(step.axis or (0.0, 0.0, 1.0)),
                axis2=vector3(step.axis2 or (1.0, 0.0, 0.0)),
                limit=step.limit or Limit(),
                mimic=step.mimic,
                pitch=step.pitch or 0.0,
            )
        )
    return Naming(_on_a_root(joints))


def steps_of(joint: ObservedJoint) -> tuple[ObservedJoint, ...]:
    """The component joints by which a file represents a joint: usually the joint itself."""
    return joint.steps or (joint,)


def moved(namings: Iterable[Naming]) -> Robot:
    """The coordinates of all files as joints, within the limits of each, to draw random configurations."""
    joints: dict[str, Joint] = {}
    for joint in (joint for one in namings for joint in moving_joints(one.robot)):
        limit, known = joint.limit, joints.get(joint.name)
        if known is not None:
            lower, upper = max(limit.lower, known.limit.lower), min(limit.upper, known.limit.upper)
            limit = Limit(lower, upper) if lower <= upper else known.limit
        mimic = joint.mimic or (known.mimic if known else None)
        kind = known.kind if known else joint.kind
        child = f"{len(joints)}" if known is None else known.child
        joints[joint.name] = Joint(joint.name, kind, "", child, limit=limit, mimic=mimic)
    led = [
        joint if joint.mimic and joint.mimic.joint in joints else replace(joint, mimic=None)
        for joint in joints.values()
    ]
    return _on_a_root(led)


def _on_a_root(joints: Iterable[Joint]) -> Robot:
    joints = tuple(joints)
    return Robot("", (Link(""), *(Link(joint.child) for joint in joints)), joints)
