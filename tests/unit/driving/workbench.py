"""Robots with closed-form behaviour, written as files and driven in an engine."""

from collections.abc import Callable
from math import sqrt
from pathlib import Path

from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.driving.mechanism import finger_candidates, jaw_candidates, limbs_of, mechanism_of, wheels_of
from stepbot.driving.stage import Stage
from stepbot.driving.survey import survey
from stepbot.engines.mujoco.simulation import MujocoSimulation
from stepbot.engines.pybullet.simulation import PybulletSimulation
from stepbot.engines.simulation import Setup, Simulation
from stepbot.formats.rendering import render
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.report.document import report_bytes
from stepbot.report.robot import Content, Report, WrittenFile
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Box,
    Collision,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    LoopClosure,
    Mimic,
    Robot,
)
from stepbot.robot.pybullet_closures import loop_constraints

ENGINES = ("mujoco", "pybullet")
HORIZONTAL, VERTICAL = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def body(mass: float, com: tuple[float, float, float] = (0.0, 0.0, 0.0), inertia: float = 1e-3) -> MassProperties:
    """Mass properties with equal moments of inertia."""
    return MassProperties(mass, com, ((inertia, 0.0, 0.0), (0.0, inertia, 0.0), (0.0, 0.0, inertia)))


def one_joint(axis: tuple[float, float, float], kp: float = 0.0, kv: float = 0.0, effort: float = 1e3) -> Robot:
    """A body of 1 kg at 0.5 m from a joint, with 0.05 kg m^2 about its centre; its actuator if there are gains."""
    arm = Link("arm", body(1.0, (0.5, 0.0, 0.0), 0.05))
    joint = Joint(
        "turn",
        JointKind.REVOLUTE,
        "base",
        "arm",
        axis=axis,
        limit=Limit(-4.0, 4.0, velocity=50.0, effort=effort),
        dynamics=JointDynamics(),
    )
    actuators = (Actuator("drive", "turn", ActuatorKind.POSITION, kp=kp, kv=kv),) if kp else ()
    return Robot("one_joint", (Link("base", body(1.0)), arm), (joint,), actuators=actuators)


def gripper(effort: float) -> Robot:
    """Two flat fingers of 40 x 60 mm, 60 mm apart when open, closed by a motor of some force [N]."""
    links = [Link("hand", body(0.5))]
    for name in ("left", "right"):
        face = Collision(f"{name}_face", Box((0.01, 0.04, 0.06)), Pose.of(position=(0.005, 0.0, 0.13)))
        links.append(Link(name, body(0.05, (0.0, 0.0, 0.13), 1e-5), collisions=(face,)))
    stroke = Limit(0.0, 0.03, velocity=0.5, effort=effort)
    half_turn = Pose.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, 3.141592653589793))
    damping = JointDynamics(damping=1.0)
    along = (1.0, 0.0, 0.0)
    joints = (
        Joint("slide", JointKind.PRISMATIC, "hand", "left", axis=along, limit=stroke, dynamics=damping),
        Joint(
            "mirror",
            JointKind.PRISMATIC,
            "hand",
            "right",
            half_turn,
            along,
            limit=stroke,
            dynamics=damping,
            mimic=Mimic("slide"),
        ),
    )
    motor = Actuator("motor", "slide", ActuatorKind.POSITION, kp=2000.0, kv=50.0)
    return Robot("gripper", tuple(links), joints, actuators=(motor,))


def clamp(effort: float, *, slides: bool = False, X_BH: Pose = IDENTITY) -> Robot:
    """A jaw that closes on a plate of its hand, both 40 x 80 mm: turned about a hinge, or slid.

    The plates are 24 mm apart and parallel at q = 0; the jaw closes towards negative positions.

    Args:
        effort: Limit [N m] or [N] of the motor.
        slides: Whether the joint is prismatic.
        X_BH: Pose of the hand on its base.
    """
    plate = Box((0.01, 0.04, 0.08))
    fixed = Collision("fixed", plate, Pose.of(position=(-0.005, 0.0, 0.08)))
    moving = Collision("moving", plate, Pose.of(position=(0.005, 0.0, 0.08)))
    hand = Link("hand", body(0.2), collisions=(fixed,))
    jaw = Link("jaw", body(0.05, (0.005, 0.0, 0.08), 5e-5), collisions=(moving,))
    kind, axis = (JointKind.PRISMATIC, (1.0, 0.0, 0.0)) if slides else (JointKind.REVOLUTE, HORIZONTAL)
    limit = Limit(-0.022, 0.03, velocity=0.2) if slides else Limit(-0.25, 1.2, velocity=4.0)
    dynamics = JointDynamics(damping=1.0, armature=0.1) if slides else JointDynamics(damping=0.02, armature=0.002)
    X_HJ = Pose.of(position=(0.024, 0.0, 0.0))
    joints = (
        Joint("mount", JointKind.FIXED, "base", "hand", X_BH),
        Joint("close", kind, "hand", "jaw", X_HJ, axis, limit=replace(limit, effort=effort), dynamics=dynamics),
    )
    kp, kv = (2000.0, 50.0) if slides else (20.0, 0.5)
    motor = Actuator("motor", "close", ActuatorKind.POSITION, kp=kp, kv=kv)
    return Robot("clamp", (Link("base", body(1.0)), hand, jaw), joints, actuators=(motor,))


