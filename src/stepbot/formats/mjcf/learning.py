"""Python files that load a robot's MJCF in programs for learning: mjlab, MuJoCo Playground, Genesis, robosuite."""

import re

from stepbot.geometry.spatial import Pose
from stepbot.robot.kinematics import without_contacts
from stepbot.robot.model import Box, Cylinder, JointKind, MeshRef, Robot
from stepbot.robot.sensors import SensorKind
from stepbot.robot.simulation_settings import settings_of
from stepbot.robot.tuning import Integrator

from ..python_text import class_name, height, home, literal, table, words
from .contacts import FRICTION

_CONTROL_STEP = 0.02
"""Time [s] between actions, as in most tasks of MuJoCo Playground."""
_TOOLS = ("tool0", "tcp", "tool")
"""Frames that grippers are attached to."""


def mjlab(robot: Robot, file: str) -> str:
    """The entity, with the actuators of the MJCF."""
    settings = settings_of(robot)
    integrator = "euler" if settings.integrator is Integrator.EULER else "implicitfast"  # mjlab has no others
    driven = tuple(re.escape(actuator.joint) for actuator in robot.actuators)
    actuators = f"(XmlActuatorCfg(target_names_expr={literal(driven)}),)" if driven else "()"
    has_ball = any(joint.kind is JointKind.BALL for joint in robot.joints)
    friction = ", ".join(f"{key}={literal(value)}" for key, value in FRICTION.items())
    positions = "None" if has_ball else "{re.escape(name): q for name, q in HOME.items()}"  # None: the file's keyframe
    return f'''"""{words(robot)} in mjlab: the entity `ROBOT`, and `MUJOCO`, the options that attaching drops."""

import re
from pathlib import Path

import mujoco
from mjlab.actuator import XmlActuatorCfg
from mjlab.entity import EntityArticulationInfoCfg, EntityCfg
from mjlab.sim import MujocoCfg

MODEL = Path(__file__).with_name({literal(file)})
HOME = {table(home(robot))}

ROBOT = EntityCfg(
    spec_fn=lambda: mujoco.MjSpec.from_file(str(MODEL)),
    init_state=EntityCfg.InitialStateCfg(
        pos=(0.0, 0.0, {height(robot)!r}),
        joint_pos={positions},
    ),
    articulation=EntityArticulationInfoCfg(actuators={actuators}),
)
MUJOCO = MujocoCfg(timestep={settings.timestep!r}, integrator="{integrator}", {friction})

if __name__ == "__main__":
    from mjlab.scene import Scene, SceneCfg

    scene = Scene(SceneCfg(num_envs=1, entities={{"robot": ROBOT}}), device="cpu")
    print(scene.compile().nu, "actuators;", *scene["robot"].joint_names)
'''


def rejected_by_mjx(robot: Robot) -> str:
    """Why MJX does not load the MJCF of a robot; empty if it does."""
    contacts = [sensor.name for sensor in robot.sensors if sensor.kind is SensorKind.CONTACT]
    if contacts:
        return f"MJX has no contact sensor of a body, as '{contacts[0]}'"
    apart = without_contacts(robot)
    solids = {link.name: {type(shape.geometry) for shape in link.collisions} for link in robot.links}
    round_ = [name for name, kinds in solids.items() if Cylinder in kinds]
    for one, other in ((one, other) for one in round_ for other in solids if one != other):
        if solids[other] & {Box, MeshRef} and frozenset((one, other)) not in apart:
            return f"MJX has no contact between a cylinder ('{one}') and a box or hull ('{other}')"
    return ""


