"""Python files that load a robot in programs for learning, beside its description: ``convert --for mjlab``.

Each has the joints, gains, limits and the initial pose of the robot as that program takes them, and prints the joints
when it is run. ``docs/use-it-in.md`` states what each was run with.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from math import inf
from typing import NamedTuple

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.gains import actuator_limit
from stepbot.robot.model import Actuator, ActuatorKind, Base, JointKind, Robot

from . import FORMATS
from .lowering.devices import gears_at_joints
from .mjcf.learning import genesis, mjlab, playground, rejected_by_mjx, robosuite
from .python_text import class_name, height, home, literal, table, words
from .rendering import main_file
from .urdf.chains import Chain, chains
from .urdf.grippers import groups

MENAGERIE = "menagerie"
"""MuJoCo Menagerie, which gets a folder with the MJCF instead of a Python file."""
SIMREADY = "simready"
"""Libraries of SimReady assets, for Isaac Sim: a folder with the layers of OpenUSD."""
_UNLIMITED = 1e10
"""Limit of speed or effort that the robot does not state, where a program needs a number, in SI."""
FOLDERS = {MENAGERIE: "mjcf", SIMREADY: "usd"}
"""Programs that get a folder, and the format that it is made of."""


class Program(NamedTuple):
    """A program that robots are trained in."""

    format: str
    write: Callable[[Robot, str], str]
    """The Python file of a robot lowered for the format, whose description has that name."""
    rejects: Callable[[Robot], str] = lambda _robot: ""
    """Why the program cannot use such a robot; empty if it can."""
    remedy: str = ""
    """What makes the robot one that it can use, instead of converting without the program."""


def program_names(given: Iterable[str]) -> tuple[str, ...]:
    """Names of programs, each once, in the order of :data:`PROGRAMS`, then of :data:`FOLDERS`.

    Raises:
        ValueError: A name is not known.
    """
    names = {name.lower() for name in given}
    known = (*PROGRAMS, *FOLDERS)
    if unknown := sorted(names - set(known)):
        raise ValueError(f"no program '{unknown[0]}'; there are {', '.join(known)}")
    return tuple(name for name in known if name in names)


def formats_for(programs: Sequence[str], formats: Sequence[str]) -> tuple[str, ...]:
    """The formats, and those that programs load."""
    loaded = (PROGRAMS[name].format if name in PROGRAMS else FOLDERS[name] for name in programs)
    return tuple(dict.fromkeys((*formats, *loaded)))


def program_files(
    programs: Sequence[str], lowered: Mapping[str, Robot], diagnostics: Diagnostics
) -> dict[str, dict[str, bytes]]:
    """For each format, the files of programs that load it, by path relative to the output folder.

    Args:
        programs: Names from :func:`program_names`.
        lowered: For each format, the robot as that format expresses it.
        diagnostics: Receives SB644 for a robot that a program cannot use.
    """
    files: dict[str, dict[str, bytes]] = {}
    for name, program in PROGRAMS.items():
        if name not in programs:
            continue
        robot = lowered[program.format]
        if why := program.rejects(robot):
            help = [*([program.remedy] if program.remedy else []), f"convert without `--for {name}`"]
            diagnostics.add("SB644", f"{name}: {why}", Span(robot.source or robot.name), help=help)
            continue
        text = program.write(gears_at_joints(robot), main_file(robot, FORMATS[program.format]))
        path = f"{re.sub(r'[^A-Za-z0-9_]', '_', robot.name)}_{name}.py"
        files.setdefault(program.format, {})[path] = text.encode()
    return files


def simready_folder(robot: Robot) -> dict[str, bytes]:
    """The files of a SimReady asset, by path relative to the output folder.

    Args:
        robot: The robot as OpenUSD expresses it.
    """
    asset = import_module(f"{FORMATS[FOLDERS[SIMREADY]].package}.asset")  # nothing else imports OpenUSD's rooms
    folder = f"{SIMREADY}/{robot.name}/usd"  # the rules ask for one folder between the name and the files
    return {f"{folder}/{path}": content for path, content in asset.asset_files(robot).items()}


def _isaaclab(robot: Robot, file: str) -> str:
    rows = "".join(
        f"        {literal(actuator.name)}: ImplicitActuatorCfg(\n"
        f"            joint_names_expr=[{literal(re.escape(actuator.joint))}],\n"
        f"            stiffness={actuator.kp!r},\n            damping={actuator.kv!r},\n"
        + _bounds(robot, actuator)
        + "        ),\n"
        for actuator in robot.actuators
    )
    return f'''"""{words(robot)} in Isaac Lab: the articulation `ROBOT`."""

from pathlib import Path

import isaaclab.sim as sim_utils
from isaaclab.actuators import ImplicitActuatorCfg
from isaaclab.assets import ArticulationCfg

MODEL = Path(__file__).with_name({literal(file)})
LIMITS = "joint_effort_limit", "joint_velocity_limit"
if LIMITS[0] not in ImplicitActuatorCfg.__dataclass_fields__:
    LIMITS = "effort_limit_sim", "velocity_limit_sim"  # their names before Isaac Lab 3

ROBOT = ArticulationCfg(
    spawn=sim_utils.UsdFileCfg(usd_path=str(MODEL)),
    init_state=ArticulationCfg.InitialStateCfg(
        pos=(0.0, 0.0, {height(robot)!r}),
        joint_pos={table(home(robot), 8)},
    ),
    actuators={{
{rows}    }},
)

if __name__ == "__main__":  # without Isaac Sim, in Newton on the processor: Isaac Lab 3
    from isaaclab.scene import InteractiveScene, InteractiveSceneCfg
    from isaaclab.utils import configclass
    from isaaclab_newton.physics import MJWarpSolverCfg, NewtonCfg

    @configclass
    class Scene(InteractiveSceneCfg):
        robot = ROBOT.replace(prim_path="{{ENV_REGEX_NS}}/Robot")

    physics = NewtonCfg(solver_cfg=MJWarpSolverCfg())
    settings = sim_utils.SimulationCfg(device="cpu", physics=physics)
    with sim_utils.build_simulation_context(sim_cfg=settings) as simulation:
        scene = InteractiveScene(Scene(num_envs=1, env_spacing=2.0))
        simulation.reset()
        print(*scene["robot"].joint_names)
'''


def _bounds(robot: Robot, actuator: Actuator) -> str:
    """Isaac Lab's keywords for what a joint states."""
    joint = robot.joint_by_name[actuator.joint]
    limits = [min(getattr(actuator.limit, name), getattr(joint.limit, name)) for name in ("effort", "velocity")]
    stated = ", ".join(f"LIMITS[{place}]: {value!r}" for place, value in enumerate(limits) if value not in (0.0, inf))
    armature = joint.dynamics.armature
    lines = [f"**{{{stated}}}," * bool(stated), f"armature={armature!r}," * bool(armature)]
    return "".join(f"            {line}\n" for line in lines if line)


