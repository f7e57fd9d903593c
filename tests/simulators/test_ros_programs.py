"""Programs of ROS 1, as Debian 12 has them, with packages of stepbot: the poses that are published, and RViz's picture.

They need ``apt-get install ros-robot-state-publisher python3-roslaunch python3-rosparam python3-sensor-msgs
python3-tf2-ros``, and ``rviz xvfb libgl1-mesa-dri`` for the picture.
"""

import json
import os
import shutil
import signal
import socket
import struct
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.formats.lowering import lower
from stepbot.formats.urdf import FORMAT as URDF
from stepbot.geometry.spatial import Pose, Vector3
from stepbot.pipeline.conversion import Options, write
from stepbot.pipeline.stages import produce
from stepbot.robot.kinematics import MOVING, initial_configuration, link_poses
from stepbot.robot.model import MeshRef, Robot
from stepbot.runtime.cache import Cache, default_folder
from stepbot.runtime.robot_library import library_robot

pytestmark = pytest.mark.long

PUBLISHER = Path("/usr/lib/robot_state_publisher/robot_state_publisher")
DEBIANS_PYTHON = "/usr/bin/python3"
NAMES = ("ur5e", "ur5e_2f85", "gen3", "panda", "sawyer", "yumi", "2f85", "hand", "youbot", "delta", "quadruped")
PROBE = """
import json, sys
import rospy
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

q, links = json.load(sys.stdin)
rospy.init_node("probe")
seen = {}

def heard(message):
    for one in message.transforms:
        p, r = one.transform.translation, one.transform.rotation
        seen[one.child_frame_id] = [one.header.frame_id, [r.w, r.x, r.y, r.z], [p.x, p.y, p.z]]

heard_on = [rospy.Subscriber(topic, TFMessage, heard) for topic in ("/tf", "/tf_static")]
publisher = rospy.Publisher("/joint_states", JointState, queue_size=1)
for _ in range(200):
    state = JointState(name=list(q), position=list(q.values()))
    state.header.stamp = rospy.Time.now()
    publisher.publish(state)
    rospy.sleep(0.1)
    if len(seen) >= links:
        break
print(json.dumps(seen))
"""


JOINT_STATES = """
import json, sys
import rospy
from sensor_msgs.msg import JointState

q = json.loads(sys.argv[1])
rospy.init_node("joints")
publisher, rate = rospy.Publisher("/joint_states", JointState, queue_size=1), rospy.Rate(10)
while not rospy.is_shutdown():
    state = JointState(name=list(q), position=list(q.values()))
    state.header.stamp = rospy.Time.now()
    publisher.publish(state)
    rate.sleep()
"""
VIEW = """
Panels: []
Visualization Manager:
  Class: ""
  Displays:
    - {{Class: rviz/RobotModel, Name: RobotModel, Enabled: true, Robot Description: robot_description}}
  Enabled: true
  Global Options: {{Background Color: 255; 0; 255, Fixed Frame: {root}, Frame Rate: 10}}
  Tools: [{{Class: rviz/MoveCamera}}]
  Views:
    Current:
      Class: rviz/Orbit
      Name: Current View
      Distance: {distance}
      Focal Point: {{X: {x}, Y: {y}, Z: {z}}}
      Near Clip Distance: 0.01
      Pitch: {pitch}
      Yaw: {yaw}
      Target Frame: {root}
    Saved: ~
Window Geometry: {{Height: 600, Width: 800, X: 0, Y: 0, Hide Left Dock: true, Hide Right Dock: true}}
"""
PITCH, YAW, FIELD = 0.4, 0.9, np.pi / 4
"""The camera of RViz's orbit: where it is seen from the focal point, and its vertical field of view [rad]."""
BACKGROUND = (255, 0, 255)


