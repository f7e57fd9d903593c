"""SB8xx: verification of written files in engines; SB86x and SB87x: conversion of a URDF, SDFormat or MJCF."""

from .code import Code

CODES: tuple[Code, ...] = (
    Code(
        "SB801",
        "error",
        "engine rejected the file",
        "A simulator or parser of the format reports that it cannot load the file. The file cannot be used "
        "with this engine.",
        "Read the engine's error in the message. After `convert`, please report a bug with the sidecar and the "
        "STEP file; `OUT.failed` has the rejected files. After `verify`, the file was edited: convert again.",
    ),
    Code(
        "SB802",
        "error",
        "engine crashed",
        "An engine crashed, was killed, or exceeded the time limit while loading the file. It ran in a separate "
        "process. Every program that loads the file with this engine is affected.",
        "The notes contain the signal and the last lines of output. Raise `--timeout` after a timeout. Loops, several "
        "roots and duplicate joint names are known to crash PyBullet.",
    ),
    Code(
        "SB803",
        "error",
        "file describes another robot",
        "What an engine reports of the file differs from what is expected, in the quantity that the message "
        "names: links, joints, limits, masses, poses, dynamics, meshes, actuators, sensors, the initial pose, "
        "or text of two files of one format.",
        "After `convert`, please report a bug with the sidecar and the STEP file; `OUT.failed` has the "
        "rejected files. After `verify`, the file was edited or describes another robot: convert again.",
    ),
    Code(
        "SB808",
        "error",
        "loop does not close",
        "A closure is missing or misplaced, or opens when the mechanism moves.",
        "After `convert`, please report a bug with the sidecar and the STEP file; `OUT.failed` has the "
        "rejected files. After `verify`, the file was edited: convert again.",
    ),
    Code(
        "SB810",
        "warning",
        "links overlap at the initial pose",
        "The collision shapes of two links without a common joint penetrate each other in the assembled pose "
        "(as modelled in CAD). Unless their contacts are excluded, a simulator pushes the links apart, and the "
        "robot jumps or vibrates.",
        "Convex hulls fill concave regions. Choose `collision: mesh` or a primitive for one of the links, or "
        "`none` where the pair never makes contact. If the parts overlap, correct the CAD.",
    ),
    Code(
        "SB811",
        "error",
        "simulation diverged",
        "In a passive simulation from the initial pose, the state became non-finite within a second. The robot cannot "
        "be simulated.",
        "Look for tiny masses on long arms, large damping on light links, or overlapping collision shapes (SB810).",
    ),
    Code(
        "SB812",
        "error",
        "engine warning on a written file",
        "An engine reports a warning while loading a file written by stepbot. Engines often continue with a "
        "default of their own, such as a mass of 1 kg.",
        "After `convert`, please report a bug with the sidecar and the STEP file; `OUT.failed` has the "
        "rejected files. After `verify`, the file was edited: convert again.",
    ),
    Code(
        "SB813",
        "warning",
        "engine warning",
        "An engine reports a warning while loading a file to verify. Engines often continue with a default of "
        "their own, such as a mass of 1 kg.",
        "Correct the cause of the warning.",
    ),
    Code(
        "SB814",
        "error",
        "not a robot description",
        "The file to verify is not XML, or its root element is not `robot` (URDF), `sdf` (SDFormat) or `mujoco` "
        "(MJCF). No engine can load the file.",
        "Pass a URDF, SDFormat or MJCF file.",
    ),
    Code(
        "SB815",
        "warning",
        "file not verified",
        "No installed engine supports this file, or none reports some quantities of it, which were not compared. A "
        "check that did not run does not count as passed.",
        "Install an engine for the format: `pip install mujoco`, `pip install pybullet`.",
    ),
    Code(
        "SB817",
        "warning",
        "self-collision not checked",
        "The collision shapes could not be tested against each other in the assembled pose. A check that did not run "
        "does not count as passed.",
        "See the notes for the reason.",
    ),
    Code(
        "SB818",
        "warning",
        "loop opens over its range",
        "A loop closes in the assembled pose (as modelled in CAD), but opens by more than a micrometre when "
        "the mechanism moves: axes that should be parallel or coplanar are slightly misaligned. A simulator "
        "keeps it closed with large forces, so the mechanism moves stiffly, vibrates or locks.",
        "Correct the CAD, or choose a closure with fewer constraints: `ball` allows the axes to tilt.",
    ),
    Code(
        "SB819",
        "warning",
        "mechanism is locked",
        "The closures constrain all degrees of freedom of the joints: by the rank of the constraints, nothing "
        "can move in the assembled pose.",
        "Either axes that should be parallel are more than 0.1 mrad apart, or the mechanism is modelled at a "
        "dead centre. Correct the CAD, or choose a closure with fewer constraints (`ball` in place of "
        "`revolute`).",
    ),
    Code(
        "SB820",
        "error",
        "unsafe robot description",
        "The file, or one that it includes, declares XML entities, includes a file from outside its folder, or "
        "refers to a pipe, a device or a socket. A foreign file could expose any file of this machine, fill "
        "its memory, or block an engine.",
        "Replace each entity by its text, and remove the DOCTYPE. Copy included files next to the file that "
        "includes them. Refer to regular files.",
    ),
    Code(
        "SB823",
        "error",
        "robot description cannot be read",
        "The URDF, SDFormat or MJCF to convert, to view, or given by `init --from` is invalid, or uses a feature that "
        "stepbot does not support. Nothing is written.",
        "Correct what the message names, where it names it. `stepbot verify FILE` shows what other readers report. "
        "Without `--from`, `init` drafts from the STEP alone.",
    ),
    Code(
        "SB824",
        "error",
        "robot description does not fit the STEP",
        "Neither the axes of its joints nor the vertices of its meshes were found in the assembly in any "
        "orientation. No sidecar is drafted.",
        "The description may be of another robot or revision, scaled, or without its meshes. Put the meshes at "
        "the paths given in the description. Without `--from`, `init` drafts from the STEP alone.",
    ),
    Code(
        "SB825",
        "warning",
        "parts of a robot description not shown",
        "`stepbot view` could not read a mesh of the description, or shows a joint or closure of an "
        "unsupported type otherwise than the file describes it.",
        "The notes list each one. Put missing meshes where the description names them, and convert meshes of "
        "other types to STL, OBJ, PLY, Collada or glTF.",
    ),
    Code(
        "SB830",
        "error",
        "drive test failed",
        "A robot driven in an engine by `stepbot drive` exceeds a limit of one of the tests, or the simulation "
        "diverged.",
        "The help names the usual remedy, the note the reason of the limit. `--plots DIR` draws the curves; "
        "`--limits FILE` sets limits for one robot. After a divergence, look for links that are lighter than "
        "their neighbours by orders of magnitude, for gains too large for the time step, and for missing "
        "armature.",
    ),
    Code(
        "SB832",
        "error",
        "engine cannot drive the robot",
        "An engine rejected the file, crashed or exceeded the time limit while it drove the robot, in a "
        "separate process.",
        "The message has the reason, the notes the last lines of output. Raise `--timeout` after a timeout; "
        "run `stepbot verify` on the file.",
    ),
    Code(
        "SB833",
        "error",
        "drive tests cannot start",
        "The target of `stepbot drive` is neither a sidecar, nor a folder that `stepbot convert` wrote, nor an "
        "MJCF or URDF in such a folder; or the file given by `--limits` cannot be read, names an unknown test "
        "or quantity, or has a limit without a reason.",
        "Convert the sidecar, then drive the folder: actuators, loops and limits are read from its "
        "`report.json`. A file of limits is an object `drive` with `tests`, `cube` [kg] and `limits`: "
        '`{"step": {"overshoot": [15, "reason"]}}`.',
        could_not_run=True,
    ),
    Code(
        "SB835",
        "error",
        "drive test does not apply",
        "A test that `--test` or the limits demand does not apply to the robot. The robot is not tested as intended.",
        "The message has the reason: add the actuator or limit that is missing, if one is, or remove the demand.",
    ),
    Code(
        "SB860",
        "warning",
        "part of the source not converted",
        "An element or attribute of the converted URDF, SDFormat or MJCF has no counterpart in stepbot's model. It is "
        "absent from the written files. The note states the physical consequence, where there is one.",
        "Add it to the written files by hand if it matters. `--ignore SB860` confirms that none of them do.",
    ),
    Code(
        "SB861",
        "error",
        "part of the source cannot be converted",
        "A mesh of a URDF, SDFormat or MJCF cannot be found or read; or a joint, mimic or closure is of a type "
        "that stepbot's model does not have, or does not belong to one tree of links.",
        "Of a mesh: put it where the file names it, name the folder of its package with `--package-path`, or "
        "convert it to STL, OBJ, PLY, Collada or glTF. Of a joint, mimic or closure: let it follow a joint that moves "
        "by itself, and express motion by the types in `stepbot docs sidecar`.",
    ),
    Code(
        "SB863",
        "warning",
        "actuator or sensor of the source not converted",
        "An actuator or sensor of the converted file is of a type that stepbot's model does not have, or moves "
        "something else than one joint, and is not written; or the range of its force, speed or control is not "
        "symmetric, and the narrower side is written for both directions (the other if that is 0); or a "
        "position actuator takes inputs beyond the limits of its joint, where its inputs end now.",
        "Add it to the written files by hand, or express it by a position, velocity or motor actuator of a joint.",
    ),
    Code(
        "SB864",
        "note",
        "names or links changed",
        "A name in the converted file is reserved, contains characters that a format cannot hold, is missing, "
        "or is used twice; controllers and scripts must use the new name. Or the file moves a link by several "
        "joints, has a joint beside the origin of its link, or links without a joint to the others: links "
        "without mass or fixed joints are added. All links of the source keep their frames.",
        "No action is needed. To choose a name, change it in the source.",
    ),
    Code(
        "SB866",
        "warning",
        "inertia without mass",
        "A link of the converted file has an inertia, but no mass. No body has that; it is not written. Engines differ "
        "in what they make of it: some reject it, some ignore it, some add it to the neighbouring link.",
        "Give the link a mass, or remove its inertia.",
    ),
    Code(
        "SB867",
        "warning",
        "source not confirmed",
        "No engine could read the converted file, which stepbot's own reading alone confirms; or the file "
        "lacks the mass properties of a link, and those that its format defines are written; or a URDF has "
        "planar or floating joints, which engines fix, reject or name differently and read as several single "
        "joints.",
        "Install an engine that reads the format (`pip install stepbot[verify]`), or give the missing values "
        "in the source.",
    ),
    Code(
        "SB870",
        "warning",
        "initial position outside the limits",
        "The initial position of a joint in the converted file, 0 unless stated, is outside the joint's "
        "limits, or is not where its mimic puts it. The written files start at the nearest limit.",
        "State an initial pose within the limits: in MJCF the keyframe `home`.",
    ),
    Code(
        "SB872",
        "warning",
        "looks of meshes not converted",
        "A mesh of the converted file has textures, colours of vertices, or materials in a file of its own "
        "(MTL), which stepbot does not read. The visual has the colour of the description, or is grey.",
        "Give the visual a colour in the description, or convert the mesh to Collada or glTF with plain materials.",
    ),
    Code(
        "SB874",
        "warning",
        "missing value of the source assumed",
        "`base`: a URDF does not say whether its root link is fixed to the world, and is taken as fixed. "
        "`gains`: a position or velocity actuator has none, and gets those of `gains: auto`, from the inertia "
        "and weight that it moves. `limit`: a `<limit>` without `lower` or `upper` has 0 for it, as the format "
        "defines; without both, the joint is unlimited (ROS rejects the file or locks the joint). `mass`: "
        "`--assume-inertia` computes the mass properties of a link from its collisions, or else its visuals, "
        "as solids; meshes that are not closed count as their convex hulls, a stated mass and com are kept, "
        "and hollow parts become too heavy.",
        "State the value in the source: `kp` and `kv` of the command interface, `lower` and `upper`, type "
        "`continuous`, measured mass properties; the base with `--base floating` or `--base fixed`, or a root "
        "link named `world`.",
        features="base gains limit mass",
    ),
    Code(
        "SB877",
        "error",
        "macros cannot be expanded",
        "The file has macros of ROS (xacro), and one of them cannot be expanded: an expression or an argument "
        "is wrong, a package or a file is not found, or xacro is not installed. Expressions reach numbers, "
        "texts and lists alone; files are read in the package of the file, and in packages that it names.",
        "Correct the place, state arguments with `--xacro NAME:=VALUE`, and name folders of packages with "
        "`--package-path DIR`. A file that needs more is expanded by ROS first: `xacro robot.urdf.xacro -o "
        "robot.urdf`.",
    ),
    Code(
        "SB876",
        "warning",
        "newer than the version that the file states",
        "A URDF has a rotation as `quat_xyzw`, a capsule, or a limit of acceleration or jerk, which later "
        "versions of the format added, and states an earlier version, or none, which means 1.0. stepbot reads "
        "it as the later version. ROS ignores it: a rotation becomes none, and a link with a capsule loses the "
        "shape.",
        'State the version in the file: `<robot version="1.1">`, or 1.2 for limits of acceleration and jerk.',
    ),
)