def playground(robot: Robot, file: str) -> str:
    """An environment without a reward."""
    step = settings_of(robot).timestep
    control = max(round(_CONTROL_STEP / step), 1) * step
    return f'''"""{words(robot)} in MuJoCo Playground: the environment `Robot`, to be derived from for a task."""

from pathlib import Path

import jax
import mujoco
from jax import numpy as jp
from ml_collections import config_dict
from mujoco import mjx
from mujoco_playground._src import mjx_env

MODEL = Path(__file__).with_name({literal(file)})
CONFIG = config_dict.create(ctrl_dt={control!r}, sim_dt={step!r}, episode_length=1000, action_repeat=1, impl="jax")


class Robot(mjx_env.MjxEnv):
    """Starts in the drawn pose; an action is the input of every actuator. A task states its reward."""

    def __init__(self, config=CONFIG, config_overrides=None):
        super().__init__(config.copy_and_resolve_references(), config_overrides)
        self._mj_model = mujoco.MjModel.from_xml_path(str(MODEL))
        self._mj_model.opt.timestep = self.sim_dt
        self._mjx_model = mjx.put_model(self._mj_model, impl=self._config.impl)
        start = self._mj_model.key("home") if self._mj_model.nkey else None
        self._qpos = jp.array(self._mj_model.qpos0 if start is None else start.qpos)
        self._ctrl = jp.zeros(self._mj_model.nu) if start is None else jp.array(start.ctrl)

    def reset(self, rng):
        data = mjx_env.make_data(self._mj_model, qpos=self._qpos, ctrl=self._ctrl, impl=self._config.impl)
        data = mjx.forward(self._mjx_model, data)
        return mjx_env.State(data, self.observation(data), jp.zeros(()), jp.zeros(()), {{}}, {{"rng": rng}})

    def step(self, state, action):
        data = mjx_env.step(self._mjx_model, state.data, action, self.n_substeps)
        failed = jp.isnan(data.qpos).any() | jp.isnan(data.qvel).any()
        reward, done = self.reward(data, action), failed.astype(jp.float32)
        return state.replace(data=data, obs=self.observation(data), reward=reward, done=done)

    def observation(self, data):
        """Positions and velocities."""
        return jp.concatenate([data.qpos, data.qvel])

    def reward(self, data, action):
        """None: that of a task."""
        return jp.zeros(())

    xml_path = property(lambda self: str(MODEL))
    action_size = property(lambda self: self._mj_model.nu)
    mj_model = property(lambda self: self._mj_model)
    mjx_model = property(lambda self: self._mjx_model)


if __name__ == "__main__":
    robot = Robot()
    state = jax.eval_shape(robot.reset, jax.random.PRNGKey(0))  # compiling takes minutes
    state = jax.eval_shape(robot.step, state, robot._ctrl)
    print(state.obs.shape, *(robot.mj_model.joint(i).name for i in range(robot.mj_model.njnt)))
'''


def genesis(robot: Robot, file: str) -> str:
    """A function that adds the robot to a scene, and one that moves it to its drawn pose."""
    return f'''"""{words(robot)} in Genesis: `add(scene)`, and after `scene.build()` `go_home(robot)`."""

from pathlib import Path

import genesis as gs

MODEL = Path(__file__).with_name({literal(file)})
HOME = {table(home(robot))}


def add(scene):
    """The entity of the robot, with the gains and force limits of the MJCF."""
    return scene.add_entity(gs.morphs.MJCF(file=str(MODEL), pos=(0.0, 0.0, {height(robot)!r})))


def go_home(robot):
    """Put the joints into the drawn pose, and hold them there."""
    joints = [robot.get_joint(name) for name in HOME]
    places = [index for joint in joints for index in joint.dofs_idx_local]
    robot.set_dofs_position(list(HOME.values()), places)
    robot.control_dofs_position(list(HOME.values()), places)


if __name__ == "__main__":
    gs.init(backend=gs.cpu)
    scene = gs.Scene(show_viewer=False)
    robot = add(scene)
    scene.build()
    go_home(robot)
    print(robot.n_dofs, "degrees of freedom;", *HOME)
'''