@pytest.fixture(scope="module")
def ros() -> Iterator[dict[str, str]]:
    """The environment of programs of a running ROS 1."""
    if not (shutil.which("roscore") and PUBLISHER.exists()):
        pytest.skip("ROS is not installed: apt-get install ros-robot-state-publisher python3-roslaunch")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    environment = {**os.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1"}
    environment.pop("PYTHONPATH", None)
    with subprocess.Popen(
        ["roscore", "-p", str(port)],
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as core:
        try:
            for _ in range(120):
                if (
                    subprocess.run(["rosparam", "list"], env=environment, capture_output=True, check=False).returncode
                    == 0
                ):
                    break
                time.sleep(0.5)
            yield environment
        finally:
            os.killpg(core.pid, signal.SIGINT)


def packaged(name: str, folder: Path, ros: Mapping[str, str]) -> Robot:
    """A robot of the library as URDF expresses it, after its package was written, and given to ROS as its robot."""
    options = Options(
        folder, formats=("urdf",), verify=False, package=f"{name}_description", ros2=True, cache=Cache(default_folder())
    )
    conversion = produce(library_robot(name).sidecar, options)
    conversion.diagnostics.raise_if_errors()
    assert conversion.robot is not None
    write(conversion, options.output, library_robot(name).sidecar)
    text = folder / f"{name}.urdf"
    subprocess.run(["rosparam", "set", "robot_description", "-t", str(text)], env=dict(ros), check=True, timeout=60)
    return lower(conversion.robot, URDF, Diagnostics())


@pytest.mark.parametrize("name", NAMES)
def test_published_poses_are_the_models(name: str, ros: dict[str, str], tmp_path: Path) -> None:
    """Every link of the package's URDF is published where the model has it, at random positions; mimics follow."""
    robot, random = packaged(name, tmp_path / "out", ros), np.random.default_rng(11)
    free = [joint.name for joint in robot.joints if joint.kind in MOVING and joint.mimic is None]
    q = {one: float(random.uniform(-1.0, 1.0)) for one in free}
    whole = dict(q)
    for joint in robot.joints:
        if joint.mimic is not None:
            whole[joint.name] = joint.mimic.multiplier * q[joint.mimic.joint] + joint.mimic.offset
    with subprocess.Popen([str(PUBLISHER)], env=ros, stderr=subprocess.DEVNULL) as publisher:
        try:
            asked = json.dumps([q, len(robot.links) - 1])
            command = [DEBIANS_PYTHON, "-c", PROBE]
            run = subprocess.run(command, env=ros, input=asked, capture_output=True, text=True, check=True, timeout=120)
        finally:
            publisher.terminate()
    seen = json.loads(run.stdout.splitlines()[-1])
    expected = link_poses(robot, whole)
    for link in robot.links:
        X, at = Pose(), link.name
        while at != robot.root.name:
            at, turn, place = seen[at]
            X = Pose.from_quaternion(turn, place) @ X
        distance, angle = X.distance_to(expected[link.name])
        assert distance < 1e-12, link.name
        assert angle < 1e-7, link.name  # an arc cosine of rounded quaternions


@contextmanager
def running(command: list[str], env: Mapping[str, str]) -> Iterator[None]:
    """A program that runs meanwhile."""
    with subprocess.Popen(command, env=dict(env), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as program:
        try:
            yield
        finally:
            program.terminate()


def screen(frame_buffer: Path) -> np.ndarray:
    """What Xvfb shows, from its file in the format of `xwd`. Shape (height, width, 3)."""
    raw = frame_buffer.read_bytes()
    head = struct.unpack(">25I", raw[:100])
    size, width, height, colors = head[0], head[4], head[5], head[19]
    pixels = np.frombuffer(raw, np.uint8, offset=size + 12 * colors, count=4 * width * height)
    return pixels.reshape(height, width, 4)[..., 2::-1].astype(int)


def outline(
    robot: Robot, q: Mapping[str, float], focus: Vector3, distance: float, shape: tuple[int, int]
) -> np.ndarray:
    """Which pixels of an orbit's camera the visuals cover, by rays. Shape ``shape``."""
    trimesh, X_RL = pytest.importorskip("trimesh"), link_poses(robot, q)
    meshes = {one.name: one.mesh for one in robot.meshes}
    parts = []
    for link in robot.links:
        for visual in link.visuals:
            assert isinstance(visual.geometry, MeshRef)
            mesh = meshes[visual.geometry.name].moved(X_RL[link.name] @ visual.X_LG)
            parts.append(trimesh.Trimesh(mesh.vertices, mesh.faces, process=False))
    back = np.array((np.cos(YAW) * np.cos(PITCH), np.sin(YAW) * np.cos(PITCH), np.sin(PITCH)))
    right = np.cross((0.0, 0.0, 1.0), back) / np.cos(PITCH)
    height, width = shape
    x, y = ((2.0 * np.arange(n) + 1.0 - n) / height * np.tan(FIELD / 2) for n in (width, height))
    rays = (x[None, :, None] * right - y[:, None, None] * np.cross(back, right) - back).reshape(-1, 3)
    eye = np.broadcast_to(np.add(focus, distance * back), rays.shape)
    return trimesh.util.concatenate(parts).ray.intersects_any(eye, rays).reshape(shape)


@pytest.mark.parametrize("name", ["ur5e", "2f85", "quadruped"])
def test_rviz_shows_the_robot(name: str, ros: dict[str, str], tmp_path: Path) -> None:
    """The package's meshes cover the pixels that the model's do, up to a pixel along outlines."""
    if not (shutil.which("rviz") and shutil.which("Xvfb")):
        pytest.skip("RViz is not installed: apt-get install rviz xvfb libgl1-mesa-dri")
    robot = packaged(name, tmp_path / f"{name}_description", ros)
    drawn = initial_configuration(robot)
    q = {one.name: drawn[one.name] for one in robot.joints if one.kind in MOVING and one.mimic is None}
    places = np.array([X.position for X in link_poses(robot, drawn).values()])
    focus, distance = (places.min(axis=0) + places.max(axis=0)) / 2, 2.5 * float(np.ptp(places, axis=0).max()) + 0.2
    x, y, z = map(float, focus)
    view = VIEW.format(root=robot.root.name, distance=distance, x=x, y=y, z=z, pitch=PITCH, yaw=YAW)
    (tmp_path / "view.rviz").write_text(view, encoding="utf-8")
    (tmp_path / "home").mkdir()
    display = f":{90 + os.getpid() % 100}"
    env = {**ros, "DISPLAY": display, "HOME": str(tmp_path / "home"), "LIBGL_ALWAYS_SOFTWARE": "1"}
    env |= {"ROS_PACKAGE_PATH": f"{tmp_path}:/usr/share"}
    with ExitStack() as stack:
        for command in (
            ["Xvfb", display, "-screen", "0", "800x600x24", "-fbdir", str(tmp_path)],
            [str(PUBLISHER)],
            [DEBIANS_PYTHON, "-c", JOINT_STATES, json.dumps(q)],
            ["rviz", "-d", str(tmp_path / "view.rviz"), "-f", robot.root.name],
        ):
            stack.enter_context(running(command, env))
        agreement = 0.0
        for _ in range(120):  # RViz starts, loads the meshes and receives the poses
            time.sleep(1.0)
            if (tmp_path / "Xvfb_screen0").exists():
                agreement = max(agreement, overlap(screen(tmp_path / "Xvfb_screen0"), robot, q, tuple(focus), distance))
            if agreement > 0.95:
                break
    assert agreement > 0.95


def overlap(pixels: np.ndarray, robot: Robot, q: Mapping[str, float], focus: Vector3, distance: float) -> float:
    """Pixels that RViz and the model both cover, as a share of those that one of them covers; 0 without a view."""
    background = np.abs(pixels - BACKGROUND).sum(axis=2) < 30
    rows, columns = (np.flatnonzero(background.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return 0.0
    view = ~background[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    expected = outline(robot, q, focus, distance, view.shape)
    return float((view & expected).sum() / max(1, (view | expected).sum()))