def _maniskill(robot: Robot, file: str) -> str:
    controllers = "".join(
        f"            {literal(key)}: {control}(\n                {literal(joints)},\n{arguments}            ),\n"
        for key, control, joints, arguments in _controllers(robot)
    )
    return f'''"""{words(robot)} in ManiSkill: the agent `{words(robot)}`, as `robot_uids` of an environment."""

from pathlib import Path

import numpy as np
import sapien
from mani_skill.agents.base_agent import BaseAgent, Keyframe
from mani_skill.agents.controllers import (
    PassiveControllerConfig,
    PDJointPosControllerConfig,
    PDJointVelControllerConfig,
)
from mani_skill.agents.registration import register_agent

HOME = {table(home(robot))}


@register_agent()
class {class_name(robot)}(BaseAgent):
    """{words(robot)}, with position targets [rad, m], velocity targets [rad/s, m/s], and joints without a drive."""

    uid = {literal(robot.name)}
    urdf_path = str(Path(__file__).with_name({literal(file)}))
    fix_root_link = {robot.base is not Base.FLOATING!r}

    @property
    def keyframes(self):
        """The drawn pose."""
        qpos = np.array([HOME.get(joint.name, 0.0) for joint in self.robot.active_joints])
        return {{"home": Keyframe(qpos=qpos, pose=sapien.Pose([0.0, 0.0, {height(robot)!r}]))}}

    @property
    def _controller_configs(self):
        configs = {{
{controllers}        }}
        driven = {{name for config in configs.values() for name in config.joint_names}}
        free = [joint.name for joint in self.robot.active_joints if joint.name not in driven]
        if free:
            configs["free"] = PassiveControllerConfig(free, damping=0.0)
        return {{"stepbot": configs}}


if __name__ == "__main__":
    import gymnasium

    options = {{"control_mode": "stepbot", "render_backend": "none"}}  # without a graphics card
    agent = gymnasium.make("Empty-v1", robot_uids={literal(robot.name)}, **options).unwrapped.agent
    print(agent.action_space.shape, *(joint.name for joint in agent.robot.active_joints))
'''


