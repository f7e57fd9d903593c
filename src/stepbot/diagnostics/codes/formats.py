"""SB7xx: features of a robot that a format cannot represent. ``docs/mapping.md`` has each feature in each format."""

from .code import Code

CODES: tuple[Code, ...] = (
    Code(
        "SB760",
        "warning",
        "feature not written",
        "The format lacks a feature of the robot. The message states what is left out or approximated, and where.",
        "Use a format that has the feature (`stepbot docs mapping`), add it in the program that loads the "
        "file, or leave this format out with `-f`. A closure can often be replaced by another joint of its "
        "loop; collision meshes by primitives under `collision`, or `collision: decompose`; joint damping by "
        "`kv` of the actuator. If the loss does not matter, ignore this one feature: `--ignore SB760:armature`.",
        features="acceleration actuator-input armature ball-force ball-limit camera camera-extras closure concave-collision contact encoder-rate far-limit flat-collision force-torque imu joint-sensor lidar lidar-nearest mixed-mimic off-joint open-view passive-limit second-actuator sensor-place sensor-rate sliding-closure softness spin spring stuck-closure",
    ),
    Code(
        "SB761",
        "warning",
        "feature written with a difference",
        "The format lacks a feature of the robot, and something close to it is written: a joint as several "
        "joints, another name, another zero, a stand-in mass, a coupled motor. Masses and motion are those of "
        "the robot, except where the message states otherwise; three joints in place of a ball have a "
        "singularity at a pitch of ±90 deg.",
        "Use a format that has the feature (`stepbot docs mapping`), or model what the format has: single-axis "
        "joints, unique names, a loop whose joints have no `zero`, links with their masses.",
        features="ball cylindrical dead-bounce floating frame-name joint-name loop-zero massless mimic mixed-surface planar screw universal",
    ),
    Code(
        "SB762",
        "note",
        "setting left to the program that loads the file",
        "The format cannot represent a setting: whether the base is fixed, the initial pose, settings of the "
        "simulation. The loading program starts the robot with its own. The drawn pose of a URDF is only in its "
        "`<ros2_control>`, as `initial_value` of the driven joints, which ROS 2 and Gazebo read. Of moving links without "
        "mass in a URDF, Gazebo drops all links below. PyBullet and Drake have no setting for `closure_stiffness`.",
        "Set it after loading, such as `useFixedBase` and `setTimeStep` in PyBullet; `report.json` has the "
        "values. For Gazebo, convert to SDFormat, or start the ROS 2 package with its "
        "`launch/gazebo.launch.py`.",
        features="fixed-base floating-base initial-pose massless-body solver timestep",
    ),
    Code(
        "SB763",
        "note",
        "feature written by other means",
        "The format lacks a feature of the robot, and an equivalent is written: several primitives, links "
        "without mass for frames, a placeholder for a missing limit, gains at the joint, a loop cut at another "
        "joint, a later version of the format, or an extension that some parsers ignore (`<ros2_control>`, "
        "`<gazebo>`, `<plugin>`), which stepbot verifies with its own parser and counts separately.",
        "No action is needed. To avoid placeholders, set the limits of the joint in the sidecar.",
        features="actuator bounce camera capsule concave-collision contact dae-visual excluded-contact follower force-torque frame gear glb-visual imu joint-sensor lidar massless-body mimic mimic-chain open-effort open-position open-view optical other-collision sensor-place sliding-closure spin spring surface unlimited-actuator velocity",
    ),
    Code(
        "SB764",
        "error",
        "robot cannot be written in the format",
        "A name is reserved by the format, or a closure cannot be written in it. Parsers reject a reserved name, or "
        "interpret a link named `world` as the world. Without the closure, the file would describe a different robot.",
        "Choose another name in the sidecar, or close the loop at another joint. Otherwise leave out the format with "
        "`-f`.",
        features="reserved-name stuck-closure",
    ),
)