def looped_gripper(effort: float) -> Robot:
    """Two jaws on one guide, 40 mm apart as drawn, that a crank of 20 mm opens and closes by rods of 40 mm.

    At an angle t of the crank, from its drawn one, each jaw's pin is at ``-a sin t + sqrt(l^2 - a^2 cos^2 t)`` from the
    axis of the crank, and its face 14.6 mm further inside.

    Args:
        effort: Limit [N m] of the motor.
    """
    crank, rod = 0.02, 0.04
    reach = sqrt(rod**2 - crank**2)
    links, joints, closures = [Link("rail", body(0.5)), Link("crank", body(0.05))], [], []
    limit = Limit(-1.3, 1.3, velocity=10.0, effort=effort)
    along, damping = (1.0, 0.0, 0.0), JointDynamics(damping=1.0)
    joints.append(Joint("turn", JointKind.REVOLUTE, "rail", "crank", axis=VERTICAL, limit=limit))
    for name, side, turn in (("right", 1.0, 0.0), ("left", -1.0, 3.141592653589793)):
        face = Collision(f"{name}_face", Box((0.01, 0.04, 0.06)), Pose.of(position=(-0.0096, 0.0, 0.13)))
        links += [
            Link(f"{name}_jaw", body(0.05, (0.0, 0.0, 0.13), 1e-5), collisions=(face,)),
            Link(f"{name}_rod", body(0.01, (-0.5 * reach, 0.0, 0.0), 1e-5)),
        ]
        X_RJ = Pose.from_xyz_rpy((side * reach, 0.0, 0.0), (0.0, 0.0, turn))
        guide = Limit(-0.03, 0.03)
        joints += [
            Joint(
                f"{name}_guide", JointKind.PRISMATIC, "rail", f"{name}_jaw", X_RJ, along, limit=guide, dynamics=damping
            ),
            Joint(
                f"{name}_pin", JointKind.REVOLUTE, f"{name}_jaw", f"{name}_rod", axis=VERTICAL, limit=Limit(-2.0, 2.0)
            ),
        ]
        ends = Pose.of(position=(-reach, crank, 0.0)), Pose.of(position=(0.0, side * crank, 0.0))
        closures.append(
            LoopClosure(f"{name}_end", JointKind.REVOLUTE, f"{name}_rod", ends[0], "crank", ends[1], VERTICAL)
        )
    motor = Actuator("motor", "turn", ActuatorKind.POSITION, kp=20.0, kv=0.5)
    return Robot("looped_gripper", tuple(links), tuple(joints), tuple(closures), actuators=(motor,))


def files_of(robot: Robot, folder: Path) -> dict[str, Path]:
    """The MJCF and the URDF of a robot, written."""
    paths = {}
    for name, engine in (("mjcf", "mujoco"), ("urdf", "pybullet")):
        for path, content in render(robot, name, Diagnostics()).items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_bytes(content)
            paths.setdefault(engine, folder / path)
    return paths


def written(robot: Robot, folder: Path) -> None:
    """Write a robot as ``stepbot convert`` does: its MJCF, its URDF and the report."""
    names = {"mujoco": "mjcf", "pybullet": "urdf"}
    files = tuple(
        WrittenFile(path.name, names[engine], Content.ROBOT) for engine, path in files_of(robot, folder).items()
    )
    (folder / "report.json").write_bytes(report_bytes(Report(robot=robot, files=files), ()))


def stage_of(robot: Robot, engine: str, folder: Path) -> Stage:
    """A robot in an engine, its poses surveyed."""
    files = files_of(robot, folder)
    constraints = tuple(one.document for one in loop_constraints(robot))
    mechanism = mechanism_of(robot, constraints)
    kind: Callable[..., Simulation] = MujocoSimulation if engine == "mujoco" else PybulletSimulation

    def opened(setup: Setup) -> Simulation:
        return kind(str(files[engine]), mechanism, setup)

    pairs = finger_candidates(mechanism)
    fingers = (*pairs, *jaw_candidates(mechanism, pairs))
    poses = survey(str(files["mujoco"]), mechanism, fingers, 0.2)
    return Stage(opened, mechanism, poses, wheels_of(mechanism), limbs_of(mechanism))