def _controllers(robot: Robot) -> list[tuple[str, str, list[str], str]]:
    """For each kind of actuator its key, class, joints and further arguments; motors have no controller."""
    controllers = []
    for kind, control in (
        (ActuatorKind.POSITION, "PDJointPosControllerConfig"),
        (ActuatorKind.VELOCITY, "PDJointVelControllerConfig"),
    ):
        group = [actuator for actuator in robot.actuators if actuator.kind is kind]
        if not group:
            continue
        limits = [actuator_limit(one, robot.joint_by_name[one.joint]) for one in group]
        effort = [limit.effort for limit in limits]
        fastest = [_UNLIMITED if limit.velocity == inf else limit.velocity for limit in limits]
        is_speed = kind is ActuatorKind.VELOCITY  # None: the limits of the joints, which are positions
        rows = {
            "lower": [-one for one in fastest] if is_speed else None,
            "upper": fastest if is_speed else None,
            **({"stiffness": [one.kp for one in group]} if kind is ActuatorKind.POSITION else {}),
            "damping": [one.kv for one in group],
            "force_limit": [_UNLIMITED if one == inf else one for one in effort],
            "normalize_action": False,
        }
        arguments = "".join(f"                {key}={literal(value)},\n" for key, value in rows.items())
        controllers.append((kind.value, control, [one.joint for one in group], arguments))
    return controllers


def _turning(robot: Robot) -> list[Chain]:
    """The chains whose joints all turn: LeRobot's angles are in degrees."""
    return [one for one in groups(robot)[0] if all(joint.kind is not JointKind.PRISMATIC for joint in one.joints)]


def _lerobot(robot: Robot, file: str) -> str:
    chain = max(_turning(robot), key=lambda one: len(one.joints))
    joints = [joint.name for joint in chain.joints]
    drawn = home(robot)
    return f'''"""{words(robot)} in LeRobot: `kinematics()` of its longest chain of turning joints."""

from math import degrees
from pathlib import Path

import numpy as np
from lerobot.model.kinematics import RobotKinematics

MODEL = Path(__file__).with_name({literal(file)})
JOINTS = {literal(joints)}
TIP = {literal(chain.tip)}
HOME = {table({name: drawn[name] for name in joints})}


def kinematics():
    """Poses of the tip [m] from angles [deg], and angles from poses."""
    return RobotKinematics(str(MODEL), target_frame_name=TIP, joint_names=JOINTS)


if __name__ == "__main__":
    pose = kinematics().forward_kinematics(np.array([degrees(HOME[name]) for name in JOINTS]))
    print(TIP, pose[:3, 3], *JOINTS)
'''


def _other_than_an_arm(robot: Robot) -> str:
    """Why robosuite cannot take a robot as an arm; empty if it can."""
    moving = [joint for joint in robot.joints if joint.kind is not JointKind.FIXED]
    others = [joint.name for joint in moving if any(part in joint.name for part in ("torso", "mobile", "head", "leg"))]
    arms = chains(robot)
    is_chain = len(arms) == 1 and arms[0].joints == tuple(moving) and all(joint.kind.is_pair for joint in moving)
    if robot.base is Base.FLOATING or not is_chain:
        return "its arms have a fixed base and one chain of hinges or slides; `without` of a module leaves out a hand"
    if others:
        return f"the name of '{others[0]}' means that the joint is not in the arm"
    unlimited = [joint.name for joint in moving if joint.limit.effort in (0.0, inf)]
    return f"'{unlimited[0]}' has no effort limit, which a torque motor needs" if unlimited else ""


def _newton(robot: Robot, file: str) -> str:
    """Newton starts at q = 0, and has no floor of its own."""
    return f'''"""{words(robot)} in Newton: `model()`, in the drawn pose on a floor."""

from pathlib import Path

import newton  # before the first import of pxr: it adds schemas
from pxr import Usd

MODEL = Path(__file__).with_name({literal(file)})
HOME = {table(home(robot))}


def model():
    """The model on the default device; `newton.eval_fk` gives the poses of its links."""
    builder = newton.ModelBuilder()
    stage = Usd.Stage.Open(str(MODEL))
    builder.add_usd(stage)
    for label, start in zip(builder.joint_label, builder.joint_q_start):
        prim = stage.GetPrimAtPath(label)
        name = (prim.GetDisplayName() or prim.GetName()) if prim else ""  # the free joint of a base has no prim
        if name in HOME:
            builder.joint_q[start] = HOME[name]
    builder.add_ground_plane()
    return builder.finalize()


if __name__ == "__main__":
    robot = model()
    print(robot.joint_count, "joints;", *(label.rpartition("/")[2] for label in robot.joint_label))
'''


PROGRAMS = {
    "mjlab": Program("mjcf", mjlab),
    "maniskill": Program("urdf", _maniskill),
    "genesis": Program("mjcf", genesis),
    "isaaclab": Program("usd", _isaaclab),
    "playground": Program("mjcf", playground, rejected_by_mjx, "`defaults: {collision: {for: mjx}}` in the sidecar"),
    "lerobot": Program("urdf", _lerobot, lambda robot: "" if _turning(robot) else "no chain of turning joints"),
    "newton": Program("usd", _newton),
    "robosuite": Program("mjcf", robosuite, _other_than_an_arm),
}
"""By name in commands."""
