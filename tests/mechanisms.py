"""A robot in memory for each kind of joint beyond one axis, and for each coupling of joints."""

import math
from collections.abc import Callable

from stepbot.geometry.spatial import vector3
from stepbot.robot.model import Base, Joint, JointDynamics, JointKind, Limit, Mimic, Robot
from tests.workshop import ORANGE, Workshop, at

TILTED = vector3((2 / 3, -1 / 3, 2 / 3))
PITCH = 0.002 / (2 * math.pi)
"""Advance [m/rad] of the screw: 2 mm per turn."""
SLANT = vector3((0.6, 0.0, 0.8))


def _robot(name: str, joint: Joint, base: Base = Base.FIXED) -> Robot:
    """A post, a body on the joint, and an arm that turns on that body, which couples all coordinates."""
    shop = Workshop()
    post = shop.link("post", [((0.1, 0.1, 0.02), at(z=-0.4))])
    body = shop.link("body", [((0.12, 0.05, 0.03), at(0.15, 0.02, -0.07, (0.3, 0.2, 0.5)))], rgba=ORANGE)
    arm = shop.link("arm", [((0.03, 0.02, 0.1), at(0.01, 0.02, -0.07, (0.2, 0, 0.1)))])
    hinge = Joint(
        "hinge", JointKind.REVOLUTE, "body", "arm", at(0.3, 0, -0.1, (0.1, 0.2, 0.3)), limit=Limit(-1.0, 2.0, 3.0, 4.0)
    )
    links, meshes = (post, body, arm), shop.sorted_meshes()
    return Robot(name, links, (joint, hinge), base=base, meshes=meshes, source=f"{name}.step")


def _joint(name: str, kind: JointKind, **more: object) -> Joint:
    return Joint(name, kind, "post", "body", at(1 / 30, 0.02, 0.1, (0.3, -0.2, 0.7)), **more)  # type: ignore[arg-type]


def ball() -> Robot:
    """A ball joint with damping and armature."""
    forces = JointDynamics(damping=0.02, friction=0.001, armature=1e-4)
    return _robot("ball", _joint("shoulder", JointKind.BALL, limit=Limit(velocity=4.0, effort=3.0), dynamics=forces))


def universal() -> Robot:
    """A universal joint whose axes are not at right angles to those of its frame."""
    forces = JointDynamics(damping=0.01, armature=2e-4)
    limit = Limit(velocity=4.0, effort=3.0)
    joint = _joint(
        "cross", JointKind.UNIVERSAL, axis=SLANT, axis2=vector3((0.8, 0.0, -0.6)), limit=limit, dynamics=forces
    )
    return _robot("universal", joint)


def cylindrical() -> Robot:
    """A body on a cylindrical joint with a slanted axis."""
    return _robot("cylindrical", _joint("sleeve", JointKind.CYLINDRICAL, axis=TILTED))


def screw() -> Robot:
    """A screw with limits and friction, drawn away from 0, followed by the hinge behind it."""
    limit = Limit(-20.0, 30.0, velocity=50.0, effort=2.0)
    forces = JointDynamics(damping=0.001, friction=0.002)
    spindle = _joint(
        "spindle", JointKind.SCREW, axis=TILTED, pitch=PITCH, limit=limit, dynamics=forces, drawn_position=1.5
    )
    robot = _robot("screw", spindle)
    hinge = robot.joint_by_name["hinge"]
    follows = Joint(
        hinge.name,
        hinge.kind,
        hinge.parent,
        hinge.child,
        hinge.X_PC,
        limit=hinge.limit,
        mimic=Mimic("spindle", 1 / 40, 0.2),
        drawn_position=1.5 / 40 + 0.2,
    )
    return Robot(robot.name, robot.links, (spindle, follows), meshes=robot.meshes, source=robot.source)


def left_screw() -> Robot:
    """A left-handed screw without limits on a floating base."""
    return _robot("left_screw", _joint("spindle", JointKind.SCREW, axis=SLANT, pitch=-10 * PITCH), Base.FLOATING)


def planar() -> Robot:
    """A body on a planar joint with a slanted plane."""
    return _robot("planar", _joint("table", JointKind.PLANAR, axis=TILTED))


def floating() -> Robot:
    """A free body."""
    return _robot("floating", _joint("free", JointKind.FLOATING))


def one_sided() -> Robot:
    """A hinge without upper limit behind a slide without lower limit, both with springs and armature."""
    slide = _joint(
        "slide",
        JointKind.PRISMATIC,
        axis=SLANT,
        limit=Limit(-math.inf, 0.2),
        dynamics=JointDynamics(stiffness=300.0, spring_reference=-1 / 30, damping=2.0, armature=0.02),
    )
    robot = _robot("one_sided", slide)
    hinge = Joint(
        "hinge",
        JointKind.REVOLUTE,
        "body",
        "arm",
        at(0.3, 0, -0.1, (0.1, 0.2, 0.3)),
        limit=Limit(-1.0, math.inf, effort=4.0),
        dynamics=JointDynamics(stiffness=0.7, spring_reference=0.3, armature=1e-3),
    )
    return Robot(robot.name, robot.links, (slide, hinge), meshes=robot.meshes, source=robot.source)


def gear() -> Robot:
    """A pinion, a wheel that turns at minus a third of its speed, and a hand that follows the wheel."""
    shop = Workshop()
    links = (
        shop.link("frame", [((0.2, 0.1, 0.01), at(z=-0.02))]),
        shop.link("pinion", [((0.01, 0.01, 0.02), at(x=0.03, z=0.1))], [(0.02, 0.01, at())], ORANGE),
        shop.link("wheel", [((0.01, 0.01, 0.02), at(x=0.04, z=0.1))], [(0.06, 0.01, at())]),
        shop.link("hand", [((0.1, 0.01, 0.01), at(x=0.04, z=0.2))]),
    )
    limit = Limit(-6.0, 6.0, velocity=10.0, effort=5.0)
    joints = (
        Joint("drive", JointKind.REVOLUTE, "frame", "pinion", at(x=-0.04), limit=limit),
        Joint(
            "driven",
            JointKind.REVOLUTE,
            "frame",
            "wheel",
            at(x=0.04, rpy=(0.01, 0, 0)),
            limit=limit,
            mimic=Mimic("drive", -1 / 3, 0.1),
            drawn_position=0.1,
        ),
        Joint(
            "pointer",
            JointKind.REVOLUTE,
            "frame",
            "hand",
            at(y=0.1),
            limit=limit,
            mimic=Mimic("driven", 2.0, -0.3),
            drawn_position=-0.1,
        ),
    )
    return Robot("gear", links, joints, meshes=shop.sorted_meshes(), source="gear.step")


MECHANISMS: dict[str, Callable[[], Robot]] = {
    build.__name__: build
    for build in (ball, universal, cylindrical, screw, left_screw, planar, floating, one_sided, gear)
}