def robosuite(robot: Robot, file: str) -> str:
    """An arm for robosuite's tasks, whose controllers compute torques."""
    moving = [joint for joint in robot.joints if joint.kind is not JointKind.FIXED]
    drawn, effort = home(robot), {joint.name: joint.limit.effort for joint in moving}
    frame = next((one for one in robot.frames if one.name in _TOOLS), None)
    link = moving[-1].child if frame is None else frame.link
    X_LF = Pose() if frame is None else frame.X_LF
    hand = {
        "name": "right_hand",
        "pos": " ".join(map(repr, X_LF.position)),
        "quat": " ".join(map(repr, X_LF.quaternion)),
    }
    return f'''"""{words(robot)} in robosuite: the arm `{class_name(robot)}`, as `robots` of an environment."""

import tempfile
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from robosuite.models.robots import ManipulatorModel
from robosuite.robots import register_robot_class

MODEL = Path(__file__).with_name({literal(file)})
HOME = {table({one.name: drawn[one.name] for one in moving})}
EFFORT = {table(effort)}
GRIPPER = None  # or one of robosuite's, such as "PandaGripper" or "Robotiq85Gripper"
HAND = {literal(link)}, {table(hand)}


def write_model(path):
    """Write the MJCF as robosuite takes it: torque motors, a body for the gripper, and no settings of its own."""
    tree = ET.parse(MODEL)
    root = tree.getroot()
    for tag in ("custom", "keyframe", "option", "sensor", "size", "statistic", "visual"):
        for element in root.findall(tag):
            root.remove(element)
    actuators = root.find("actuator")
    actuators = ET.SubElement(root, "actuator") if actuators is None else actuators
    actuators.clear()
    for joint, bound in EFFORT.items():
        motor = {{"joint": joint, "ctrllimited": "true", "ctrlrange": f"{{-bound}} {{bound}}"}}
        ET.SubElement(actuators, "motor", name=f"{{joint}}_torque", **motor)
    for mesh in root.iterfind("asset/mesh"):
        mesh.set("name", mesh.get("name") or Path(mesh.get("file")).stem)
        mesh.set("file", str(MODEL.parent / mesh.get("file")))
    for geom in root.iter("geom"):
        geom.set("group", "1" if geom.get("class") == "visual" else "0")
    ET.SubElement(root.find("worldbody/body"), "site", name="right_center")
    link = next(body for body in root.iter("body") if body.get("name") == HAND[0])
    ET.SubElement(link, "body", **HAND[1])
    tree.write(path)


@register_robot_class("FixedBaseRobot")
class {class_name(robot)}(ManipulatorModel):
    """{words(robot)}, in its drawn pose."""

    arms = ["right"]
    arm_type = "single"
    default_base = "NullMount"
    default_gripper = {{"right": GRIPPER}}
    default_controller_config = {{"right": "default_panda"}}
    init_qpos = np.array(list(HOME.values()))
    base_xpos_offset = {{  # [m], as those of robosuite's UR5e, like the two below
        "bins": (-0.5, -0.1, 0),
        "empty": (-0.6, 0, 0),
        "table": lambda length: (-0.16 - length / 2, 0, 0),
    }}
    top_offset = np.array((0, 0, 1))
    _horizontal_radius = 0.5

    def __init__(self, idn=0):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, MODEL.name)
            write_model(path)
            super().__init__(str(path), idn=idn)


if __name__ == "__main__":
    import robosuite

    options = {{"has_renderer": False, "has_offscreen_renderer": False, "use_camera_obs": False}}
    control = robosuite.load_composite_controller_config(controller="BASIC")
    task = robosuite.make("Lift", robots="{class_name(robot)}", controller_configs=control, **options)
    task.reset()
    before = task.step(np.zeros(task.action_dim))[0]["robot0_eef_pos"]
    for _ in range(10):
        after = task.step(np.eye(task.action_dim)[2])[0]["robot0_eef_pos"]  # upwards
    print(task.action_dim, "actions; the hand rose by", after[2] - before[2], *task.robots[0].robot_model.joints)
'''
