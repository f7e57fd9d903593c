"""The wheels of a base that turns by their difference, as ros2_control's ``diff_drive_controller`` drives them."""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array
from stepbot.robot.bounding_boxes import robot_bounds
from stepbot.robot.kinematics import initial_configuration, link_poses, rigid_bodies
from stepbot.robot.model import ActuatorKind, Base, Joint, JointKind, Robot

from .chains import module_of_joint

_ALONG = 1e-3
"""Difference [1] of a direction from an axis of the base up to which it is that axis."""
_NEAR = 5e-3
"""Distance, relative to that of the wheels, and difference of radii, relative to the largest, that count as none."""

_DIGITS = 6
"""Decimal places of sizes [m]: shapes have the rounding of their meshes."""


class DifferentialDrive(Struct, frozen=True):
    """Two wheels, or several in line, that a positive speed drives forwards."""

    module: str
    """The module that they are part of; empty for none."""
    left: tuple[str, ...]
    """Joints of the wheels on the left."""
    right: tuple[str, ...]
    separation: float
    """Distance [m] of the middles of the wheels on the left from those on the right."""
    radius: float
    """[m]"""
    frame: str
    """A link that is fixed to the base, between the wheels, with x forwards and z up: odometry is about it."""
    speed: float
    """Least velocity limit [rad/s] of the wheels."""


def differential_drive(robot: Robot) -> DifferentialDrive | None:
    """The drive of a floating base, as URDF has it: wheels with axles to the left, in one line, and nothing else.

    None for other bases: wheels that steer, that have rollers, or that turn the base only by slipping; wheels whose
    positive speed drives backwards, since the controller knows no signs; and a base without a frame between them.
    """
    base, _ = _with_place(robot)
    return base if base is not None and base.frame else None


def place_without_frame(robot: Robot) -> tuple[float, float, float] | None:
    """Where in the frame of the root [m] a base that is one but for it needs a frame: in the middle of the wheels."""
    base, place = _with_place(robot)
    return place if base is not None and not base.frame else None


def _with_place(robot: Robot) -> tuple[DifferentialDrive | None, tuple[float, float, float]]:
    """The drive, its frame empty if there is none, and the middle of its wheels."""
    nothing = None, (0.0, 0.0, 0.0)
    wheels = _driven_wheels(robot)
    if robot.base is not Base.FLOATING or not wheels:
        return nothing
    poses = link_poses(robot, initial_configuration(robot))
    places = [_place(robot, joint, poses[joint.child].p) for joint in wheels]
    axles = [poses[joint.child].turn(joint.axis) for joint in wheels]
    inside, body = module_of_joint(robot), rigid_bodies(robot.root.name, robot.joints)
    modules = {inside.get(joint.name, "") for joint in wheels}
    fixed = all(body[joint.parent] == body[robot.root.name] for joint in wheels)
    to_the_left = all(np.abs(np.subtract(axle, (0.0, 1.0, 0.0))).max() < _ALONG for axle in axles)
    if any(place is None for place in places) or not (fixed and to_the_left) or len(modules) > 1:
        return nothing
    rows = np.array(places, float)  # x, y, height of the axle, radius
    middle = rows[:, 1].mean()
    left, right = ([i for i, one in enumerate(rows) if sign * (one[1] - middle) > 0.0] for sign in (1.0, -1.0))
    if not left or len(left) != len(right):
        return nothing
    separation = float(rows[left, 1].mean() - rows[right, 1].mean())
    radii, near = rows[:, 3], _NEAR * separation
    if np.ptp(rows[:, 0]) > near or np.ptp(radii) > _NEAR * radii.max() or _has_rollers(robot, wheels):
        return nothing
    x, y, z = (round(value, _DIGITS) + 0.0 for value in (rows[:, 0].mean(), middle, rows[:, 2].mean()))
    frame = _frame_at(robot, float(rows[:, 0].mean()), float(middle), near)
    names = [tuple(wheels[i].name for i in side) for side in (left, right)]
    speed = min(joint.limit.velocity for joint in wheels)
    sizes = [round(size, _DIGITS) for size in (separation, float(radii.mean()))]
    return DifferentialDrive(modules.pop(), names[0], names[1], sizes[0], sizes[1], frame, speed), (x, y, z)


def _frame_at(robot: Robot, x: float, y: float, near: float) -> str:
    """The first link that is fixed to the root, turned as it is, and above or below a place; empty for none."""
    poses, body = link_poses(robot, {}), rigid_bodies(robot.root.name, robot.joints)
    for link in robot.links:
        X = poses[link.name]
        is_at = max(abs(X.p[0] - x), abs(X.p[1] - y)) <= near and np.abs(X.R - np.eye(3)).max() < _ALONG
        if is_at and body[link.name] == body[robot.root.name]:
            return link.name
    return ""


def _driven_wheels(robot: Robot) -> list[Joint]:
    joints = (
        robot.joint_by_name[actuator.joint] for actuator in robot.actuators if actuator.kind is ActuatorKind.VELOCITY
    )
    return [joint for joint in dict.fromkeys(joints) if joint.kind is JointKind.CONTINUOUS]


def _place(robot: Robot, joint: Joint, axle: Array) -> tuple[float, float, float, float] | None:
    """Where a wheel is in the frame of the root, at the middle of its width, and its radius; None without shapes."""
    around = robot_bounds(robot, initial_configuration(robot), [joint.child])
    if around is None:
        return None
    low, high = around
    return float(axle[0]), 0.5 * (low[1] + high[1]), float(axle[2]), float(axle[2]) - low[2]


def _has_rollers(robot: Robot, wheels: Sequence[Joint]) -> bool:
    links = {joint.child for joint in wheels}
    return any(joint.parent in links and joint.kind is not JointKind.FIXED for joint in robot.joints)
