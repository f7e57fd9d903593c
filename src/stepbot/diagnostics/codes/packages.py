"""SB64x: packages and files for other programs."""

from .code import Code

CODES = (
    Code(
        "SB640",
        "warning",
        "package without maintainer or licence",
        "The manifest of a ROS 2 package must state a maintainer and a licence, and the sidecar has none; or the "
        "maintainer's address is in a domain for examples, such as example.com, as in the sidecars of stepbot's robot "
        "library. `package.xml` has `unknown` in place of what is missing: colcon builds the package, but nobody may "
        "use or publish it without asking, and `rosdep` and release tools report it. Nobody receives what users write "
        "to a placeholder.",
        "State both in the sidecar: `metadata: {maintainer: Ada Lovelace <ada@example.com>, license: Apache-2.0}`, "
        "with your own name and address. For a URDF, SDFormat or MJCF, or a sidecar that is not yours, use the options "
        "`--maintainer` and `--license`.",
    ),
    Code(
        "SB641",
        "note",
        "package without controllers",
        "The robot has no actuators, so its ROS 2 package has neither `<ros2_control>` nor `controllers.yaml`. RViz "
        "moves the joints by sliders and MoveIt plans, but nothing carries a motion out. In Gazebo the joints move "
        "freely.",
        "Add actuators to the sidecar: `actuators: {elbow_motor: {joint: elbow, kind: position, gains: auto}}`.",
    ),
    Code(
        "SB642",
        "note",
        "gripper found by its name",
        "The last joint of an arm, or the link that it moves, is named like a jaw, and its range is at most 2.5 rad or "
        "m. In the SRDF it is an end effector with a group of its own, and the arm's group ends at the link before. "
        "MoveIt plans for the arm without this joint. If the joint is part of the arm, its inverse kinematics lack one "
        "joint.",
        "If the joint is no jaw, rename it, or add it to the arm's group in the SRDF.",
    ),
)
