"""Mechanisms with loops of every kind of closure, and their motions in closed form."""

import math
from collections.abc import Callable

import numpy as np

from stepbot.geometry.spatial import Array, Pose, Vector3, perpendicular_frame, vector3
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.model import Actuator, ActuatorKind, Joint, JointKind, Limit, LoopClosure, Robot
from tests.workshop import GLASS, ORANGE, STEEL, Workshop, at

Y, Z = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
GROUND, CRANK, COUPLER, ROCKER = 0.3, 0.1, 0.28, 0.2
"""Lengths [m] of the four-bar's links between their pins; the crank turns fully (Grashof)."""


def four_bar_angles(crank: float) -> tuple[float, float]:
    """Angles [rad] of coupler and rocker from the ground line for a crank angle; the open assembly."""
    x, y = GROUND - CRANK * math.cos(crank), -CRANK * math.sin(crank)
    diagonal = math.hypot(x, y)
    at_coupler = math.acos((COUPLER**2 + diagonal**2 - ROCKER**2) / (2 * COUPLER * diagonal))
    coupler = math.atan2(y, x) + at_coupler
    tip_x = CRANK * math.cos(crank) + COUPLER * math.cos(coupler) - GROUND
    tip_y = CRANK * math.sin(crank) + COUPLER * math.sin(coupler)
    return coupler, math.atan2(tip_y, tip_x)


THROW, ROD = 0.06, 0.2
"""Lengths [m] of crank and rod of the slider-crank."""


def closure(robot: Robot, name: str, kind: JointKind, link_a: str, link_b: str, X_WF: Pose, axis: Vector3) -> Robot:
    """The robot with one more closure, closed in the drawn pose."""
    X_W = link_poses(robot, initial_configuration(robot))
    X_AF, X_BF = X_W[link_a].inverse() @ X_WF, X_W[link_b].inverse() @ X_WF
    closures = (*robot.closures, LoopClosure(name, kind, link_a, X_AF, link_b, X_BF, axis))
    return Robot(
        robot.name, robot.links, robot.joints, closures, (), robot.actuators, robot.meshes, robot.base, robot.source
    )


def piston_position(crank: float) -> float:
    """Distance [m] of the piston's pin from the crank's axis."""
    return THROW * math.cos(crank) + math.sqrt(ROD**2 - (THROW * math.sin(crank)) ** 2)


def _slider_crank(name: str, closing: JointKind) -> Robot:
    """A crank at 60 degrees, a rod and a piston; the loop is closed at the piston's pin, or at its cylinder."""
    shop = Workshop()
    drawn = math.pi / 3
    rod_angle = -math.asin(THROW * math.sin(drawn) / ROD)
    block = shop.link("block", [((0.4, 0.1, 0.01), at(x=0.1, z=-0.05))])
    crank = shop.link("crank", [((THROW, 0.02, 0.01), at(x=THROW / 2))], rgba=ORANGE)
    rod = shop.link("rod", [((ROD, 0.01, 0.01), at(x=ROD / 2, z=0.02))])
    piston = shop.link("piston", [((0.04, 0.03, 0.03), at(x=0.01, z=0.05))], rgba=GLASS)
    joints = [
        Joint("shaft", JointKind.CONTINUOUS, "block", "crank", at(rpy=(0, 0, drawn))),
        Joint("big_end", JointKind.CONTINUOUS, "crank", "rod", at(x=THROW, rpy=(0, 0, rod_angle - drawn))),
    ]
    X_WF = at(piston_position(drawn))
    if closing is JointKind.PRISMATIC:
        joints.append(Joint("wrist", JointKind.CONTINUOUS, "rod", "piston", at(x=ROD, rpy=(0, 0, -rod_angle))))
    else:
        stroke = Limit(-0.5, 0.5)
        joints.append(Joint("cylinder", JointKind.PRISMATIC, "block", "piston", X_WF, (1.0, 0.0, 0.0), limit=stroke))
    motor = Actuator("motor", "shaft", ActuatorKind.VELOCITY, kv=0.5)
    robot = Robot(
        name,
        (block, crank, rod, piston),
        tuple(joints),
        actuators=(motor,),
        meshes=shop.sorted_meshes(),
        source=f"{name}.step",
    )
    if closing is JointKind.PRISMATIC:
        return closure(robot, "cylinder", closing, "block", "piston", X_WF, (1.0, 0.0, 0.0))
    return closure(robot, "wrist", closing, "rod", "piston", X_WF, Z)


def slider_crank() -> Robot:
    """A slider-crank closed at the pin of the piston."""
    return _slider_crank("slider_crank", JointKind.REVOLUTE)


def sliding_closure() -> Robot:
    """A slider-crank closed at the cylinder of the piston."""
    return _slider_crank("sliding_closure", JointKind.PRISMATIC)


