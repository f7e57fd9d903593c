"""SB7xx: what a format cannot say."""

from .code import Code

CODES: tuple[Code, ...] = (
    Code(
        "SB701",
        "warning",
        "loop closure left out",
        "The robot has closed loops, and the format can only hold a tree of links and joints.",
        "The file moves like a mechanism whose closing pins were pulled out. `report.json` keeps the closures, so that "
        "a simulation can add them as constraints.",
        "Use the SDFormat or the MJCF where the loop matters, or leave this format out with `-f`.",
    ),
    Code(
        "SB703",
        "warning",
        "passive force of a joint left out",
        "A joint has a spring or an armature (reflected inertia of its drive), and the format has no place for it.",
        "The joint moves differently there: a spring that is missing pushes nothing back, an armature that is missing "
        "makes the joint lighter. Damping that was chosen beside an armature can then be too much: PyBullet becomes "
        "unstable where damping x time step exceeds twice the inertia that is left.",
        "Use a format that has it (`docs/mapping.md`), or add it in the simulator; or give the drag of a motor as its "
        "actuator's `kv` and not as the joint's damping.",
    ),
    Code(
        "SB704",
        "note",
        "number in place of a missing limit",
        "A joint has no limit where the format demands a number, so that one is written that no robot reaches.",
        "The number means `none`; a planner that takes it for the truth will plan with it.",
        "Write the real limits of the joint into the sidecar (`limits: {lower, upper, effort, velocity}`).",
    ),
    Code(
        "SB705",
        "note",
        "velocity limit kept as plain data",
        "The format has no velocity limit for joints; the value is in the file as custom data that no engine enforces.",
        "A simulation may drive the joint faster than its limit.",
        "Limit the velocity in the controller.",
    ),
    Code(
        "SB706",
        "note",
        "initial pose not in the file",
        "The CAD drew the robot in a pose that is not q = 0, and the format cannot say in which pose a robot starts.",
        "Simulators start it at q = 0. `report.json` has the drawn position of every joint.",
        "Set the joint positions after loading where it matters.",
    ),
    Code(
        "SB707",
        "note",
        "base attachment not in the file",
        "The format cannot say whether the root link is fixed to the world or floats.",
        "Whoever loads the file decides: PyBullet by `useFixedBase`, Drake by welding, others by a habit of their own.",
        "Tell the loader what the sidecar says under `base`.",
    ),
    Code(
        "SB708",
        "note",
        "frames written as links",
        "The format has no frames; each is written as a link without mass on a fixed joint, as is the custom there.",
        "The file has more links than the robot. Their inertia is written as zero, because some engines take a link "
        "without `<inertial>` for one of 1 kg.",
        "Nothing to do.",
    ),
    Code(
        "SB709",
        "note",
        "shape written as several",
        "The format lacks a kind of shape, which is written as several others that fill exactly the same space.",
        "Nothing is lost, but the file has more shapes than the robot.",
        "Nothing to do.",
    ),
    Code(
        "SB710",
        "warning",
        "name changed",
        "A joint, closure or frame has a name that is taken already, where the format wants one name for one thing.",
        "Scripts that use the name find something else in this format than in the others.",
        "Give them different names in the sidecar.",
    ),
    Code(
        "SB711",
        "warning",
        "zero of a joint moved",
        "A joint of a closed loop was drawn at another position than q = 0. The format places a closing joint by the "
        "pose in which the file describes the robot, and that must be one in which the loop closes.",
        "In this format q = 0 of these joints is the drawn pose; limits, mimics and springs are moved along.",
        "Leave `zero` out of the joints of the loop, or add the drawn position when you read these joints.",
    ),
    Code(
        "SB712",
        "warning",
        "flat collision mesh left out",
        "A collision mesh lies in a plane, and the engine makes no convex hull of it.",
        "MuJoCo would refuse the whole file. In this format nothing touches that surface.",
        "Give the component a collision shape with some thickness (`collision: box`), or `collision: none`.",
    ),
    Code(
        "SB713",
        "error",
        "kind of closure not written",
        "The robot has a closure of a kind that stepbot does not write to this format.",
        "Without the closure the file would describe another robot.",
        "Close the loop at another of its joints, or leave the format out with `-f`.",
    ),
    Code(
        "SB714",
        "error",
        "reserved name",
        "A link, joint or frame has a name that means something else to the format.",
        "Readers refuse the file, or take a link called `world` for the world itself.",
        "Choose another name in the sidecar.",
    ),
    Code(
        "SB715",
        "note",
        "newer version of the format",
        "The robot needs something that the format has only had since a later version than the one usually written.",
        "Older readers complain about the version, and take no notice of what is new.",
        "Nothing to do for current readers.",
    ),
    Code(
        "SB716",
        "note",
        "chain of mimics made flat",
        "A joint mimics one that itself mimics another, and many readers of the format follow only one step.",
        "In the file every mimic refers to the joint that leads the chain, with multiplier and offset to match: the "
        "motion is the same.",
        "Nothing to do.",
    ),
    Code(
        "SB717",
        "warning",
        "collision mesh taken for its hull",
        "A collision mesh is not convex, or not closed, and the engine of the format fills it up to its convex hull.",
        "What should fit into a hole or between two fingers does not.",
        "Give the component several convex shapes: split it into parts in the CAD, or list primitives under `collision`.",
    ),
    Code(
        "SB720",
        "warning",
        "joint split into several",
        "The format has no joint of this kind, or its readers do not agree on it. Several joints of one freedom stand "
        "for it, with links between them that have neither mass nor shape.",
        "Positions, masses and equations of motion are the same, but the joint has other names and more of them, three "
        "joints for a ball lock where pitch is ±90 deg, parent and child no longer count as neighbours that do not "
        "touch, and MuJoCo refuses moving links without mass when it reads URDF (its own MJCF has none of them).",
        "Use a format that has the joint (`docs/mapping.md`), or describe it by joints of one freedom yourself, with "
        "the masses that are really between them.",
    ),
    Code(
        "SB721",
        "warning",
        "limit or passive force of a ball joint left out",
        "The format's ball joint has no place for a limit of effort or velocity, or for damping, friction or a spring.",
        "The joint moves more freely there than the robot's does.",
        "Use a format that has it (`docs/mapping.md`), or add it in the simulator.",
    ),
    Code(
        "SB722",
        "note",
        "loop cut at another joint",
        "A prismatic joint closes a loop, and the format has no such constraint. The loop is cut at a pin, a ball or a "
        "weld of it instead, which has neither limits nor forces nor a drive; the prismatic joint is part of the tree.",
        "The mechanism is the same. Links on the way between the two joints hang the other way round, and have the "
        "frames of the joints that are above them now.",
        "Nothing needs to be done; to have the same tree in all formats, close the loop at the pin in the sidecar.",
    ),
    Code(
        "SB725",
        "note",
        "said in an extension of the format",
        "The format itself has no place for this; it is said in a block that some of its readers know and the others pass "
        "over: `<ros2_control>`, `<transmission>` and `<gazebo>` in URDF, `<plugin>` in SDFormat.",
        "Engines that are not ROS or Gazebo do not see it. stepbot reads these blocks back with a parser of its own, and "
        "counts that apart from what engines confirm.",
        "Nothing needs to be done for ROS and Gazebo; name your hardware's plugin in `<ros2_control>`. For MuJoCo use the MJCF.",
    ),
    Code(
        "SB726",
        "note",
        "gear multiplied into an actuator",
        "The format's actuators act on the joint itself, without a gear.",
        "Gains are those at the joint, kp and kv times the square of the gear. Inputs are positions, velocities and "
        "efforts of the joint, not of the drive.",
        "Nothing needs to be done; divide or multiply by the gear where you think in units of the drive.",
    ),
    Code(
        "SB727",
        "warning",
        "setting of a sensor left out",
        "The format has the sensor, but no place for its rate, or for the range in which it sees.",
        "A simulated picture or scan shows what the real sensor would not see, or comes at another rate.",
        "Ask for pictures at that rate and leave out what is too near or too far, in the program that uses them.",
    ),
    Code(
        "SB728",
        "warning",
        "torque about another point",
        "A force-torque sensor is away from the origin of its joint, where the format's sensors count torques about.",
        "The torque differs by the cross product of the way between both points with the force.",
        "Leave `origin` out, or carry the torque over by hand: tau_sensor = tau_joint - p x f.",
    ),
    Code(
        "SB729",
        "warning",
        "bounds of an actuator left out",
        "An actuator has bounds of its own for its input, narrower than those of its joint, and the format has no place "
        "for them.",
        "There it can be told to go as far, or to push as hard, as the joint can.",
        "Bound the input in the controller, or give the joint these limits.",
    ),
)
