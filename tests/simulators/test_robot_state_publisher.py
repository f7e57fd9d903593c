"""ROS's robot_state_publisher, as Debian 12 has it for ROS 1: the poses that it publishes for packages of stepbot.

It needs ``apt-get install ros-robot-state-publisher python3-roslaunch python3-rosparam python3-tf2-ros``.
"""

import json
import os
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.formats.lowering import lower
from stepbot.formats.urdf import FORMAT as URDF
from stepbot.geometry.spatial import Pose
from stepbot.pipeline.conversion import Options, write
from stepbot.pipeline.stages import produce
from stepbot.robot.kinematics import MOVING, link_poses
from stepbot.runtime.cache import Cache, default_folder
from stepbot.runtime.robot_library import library_robot

pytestmark = pytest.mark.long

PUBLISHER = Path("/usr/lib/robot_state_publisher/robot_state_publisher")
DEBIANS_PYTHON = "/usr/bin/python3"
NAMES = ("ur5e", "gen3", "panda", "sawyer", "yumi", "2f85", "hand", "youbot", "delta", "quadruped")
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


@pytest.mark.parametrize("name", NAMES)
def test_published_poses_are_the_models(name: str, ros: dict[str, str], tmp_path: Path) -> None:
    """Every link of the package's URDF is published where the model has it, at random positions; mimics follow."""
    options = Options(
        tmp_path / "out",
        formats=("urdf",),
        verify=False,
        package=f"{name}_description",
        ros2=True,
        cache=Cache(default_folder()),
    )
    conversion = produce(library_robot(name).sidecar, options)
    conversion.diagnostics.raise_if_errors()
    assert conversion.robot is not None
    write(conversion, options.output, library_robot(name).sidecar)
    robot, random = lower(conversion.robot, URDF, Diagnostics()), np.random.default_rng(11)
    free = [joint.name for joint in robot.joints if joint.kind in MOVING and joint.mimic is None]
    q = {one: float(random.uniform(-1.0, 1.0)) for one in free}
    whole = dict(q)
    for joint in robot.joints:
        if joint.mimic is not None:
            whole[joint.name] = joint.mimic.multiplier * q[joint.mimic.joint] + joint.mimic.offset
    text = options.output / f"{name}.urdf"
    subprocess.run(["rosparam", "set", "robot_description", "-t", str(text)], env=ros, check=True, timeout=60)
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