def welded() -> Robot:
    """A four-bar whose rocker consists of two halves, welded by the closure."""
    shop = Workshop()
    drawn = math.pi / 3
    coupler, rocker = four_bar_angles(drawn)
    links = (
        shop.link("ground", [((GROUND + 0.06, 0.05, 0.01), at(x=GROUND / 2, z=-0.05))]),
        shop.link("crank", [((CRANK, 0.02, 0.01), at(x=CRANK / 2))], rgba=ORANGE),
        shop.link("coupler", [((COUPLER, 0.02, 0.01), at(x=COUPLER / 2, z=0.03))]),
        shop.link("upper_half", [((ROCKER / 2, 0.02, 0.01), at(x=-ROCKER / 4, z=0.06))], rgba=STEEL),
        shop.link("lower_half", [((ROCKER / 2 - 0.01, 0.02, 0.01), at(x=ROCKER / 4, z=0.06))], rgba=GLASS),
    )
    joints = (
        Joint("crank_pin", JointKind.CONTINUOUS, "ground", "crank", at(rpy=(0, 0, drawn))),
        Joint("coupler_pin", JointKind.CONTINUOUS, "crank", "coupler", at(x=CRANK, rpy=(0, 0, coupler - drawn))),
        Joint("rocker_pin", JointKind.CONTINUOUS, "coupler", "upper_half", at(COUPLER, rpy=(0, 0, rocker - coupler))),
        Joint("ground_pin", JointKind.CONTINUOUS, "ground", "lower_half", at(x=GROUND, rpy=(0, 0, rocker))),
    )
    drive = Actuator("drive", "crank_pin", ActuatorKind.VELOCITY, kv=0.5)
    robot = Robot("welded", links, joints, actuators=(drive,), meshes=shop.sorted_meshes(), source="welded.step")
    middle = at(x=GROUND, rpy=(0, 0, rocker)) @ at(x=ROCKER / 2)
    return closure(robot, "weld", JointKind.FIXED, "upper_half", "lower_half", middle, Z)


BASE_RADIUS, PLATFORM_RADIUS, HEIGHT = 0.3, 0.18, 0.35
"""Circles [m] of the joints of the Stewart platform, and the height that it is drawn at."""


def stewart_anchors() -> tuple[Array, Array]:
    """Feet of the legs on the base, and their heads on the platform, each (6, 3) [m] in the frame of its link."""
    feet, heads = [], []
    for leg in range(6):
        pair, side = divmod(leg, 2)
        at_base = 2 * math.pi / 3 * pair + (0.2 if side else -0.2)
        at_platform = 2 * math.pi / 3 * pair + (math.pi / 3 - 0.25) * (1 if side else -1)
        feet.append((BASE_RADIUS * math.cos(at_base), BASE_RADIUS * math.sin(at_base), 0.0))
        heads.append((PLATFORM_RADIUS * math.cos(at_platform), PLATFORM_RADIUS * math.sin(at_platform), 0.0))
    return np.array(feet), np.array(heads)


def stewart() -> Robot:
    """Six legs, each with a universal foot, a driven slide and a ball head; the first head is in the tree."""
    shop = Workshop()
    feet, heads = stewart_anchors()
    X_WP = at(z=HEIGHT)
    links = [shop.link("base", [((0.7, 0.7, 0.02), at(z=-0.08))])]
    joints, drives = [], []
    for leg, (foot, head) in enumerate(zip(feet, heads, strict=True), start=1):
        along = X_WP.apply(head) - foot
        length = float(np.linalg.norm(along))
        X_WL = Pose.of(perpendicular_frame(along / length), foot)
        links += [
            shop.link(f"cylinder_{leg}", [((0.02, 0.03, 0.12), at(z=0.1))]),
            shop.link(f"rod_{leg}", [((0.01, 0.012, 0.12), at(z=-0.1))], rgba=ORANGE),
        ]
        joints += [
            Joint(
                f"foot_{leg}", JointKind.UNIVERSAL, "base", f"cylinder_{leg}", X_WL, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
            ),
            Joint(
                f"leg_{leg}",
                JointKind.PRISMATIC,
                f"cylinder_{leg}",
                f"rod_{leg}",
                at(z=length),
                limit=Limit(-0.06, 0.06),
            ),
        ]
        drives.append(Actuator(f"drive_{leg}", f"leg_{leg}", ActuatorKind.POSITION, kp=5000.0, kv=100.0))
        if leg == 1:
            links.append(shop.link("platform", [((0.3, 0.25, 0.02), at(z=0.05, x=0.01))], rgba=GLASS))
            X_RP = (X_WL @ at(z=length)).inverse() @ X_WP @ Pose.of(np.eye(3), head)
            joints.append(Joint("head_1", JointKind.BALL, "rod_1", "platform", X_RP))
    # The platform's frame is that of the ball above it, at the first head; its body is relative to that frame.
    robot = Robot(
        "stewart", tuple(links), tuple(joints), actuators=tuple(drives), meshes=shop.sorted_meshes(), source="s.step"
    )
    for leg in range(2, 7):
        X_WF = Pose.of(np.eye(3), X_WP.apply(heads[leg - 1]))
        robot = closure(robot, f"head_{leg}", JointKind.BALL, f"rod_{leg}", "platform", X_WF, Z)
    return robot


