"""SB7xx: features that a format cannot represent."""

from .code import Code

CODES: tuple[Code, ...] = (
    Code(
        "SB701",
        "warning",
        "loop closure not written",
        "The robot has closed loops, and the format can only represent a tree of links and joints.",
        "In this file, the mechanism moves as if the closing joints were removed. `report.json` lists the closures, "
        "so that a simulation can add them as constraints.",
        "Use SDFormat or MJCF for the closed loop, or exclude this format with `-f`.",
    ),
    Code(
        "SB703",
        "warning",
        "spring or armature not written",
        "A joint has a spring or an armature (reflected inertia of its motor), and the format cannot represent it.",
        "Without the spring, the joint has no restoring force; without the armature, it has less inertia. Damping "
        "that was chosen together with the armature may become too large: PyBullet is unstable where damping x time "
        "step exceeds twice the remaining inertia.",
        "Use a format that supports it (`stepbot docs mapping`), or add it in the simulator. Describe the drag of a motor "
        "with `kv` of its actuator instead of joint damping.",
    ),
    Code(
        "SB704",
        "note",
        "placeholder written for a missing limit",
        "A joint has no limit, and the format requires one. A value beyond the reach of any robot is written.",
        'The value stands for "no limit". A planner may interpret it as a real limit.',
        "Set the limits of the joint in the sidecar (`limits: {lower, upper, effort, velocity}`).",
    ),
    Code(
        "SB705",
        "note",
        "velocity limit not enforced",
        "The format does not support velocity limits. The value is written as custom data, which no engine enforces.",
        "A simulation may move the joint faster than its limit.",
        "Limit the velocity in the controller.",
    ),
    Code(
        "SB706",
        "note",
        "initial pose not written",
        "The assembled pose (as modelled in CAD) is not q = 0, and the format cannot represent an initial pose.",
        "Simulators start at q = 0. `report.json` lists the assembled position of every joint.",
        "Set the joint positions after loading the file.",
    ),
    Code(
        "SB707",
        "note",
        "base type not written",
        "The format cannot represent whether the root link is fixed to the world or floating.",
        "The base type depends on the loader: `useFixedBase` in PyBullet, a weld joint in Drake, and a default in "
        "other programs.",
        "Configure the loader to match `base` in the sidecar.",
    ),
    Code(
        "SB708",
        "note",
        "frames written as links",
        "The format has no frames. Each frame is written as a massless link on a fixed joint, as is common practice.",
        "The file has more links than the robot. Their inertia is written as zero, because some engines assume 1 kg "
        "for a link without `<inertial>`.",
        "No action is needed.",
    ),
    Code(
        "SB709",
        "note",
        "shape written as several primitives",
        "The format lacks a shape type. The shape is written as several primitives with exactly the same union.",
        "The geometry is unchanged, but the file has more shapes than the robot.",
        "No action is needed.",
    ),
    Code(
        "SB710",
        "warning",
        "renamed for the format",
        "A joint, closure or frame has the same name as another element, and the format requires unique names.",
        "The name in this file differs from the name in the other formats.",
        "Use unique names in the sidecar.",
    ),
    Code(
        "SB711",
        "warning",
        "joint zero shifted",
        "A joint of a closed loop is not at q = 0 in the assembled pose (as modelled in CAD). The format requires the "
        "loop to be closed at q = 0.",
        "In this file, q = 0 of these joints is the assembled pose. Limits, mimics and springs are shifted "
        "accordingly.",
        "Remove `zero` from the joints of the loop, or add the assembled position when you read their positions.",
    ),
    Code(
        "SB712",
        "warning",
        "flat collision mesh not written",
        "A collision mesh is planar, and the engine cannot build a convex hull of it.",
        "MuJoCo would reject the whole file. In this file, the surface makes no contact.",
        "Give the component a collision shape with a thickness (`collision: box`), or set `collision: none`.",
    ),
    Code(
        "SB713",
        "error",
        "closure type not supported by the format",
        "stepbot cannot write this type of closure in this format.",
        "Without the closure the file would describe a different robot.",
        "Close the loop at another joint, or exclude the format with `-f`.",
    ),
    Code(
        "SB714",
        "error",
        "reserved name",
        "A link, joint or frame has a name that is reserved by the format.",
        "Parsers reject the file, or interpret a link named `world` as the world.",
        "Choose another name in the sidecar.",
    ),
    Code(
        "SB715",
        "note",
        "newer format version required",
        "The robot uses a feature that requires a later version of the format than stepbot normally writes.",
        "Older parsers warn about the version and ignore the feature.",
        "No action is needed for current parsers.",
    ),
    Code(
        "SB716",
        "note",
        "chained mimics flattened",
        "A joint mimics another mimic joint. Many parsers of the format support only one level.",
        "In this file, every mimic refers to the joint at the start of the chain, with adjusted multiplier and "
        "offset. The motion is unchanged.",
        "No action is needed.",
    ),
    Code(
        "SB717",
        "warning",
        "collision mesh replaced by its convex hull",
        "A collision mesh is not convex or not closed, and the engine of the format uses its convex hull.",
        "Holes and gaps in the geometry are filled, so parts that should fit into them collide.",
        "Give the component several convex shapes: split it into parts in CAD, or list primitives under `collision`.",
    ),
    Code(
        "SB718",
        "warning",
        "limit of acceleration or jerk not written",
        "A joint limits its acceleration, deceleration or jerk, and the format, or the version of it that is written, has no "
        "place for that.",
        "Programs that read this file may move the joint with any acceleration. MoveIt's settings in a ROS 2 package have "
        "these limits all the same.",
        "For URDF, write version 1.2: `urdf: {version: 1.2}` in the sidecar, for readers that know it. In a simulator, "
        "limit the commands.",
    ),
    Code(
        "SB719",
        "note",
        "optical frame added for a camera",
        "ROS describes images in a frame with z forward, x right and y down (REP 103), and the frame of a camera has x forward and "
        "z up.",
        "The file has a frame `<camera>_optical_frame` beside the camera, and Gazebo names it with every image (`gz_frame_id`).",
        "No action is needed.",
    ),
    Code(
        "SB720",
        "warning",
        "joint split into single-axis joints",
        "The format has no such joint, or its parsers interpret it differently. It is written as several single-axis "
        "joints, connected by links without mass and geometry.",
        "Positions, masses and equations of motion are unchanged. The joints have other names, three joints in place "
        "of a ball have a singularity at a pitch of ±90 deg, collisions between parent and child are no longer "
        "excluded as those of neighbours, and MuJoCo rejects massless moving links in URDF (the MJCF has none).",
        "Use a format that supports the joint (`stepbot docs mapping`), or model it as single-axis joints with the actual "
        "masses of the intermediate links.",
    ),
    Code(
        "SB721",
        "warning",
        "ball joint limit, damping or spring not written",
        "The ball joint of the format does not support effort and velocity limits, damping, friction or springs.",
        "In this file, the joint moves more freely than that of the robot.",
        "Use a format that supports it (`stepbot docs mapping`), or add it in the simulator.",
    ),
    Code(
        "SB722",
        "note",
        "loop re-rooted at another joint",
        "A prismatic joint closes a loop, and the format has no such constraint. The loop is closed instead at a "
        "revolute, ball or fixed joint without limits, forces and actuator, and the prismatic joint becomes part of "
        "the tree.",
        "The mechanism is unchanged. The links between the two joints are attached in reverse order, and their frames "
        "are those of their new parent joints.",
        "No action is needed. To use the same tree in all formats, close the loop at this joint in the sidecar.",
    ),
    Code(
        "SB725",
        "note",
        "written as a format extension",
        "The format cannot represent this feature. It is written in an extension that some parsers read and others "
        "ignore: `<ros2_control>`, `<transmission>` and `<gazebo>` in URDF, `<plugin>` in SDFormat.",
        "Engines other than ROS and Gazebo ignore the extension. stepbot verifies it with its own parser, and counts "
        "these checks separately from those confirmed by engines.",
        "No action is needed for ROS and Gazebo, except to set the hardware plugin in `<ros2_control>`. For MuJoCo, "
        "use MJCF.",
    ),
    Code(
        "SB726",
        "note",
        "gear ratio folded into gains",
        "Actuators of the format act on the joint directly, without a gear ratio.",
        "Gains are converted to the joint side: kp and kv are multiplied by the square of the gear ratio. Inputs are "
        "positions, velocities and efforts of the joint, not of the motor.",
        "No action is needed. Convert with the gear ratio where your code uses motor units.",
    ),
    Code(
        "SB727",
        "warning",
        "sensor setting not written",
        "The format supports the sensor, but not its update rate or its range.",
        "A simulated image or scan may include objects outside the range of the real sensor, or arrive at another "
        "rate.",
        "Apply the rate and the range in the program that reads the sensor.",
    ),
    Code(
        "SB728",
        "warning",
        "torque reference point differs",
        "A force-torque sensor is offset from its joint origin, which is the torque reference point of the format's "
        "sensors.",
        "The torque differs by the cross product of the offset and the force.",
        "Remove `origin`, or convert the torque: tau_sensor = tau_joint - p x f.",
    ),
    Code(
        "SB729",
        "warning",
        "actuator limits not written",
        "An actuator has input limits narrower than those of its joint, and the format does not support them.",
        "In this file, the actuator can use the full range of the joint.",
        "Limit the input in the controller, or set these limits on the joint.",
    ),
    Code(
        "SB730",
        "note",
        "simulation settings not written",
        "The sidecar has settings under `simulation` that the format cannot represent.",
        "The loading program simulates with its own settings. `robot.simulation` in `report.json` has those of the "
        "sidecar. PyBullet and Drake have no setting that corresponds to `closure_stiffness`: PyBullet's point-to-point "
        "constraints ignore `erp`, and Drake's ball constraints have no stiffness.",
        "Set them after loading the file, such as `pybullet.setTimeStep`, or use MJCF.",
    ),
    Code(
        "SB731",
        "note",
        "loop written as mimics",
        "The format can only represent a tree. Passive joints of a loop that follow a driven joint along a straight line "
        "are written as mimics of it, with the largest deviation over the range that the loop allows.",
        "Programs that read mimics, such as RViz, move the mechanism as the loop does. Programs that simulate do not get "
        "the forces of the loop.",
        "No action is needed. `robot.followers` in `report.json` has the lines.",
    ),
    Code(
        "SB732",
        "note",
        "massless moving body gets a tiny mass",
        "A moving body without mass, as between the joints of a chain, is written with a mass that has no effect on the motion: "
        "MuJoCo rejects moving bodies without mass.",
        "The body has 1e-12 kg in MJCF, 0 in the other formats.",
        "No action is needed.",
    ),
    Code(
        "SB733",
        "note",
        "mesh format not used",
        "The sidecar asks for meshes in a format that readers of this description do not read.",
        "These meshes are OBJ for this description. Nothing else changes: colours are in the description.",
        "Set `mesh: {format: obj}`, or one that the table in `stepbot docs mapping` has for all formats that you write; "
        "`visual` and `collision` set it for one of both.",
    ),
    Code(
        "SB734",
        "note",
        "moving links without mass in a URDF",
        "A moving link has no mass, such as those between the joints that stand for a ball joint. URDF allows it, and stepbot writes "
        "a mass of 0; libsdformat, which converts a URDF for Gazebo, drops such links with all links below them.",
        "The file is right for other readers.",
        "For Gazebo, convert to SDFormat (`-f sdf`, `--gazebo`), or start the ROS 2 package with its `launch/gazebo.launch.py`, which "
        "gives these links 10 mg.",
    ),
    Code(
        "SB740",
        "note",
        "excluded contacts in a separate file",
        "URDF has no element for pairs of links whose contacts are excluded. They are in an SRDF beside it, which MoveIt "
        "reads.",
        "A reader of the URDF alone checks these pairs, and reports contacts between links that always overlap.",
        "Load the SRDF with the URDF, or exclude these pairs in the program that loads the URDF.",
    ),
    Code(
        "SB741",
        "warning",
        "stand-in mass for a massless link",
        "A link has no mass or no inertia. In the format, a mass or an inertia of 0 means that the simulator computes it "
        "from collision shapes, or takes 1 kg.",
        "The link gets 1 mg and 1e-9 kg m^2. The motion of the robot changes by as little as that, but a simulation with "
        "maximal coordinates needs smaller steps.",
        "Give the link its mass in the sidecar, or merge it with its parent.",
    ),
    Code(
        "SB742",
        "warning",
        "mimic not written",
        "A joint that turns mimics one that slides, or the other way round. The mimics of the format relate joints of the "
        "same type only.",
        "In this file, the joint moves on its own.",
        "Couple the joints in the simulator, or use MJCF or SDFormat.",
    ),
    Code(
        "SB743",
        "warning",
        "sensor not written",
        "The format has no such sensor, or each simulator has its own.",
        "The loaded robot does not measure this quantity.",
        "Add the sensor in the simulator. `robot.sensors` in `report.json` has its link, pose and settings.",
    ),
    Code(
        "SB744",
        "note",
        "collision mesh left to the simulator's decomposition",
        "A collision mesh is not convex or not closed. The file has the mesh, and asks for its convex decomposition, which "
        "the simulator computes when it loads the file.",
        "Contacts depend on the simulator, and loading takes longer. A simulator without decomposition uses the convex "
        "hull.",
        "Decompose the mesh in the sidecar (`collision: decompose`), or list primitives under `collision`.",
    ),
    Code(
        "SB745",
        "warning",
        "second actuator of a joint not written",
        "A joint has several actuators, and the format has one drive for each joint.",
        "In this file, the joint has the first of its actuators only.",
        "Add the others in the simulator, or leave out of the sidecar those that are not used there.",
    ),
    Code(
        "SB750",
        "warning",
        "limits that a hinge's stops cannot represent",
        "The stops of a hinge in Webots lie within ±180° and include 0. A joint has limits beyond, or that exclude 0.",
        "Only the motor of the joint keeps within the limits: its commands are clipped, and an external force can push the "
        "joint beyond. Without a motor the joint has no limits in this file.",
        "Shift the joint's zero into its range with `zero`, or use another format where the limits are hit.",
    ),
    Code(
        "SB751",
        "warning",
        "effort or velocity limit of a passive joint not written",
        "A joint without an actuator has an effort or a velocity limit, and only motors of the format have such limits.",
        "A simulation may move the joint faster.",
        "Remove the limits, or add an actuator to the joint.",
    ),
    Code(
        "SB752",
        "warning",
        "mimic written as coupled motors",
        "Webots has no mimic joints. Motors whose names have the same beginning before `::` get the same command, times their "
        "multiplier.",
        "The joint follows the command of the other joint's motor, not its position, without the offset, and with a motor of "
        "its own. If the other joint has no actuator, the joint does not follow.",
        "Command the joint from the controller where the offset matters.",
    ),
    Code(
        "SB753",
        "note",
        "actuator written as a motor with the simulator's controller",
        "A motor of Webots has a controller of its own, which takes positions, velocities or efforts.",
        "Gains kp and kv, and the kind of the actuator, are not in this file.",
        "Choose the kind of control in the controller, and set its gains with `wb_motor_set_control_pid`.",
    ),
)
