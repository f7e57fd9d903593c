"""Named robots in memory for tests: real meshes, full inertias, no round or aligned values.

Lengths such as 1/3 have no finite decimal text, so that a lost digit is detected. ``ROBOTS`` maps names to functions
that build them; each call returns a new robot with the same content.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Pose, rotation_about
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Base,
    Box,
    Capsule,
    Collision,
    Cylinder,
    Frame,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    LoopClosure,
    MeshAsset,
    MeshRef,
    Mimic,
    Rgba,
    Robot,
    Sphere,
    Visual,
)
from tests.closed_mechanisms import CLOSED, COUPLER, CRANK, GROUND, ROCKER, four_bar_angles
from tests.devices import equipped
from tests.mechanisms import MECHANISMS
from tests.workshop import GLASS, ORANGE, STEEL, Workshop, at


def one_link() -> Robot:
    """A tilted box without a joint."""
    shop = Workshop()
    base = shop.link("base", [((0.2, 0.1, 1 / 30), at(1 / 30, 0, 0.05, (0.3, 0.2, 0.1)))])
    return Robot("one_link", (base,), meshes=shop.sorted_meshes(), source="one_link.step")


def pendulum() -> Robot:
    """A rod on a continuous joint with a horizontal axis."""
    shop = Workshop()
    base = shop.link("base", [((0.1, 0.1, 0.02), at(z=-0.06))])
    bob = shop.link(
        "bob",
        [((0.04, 0.02, 0.06), at(x=0.31, rpy=(0.5, 0, 0.2)))],
        [(0.006, 0.28, at(x=0.15, rpy=(0, math.pi / 2, 0)))],
        ORANGE,
    )
    swing = Joint(
        "swing",
        JointKind.CONTINUOUS,
        "base",
        "bob",
        at(z=1 / 30, rpy=(-math.pi / 2, 0, 0)),
        dynamics=JointDynamics(damping=1 / 300),
    )
    return Robot("pendulum", (base, bob), (swing,), meshes=shop.sorted_meshes(), source="pendulum.step")


def two_link_arm() -> Robot:
    """Two revolute joints with limits and dynamics, a motor on each, a tool frame, an elbow drawn bent."""
    shop = Workshop()
    base = shop.link("base", [((0.12, 0.12, 0.04), at(z=0.02))], [(0.03, 0.06, at(z=0.07))])
    upper = shop.link("upper_arm", [((0.3, 0.03, 0.04), at(x=0.15, y=0.01, rpy=(0.1, 0, 0)))], rgba=ORANGE)
    fore = shop.link(
        "forearm", [((0.2, 0.02, 0.03), at(x=0.13, z=0.05, rpy=(0, 0.15, 0.05)))], [(0.015, 0.05, at(x=0.2, z=0.02))]
    )
    joints = (
        Joint(
            "shoulder",
            JointKind.REVOLUTE,
            "base",
            "upper_arm",
            at(0, 0, 0.13, (0.1, -0.2, 1 / 3)),
            limit=Limit(-math.pi / 3, 2 * math.pi / 3, velocity=math.pi, effort=12.5),
            dynamics=JointDynamics(damping=0.05, friction=1 / 70, armature=0.003),
        ),
        Joint(
            "elbow",
            JointKind.REVOLUTE,
            "upper_arm",
            "forearm",
            at(1 / 3, 0, 0, (math.pi, 0, -0.4)),
            axis=(0.0, 0.6, 0.8),
            limit=Limit(-2.0, 2.25, velocity=2.0, effort=8.0),
            dynamics=JointDynamics(damping=0.02),
            drawn_position=math.pi / 6,
        ),
    )
    return Robot(
        "two_link_arm",
        (base, upper, fore),
        joints,
        frames=(
            Frame("tool0", "forearm", at(0.25, 0, 0.05, (0.2, math.pi / 2, 0.3))),
            Frame("camera", "base", at(z=0.3)),
        ),
        actuators=(
            Actuator("shoulder_motor", "shoulder", ActuatorKind.POSITION, kp=100.0, kv=5.0),
            Actuator("elbow_motor", "elbow", ActuatorKind.MOTOR, gear=20.0),
        ),
        meshes=shop.sorted_meshes(),
        source="two_link_arm.step",
    )


def _four_bar(name: str, zeros: bool) -> Robot:
    """A planar four-bar in its drawn pose, with the crank at 60 degrees.

    Args:
        name: Name of the robot.
        zeros: Whether q counts from the ground line, so that the drawn pose is not q = 0.
    """
    shop = Workshop()
    drawn_crank = math.pi / 3
    drawn_coupler, drawn_rocker = four_bar_angles(drawn_crank)

    def bar(link: str, length: float, rgba: Rgba) -> Link:
        return shop.link(
            link, [((length + 0.02, 0.02, 0.01), at(x=length / 2))], [(0.008, 0.006, at(x=length / 3, z=-0.008))], rgba
        )

    ground = shop.link("ground", [((GROUND + 0.06, 0.05, 0.01), at(x=GROUND / 2))])
    links = (ground, bar("crank", CRANK, ORANGE), bar("coupler", COUPLER, STEEL), bar("rocker", ROCKER, GLASS))

    def pin(joint: str, parent: str, child: str, x: float, z: float, turn: float, q: float) -> Joint:
        drawn = at(x, 0, z, (0, 0, turn))
        X_PC = drawn @ Pose.of(rotation_about((0, 0, 1), -q)) if zeros else drawn
        return Joint(joint, JointKind.CONTINUOUS, parent, child, X_PC, drawn_position=q if zeros else 0.0)

    joints = (
        pin("crank_pin", "ground", "crank", 0, 0.03, drawn_crank, drawn_crank),
        pin("coupler_pin", "crank", "coupler", CRANK, 0.03, drawn_coupler - drawn_crank, drawn_coupler - drawn_crank),
        pin("ground_pin", "ground", "rocker", GROUND, 0.03, drawn_rocker, drawn_rocker),
    )
    X_WC = at(0, 0, 0.03, (0, 0, drawn_crank)) @ at(CRANK, 0, 0.03, (0, 0, drawn_coupler - drawn_crank))
    X_WR = at(GROUND, 0, 0.03, (0, 0, drawn_rocker))
    X_WF = Pose.of(np.eye(3), X_WC.apply((COUPLER, 0, -0.015)))
    closure = LoopClosure(
        "rocker_pin", JointKind.REVOLUTE, "coupler", X_WC.inverse() @ X_WF, "rocker", X_WR.inverse() @ X_WF
    )
    return Robot(
        name,
        links,
        joints,
        (closure,),
        actuators=(Actuator("crank_motor", "crank_pin", ActuatorKind.VELOCITY, kv=0.5),),
        meshes=shop.sorted_meshes(),
        source=f"{name}.step",
    )


def four_bar() -> Robot:
    """A planar four-bar, closed at q = 0."""
    return _four_bar("four_bar", zeros=False)


def crooked_four_bar(tilt: float) -> Robot:
    """The four-bar linkage with one pin tilted by an angle [rad], closed in the drawn pose."""
    robot = four_bar()
    (closure,) = robot.closures
    tilted = Pose.of(rotation_about((1, 0, 0), tilt))
    joints = tuple(
        replace(joint, X_PC=joint.X_PC @ tilted) if joint.name == "coupler_pin" else joint for joint in robot.joints
    )
    bare = replace(robot, joints=joints)
    X_W = link_poses(bare, initial_configuration(bare))
    return replace(bare, closures=(replace(closure, X_BF=X_W["rocker"].inverse() @ X_W["coupler"] @ closure.X_AF),))


def four_bar_with_zeros() -> Robot:
    """The same four-bar with all q counted from the ground line: it is not closed at q = 0."""
    return _four_bar("four_bar_with_zeros", zeros=True)


def gripper_with_mimic() -> Robot:
    """A wrist, a driven finger, a mimic of it, and a thumb that mimics the mimic, with a multiplier and an offset."""
    shop = Workshop()
    palm = shop.link("palm", [((0.1, 0.04, 0.05), at(z=-0.03))])
    size = (0.01, 0.03, 0.08)
    left = shop.link("left_finger", [(size, at(x=0.005, z=0.045, rpy=(0, 0.05, 0)))], rgba=ORANGE)
    right = shop.link("right_finger", [(size, at(x=0.005, z=0.045, rpy=(0, 0.05, 0)))], rgba=ORANGE)
    thumb = shop.link("thumb", [((0.02, 0.01, 0.05), at(z=0.03, rpy=(0.1, 0, 0)))])
    stroke = Limit(0.0, 0.03, velocity=0.1, effort=20.0)
    joints = (
        Joint("finger", JointKind.PRISMATIC, "palm", "left_finger", at(x=0.01), (1.0, 0.0, 0.0), limit=stroke),
        Joint(
            "finger_mirrored",
            JointKind.PRISMATIC,
            "palm",
            "right_finger",
            at(x=-0.01, rpy=(0, 0, math.pi)),
            (1.0, 0.0, 0.0),
            limit=stroke,
            mimic=Mimic("finger"),
        ),
        Joint(
            "thumb_pivot",
            JointKind.REVOLUTE,
            "palm",
            "thumb",
            at(y=0.04, rpy=(0, math.pi / 2, 0)),
            limit=Limit(-1.0, 1.0, velocity=1.0, effort=2.0),
            mimic=Mimic("finger_mirrored", multiplier=-100 / 7, offset=0.1),
            drawn_position=0.1,
        ),
    )
    return Robot(
        "gripper_with_mimic",
        (palm, left, right, thumb),
        joints,
        actuators=(Actuator("grip", "finger", ActuatorKind.POSITION, kp=500.0, kv=10.0),),
        meshes=shop.sorted_meshes(),
        source="gripper.step",
    )


def slider() -> Robot:
    """A carriage on a spring, limited on one side only, and a ram without effort or velocity limit."""
    shop = Workshop()
    rail = shop.link("rail", [((0.5, 0.03, 0.02), at(rpy=(0.1, 0, 0)))])
    carriage = shop.link("carriage", [((0.08, 0.06, 0.03), at(z=0.04))], rgba=ORANGE)
    ram = shop.link("ram", rods=[(0.01, 0.1, at(z=0.06))])
    axis = (2 / 3, -1 / 3, 2 / 3)
    joints = (
        Joint(
            "slide",
            JointKind.PRISMATIC,
            "rail",
            "carriage",
            at(-0.1, 0, 0, (0, 0.2, 0)),
            axis,
            limit=Limit(-math.inf, 0.25, velocity=0.5, effort=30.0),
            dynamics=JointDynamics(damping=3.0, friction=0.5, stiffness=200.0, spring_reference=-0.05),
        ),
        Joint("lift", JointKind.PRISMATIC, "carriage", "ram", at(z=0.06), limit=Limit(-0.02, 0.1)),
    )
    return Robot("slider", (rail, carriage, ram), joints, meshes=shop.sorted_meshes(), source="slider.step")


def tree() -> Robot:
    """Two branches with fixed joints, rotated through gimbal lock, and a massless flange."""
    shop = Workshop()
    base = shop.link("base", [((0.2, 0.2, 0.02), at())])
    post = shop.link("post", rods=[(0.02, 0.2, at(z=0.12, rpy=(0.02, 0, 0)))])
    arms = [
        shop.link(f"{side}_arm", [((0.15, 0.02, 0.02), at(x=0.13, rpy=(0.2, 0.1, 0)))], rgba=ORANGE)
        for side in ("left", "right")
    ]
    flange = Link("flange")
    tip = shop.link("tip", [((0.02, 0.01, 0.03), at(z=0.04, rpy=(0.1, 0.2, 0.3)))])
    limit = Limit(-1.0, 1.5, velocity=3.0, effort=5.0)
    joints = (
        Joint("base_to_post", JointKind.FIXED, "base", "post", at(0.01, 0.02, 0.01, (0, 0, math.pi / 4))),
        Joint(
            "left_pivot", JointKind.REVOLUTE, "post", "left_arm", at(0.03, 0, 0.2, (0.3, math.pi / 2, 0.7)), limit=limit
        ),
        Joint(
            "right_pivot",
            JointKind.REVOLUTE,
            "post",
            "right_arm",
            at(-0.03, 0, 0.2, (1.0, -math.pi / 2, 0.2)),
            (0.0, -1.0, 0.0),
            limit=limit,
        ),
        Joint("left_to_flange", JointKind.FIXED, "left_arm", "flange", at(0.22, 0, 0, (0, math.pi / 2 - 1e-9, 0.5))),
        Joint("flange_to_tip", JointKind.FIXED, "flange", "tip", at(0, 0, 0.01, (-2.0, 0.4, 3.0))),
    )
    return Robot("tree", (base, post, *arms, flange, tip), joints, meshes=shop.sorted_meshes(), source="tree.step")


def floating_biped() -> Robot:
    """A floating trunk with a hip and a knee on either side."""
    shop = Workshop()
    links = [shop.link("trunk", [((0.1, 0.2, 0.15), at(z=0.1, rpy=(0, 0.1, 0)))])]
    joints = []
    for side, y in (("left", 0.08), ("right", -0.08)):
        links += [
            shop.link(f"{side}_thigh", [((0.03, 0.03, 0.2), at(z=-0.12, rpy=(0, 0.05, 0)))], rgba=ORANGE),
            shop.link(f"{side}_shin", [((0.02, 0.03, 0.2), at(z=-0.12)), ((0.1, 0.05, 0.01), at(x=0.02, z=-0.225))]),
        ]
        joints += [
            Joint(
                f"{side}_hip",
                JointKind.REVOLUTE,
                "trunk",
                f"{side}_thigh",
                at(0, y, 0, (0, 0, y)),
                (0.0, 1.0, 0.0),
                limit=Limit(-1.2, 0.8, velocity=9.0, effort=40.0),
            ),
            Joint(
                f"{side}_knee",
                JointKind.REVOLUTE,
                f"{side}_thigh",
                f"{side}_shin",
                at(z=-0.24),
                (0.0, 1.0, 0.0),
                limit=Limit(0.0, 2.5, velocity=9.0, effort=40.0),
                dynamics=JointDynamics(armature=0.01),
            ),
        ]
    return Robot(
        "floating_biped",
        tuple(links),
        tuple(joints),
        base=Base.FLOATING,
        meshes=shop.sorted_meshes(),
        source="biped.step",
    )


def odd_names() -> Robot:
    """Names with spaces, dots, commas and non-ASCII letters, and a joint named like a link."""
    shop = Workshop()
    base = shop.link("Grundplatte groß", [((0.1, 0.1, 0.02), at())])
    middle = shop.link("звено 1,5", [((0.02, 0.02, 0.1), at(z=0.07, rpy=(0, 0.1, 0)))])
    end = shop.link("末端", [((0.02, 0.03, 0.1), at(z=0.07, x=0.01))], rgba=GLASS)
    limit = Limit(-1.0, 1.0, velocity=1.0, effort=1.0)
    joints = (
        Joint(
            "joint no. 1", JointKind.REVOLUTE, "Grundplatte groß", "звено 1,5", at(z=0.02), (1.0, 0.0, 0.0), limit=limit
        ),
        Joint("末端", JointKind.REVOLUTE, "звено 1,5", "末端", at(z=0.13), (0.0, 1.0, 0.0), limit=limit),
    )
    return Robot(
        "Röhren-Roboter 7",
        (base, middle, end),
        joints,
        frames=(Frame("Werkzeug (rechts)", "末端", at(z=0.2)),),
        actuators=(Actuator("joint no. 1", "joint no. 1", ActuatorKind.MOTOR),),
        meshes=shop.sorted_meshes(),
        source="Röhren -- Roboter.step",
    )


def primitives() -> Robot:
    """Every kind of geometry, as visual and as collision, and a flat sheet as a visual only."""
    shop = Workshop()
    base = shop.link("base", [((0.3, 0.3, 0.02), at())])
    shapes = {
        "box": Box((0.04, 0.05, 1 / 15)),
        "cylinder": Cylinder(0.02, 0.06),
        "sphere": Sphere(0.03),
        "capsule": Capsule(0.015, 0.05),
    }
    poses = [at(x, y, 0.1, (0.3, 0.4, x)) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    sheet = MeshAsset("sheet", TriMesh.of([(0, 0, 0), (0.1, 0, 0), (0.1, 0.1, 0), (0, 0.1, 0)], [(0, 1, 2), (0, 2, 3)]))
    patch = MeshAsset("patch", TriMesh.of([(0, 0, 0.05), (0.05, 0, 0.05), (0, 0.05, 0.05)], [(0, 1, 2)]))
    turret = Link(
        "turret",
        MassProperties.of(0.7, (0.01, -0.02, 0.1), [[3e-3, 1e-4, -2e-4], [1e-4, 4e-3, 1e-4], [-2e-4, 1e-4, 5e-3]]),
        (
            *(
                Visual(f"{name} seen", shape, X_LG, ORANGE)
                for (name, shape), X_LG in zip(shapes.items(), poses, strict=True)
            ),
            Visual("sheet seen", MeshRef("sheet"), at(z=0.2, rpy=(0.1, 0, 0)), GLASS),
            Visual("patch seen", MeshRef("patch"), at(z=0.2)),
        ),
        tuple(
            Collision(f"{name} touched", shape, X_LG) for (name, shape), X_LG in zip(shapes.items(), poses, strict=True)
        ),
    )
    turn = Joint(
        "turn", JointKind.REVOLUTE, "base", "turret", at(z=0.05, rpy=(0, 0, 1.0)), limit=Limit(-3.0, 3.0, 2.0, 4.0)
    )
    meshes = tuple(sorted((*shop.meshes, sheet, patch), key=lambda asset: asset.name))
    return Robot("primitives", (base, turret), (turn,), meshes=meshes, source="primitives.step")


ROBOTS: dict[str, Callable[[], Robot]] = (
    {
        build.__name__: build
        for build in (
            one_link,
            pendulum,
            two_link_arm,
            four_bar,
            four_bar_with_zeros,
            gripper_with_mimic,
            slider,
            tree,
            floating_biped,
            odd_names,
            primitives,
            equipped,
        )
    }
    | MECHANISMS
    | CLOSED
)

every_robot = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long) if name == "stewart" else name for name in ROBOTS]
)
"""Run a test with each robot; with the one of most parts in `make test-long`: the delta robot closes on balls, too."""

_ONE_FREEDOM = {JointKind.FIXED, JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.PRISMATIC}
SINGLE_FREEDOMS = tuple(
    name for name, build in ROBOTS.items() if {joint.kind for joint in build().joints} <= _ONE_FREEDOM
)
"""Robots with revolute and prismatic joints only, which every format and reader supports."""