DELTA_BASE, DELTA_PLATFORM, UPPER, FORE = 0.2, 0.06, 0.18, 0.35
"""Radius [m] of the shoulders and of the platform's joints, lengths of upper and fore arms of the delta."""
HALF_WIDTH = 0.03
"""Half the distance [m] between the two rods of a forearm."""
DELTA_DRAWN = 0.3
"""Angle [rad] of the upper arms below the horizontal as drawn."""


def delta_height(angle: float) -> float:
    """Depth [m] of the platform below the base with all upper arms at the same angle."""
    gap = DELTA_BASE + UPPER * math.cos(angle) - DELTA_PLATFORM
    return UPPER * math.sin(angle) + math.sqrt(FORE**2 - gap**2)


def delta_angle(arm: int, position: Array) -> float:
    """Inverse kinematics: angle [rad] of an upper arm for the platform's centre [m], its elbow outside."""
    azimuth = 2 * math.pi / 3 * arm
    turned = at(rpy=(0, 0, -azimuth)).apply(position)
    x, y, z = float(turned[0]) + DELTA_PLATFORM - DELTA_BASE, float(turned[1]), float(-turned[2])
    # (x - U cos a)^2 + y^2 + (z - U sin a)^2 = F^2, so x cos a + z sin a = k
    k = (x * x + y * y + z * z + UPPER**2 - FORE**2) / (2 * UPPER)
    return math.atan2(z, x) - math.acos(k / math.hypot(x, z))


def delta() -> Robot:
    """Three driven arms, six rods with universal and ball ends; in the tree the platform is on the first rod."""
    shop = Workshop()
    links = [shop.link("base", [((0.5, 0.5, 0.02), at(z=0.08))])]
    joints, drives, ends = [], [], []
    below = delta_height(DELTA_DRAWN)
    for arm in range(3):
        X_WS = at(rpy=(0, 0, 2 * math.pi / 3 * arm)) @ at(x=DELTA_BASE, rpy=(0, DELTA_DRAWN, 0))
        links.append(shop.link(f"arm_{arm}", [((UPPER - 0.02, 0.02, 0.02), at(x=UPPER / 2))], rgba=ORANGE))
        joints.append(
            Joint(
                f"shoulder_{arm}", JointKind.REVOLUTE, "base", f"arm_{arm}", X_WS, Y, limit=Limit(-0.6, 0.6, 5.0, 20.0)
            )
        )
        drives.append(Actuator(f"drive_{arm}", f"shoulder_{arm}", ActuatorKind.POSITION, kp=100.0, kv=5.0))
        for side, y in (("left", HALF_WIDTH), ("right", -HALF_WIDTH)):
            rod = f"rod_{arm}_{side}"
            end = at(rpy=(0, 0, 2 * math.pi / 3 * arm)).apply((DELTA_PLATFORM, y, 0.0)) + np.array((0, 0, -below))
            elbow = X_WS.apply((UPPER, y, 0.0))
            X_WR = Pose.of(perpendicular_frame((end - elbow) / FORE), elbow)
            links.append(shop.link(rod, [((0.008, 0.01, FORE - 0.05), at(z=FORE / 2))]))
            joints.append(
                Joint(f"elbow_{arm}_{side}", JointKind.UNIVERSAL, f"arm_{arm}", rod, X_WS.inverse() @ X_WR, vector3(Y))
            )
            ends.append((rod, end))
            if len(ends) == 1:
                links.append(shop.link("platform", [((0.1, 0.1, 0.01), at(x=-0.05, z=-0.03))], rgba=GLASS))
                X_RP = X_WR.inverse() @ Pose.of(np.eye(3), end)
                joints.append(Joint("wrist", JointKind.BALL, rod, "platform", X_RP))
    robot = Robot(
        "delta", tuple(links), tuple(joints), actuators=tuple(drives), meshes=shop.sorted_meshes(), source="d.step"
    )
    for rod, end in ends[1:]:
        name = rod.replace("rod", "wrist")
        robot = closure(robot, name, JointKind.BALL, rod, "platform", Pose.of(np.eye(3), end), Z)
    return robot


CLOSED: dict[str, Callable[[], Robot]] = {
    build.__name__: build for build in (slider_crank, sliding_closure, welded, stewart, delta)
}
