"""SB8xx: verification of written files in engines."""

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
        "`stepbot verify FILE` shows what each engine reports. Without `--from`, `init` drafts from the STEP alone.",
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
)
