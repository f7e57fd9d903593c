"""SB64x: packages for other programs."""

from .code import Code

CODES = (
    Code(
        "SB640",
        "warning",
        "package without maintainer or licence",
        "The manifest of a ROS 2 package must state a maintainer and a licence, and the sidecar has none.",
        "`package.xml` has `unknown` in their place: colcon builds the package, but nobody may use or publish it without "
        "asking, and `rosdep` and release tools report it.",
        "State both in the sidecar: `metadata: {maintainer: Ada Lovelace <ada@example.com>, license: Apache-2.0}`.",
    ),
    Code(
        "SB641",
        "note",
        "package without controllers",
        "The robot has no actuators, so its ROS 2 package has neither `<ros2_control>` nor `controllers.yaml`.",
        "RViz moves the joints by sliders and MoveIt plans, but nothing carries a motion out. In Gazebo the joints move freely.",
        "Add actuators to the sidecar: `actuators: {elbow_motor: {joint: elbow, kind: position, gains: auto}}`.",
    ),
)
