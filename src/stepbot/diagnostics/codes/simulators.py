"""SB8xx: a simulator disagrees with the model."""

from .code import Code

_WHY = "Whoever simulates with this file simulates another robot than the one that the CAD holds."
_OURS = (
    "If stepbot wrote the file, please report it with the sidecar and the STEP file; the file is kept for inspection. If "
    "the file was edited since, convert again."
)

CODES: tuple[Code, ...] = (
    Code(
        "SB801",
        "error",
        "engine refuses the file",
        "A simulator or parser that reads the format says that it cannot load this file.",
        "The file is of no use to anybody who simulates with that engine.",
        "Read the engine's own words in the message. " + _OURS,
    ),
    Code(
        "SB802",
        "error",
        "engine died on the file",
        "An engine crashed, was killed, or took too long while it loaded the file. It ran in a process of its own.",
        "The same happens to every program that loads the file with that engine.",
        "Look at the notes for the signal and the last lines that the engine printed; raise `--timeout` if it ran out of "
        "time. Loops, several roots and joints with the same name are known to crash PyBullet.",
    ),
    Code(
        "SB803",
        "error",
        "links or joints differ",
        "An engine sees other links or joints in the file than there should be: a name, a kind, a parent, the base.",
        _WHY,
        _OURS,
    ),
    Code(
        "SB804",
        "error",
        "joint properties differ",
        "The axis, the limits, the damping or friction, or the mimic relation of a joint is not what it should be.",
        _WHY,
        _OURS,
    ),
    Code(
        "SB805",
        "error",
        "mass properties differ",
        "The mass, centre of mass or inertia of a link is not what it should be.",
        _WHY,
        _OURS,
    ),
    Code(
        "SB806",
        "error",
        "poses differ",
        "In some configuration of the joints a link, or a frame on it, is not where it should be.",
        _WHY,
        _OURS,
    ),
    Code(
        "SB807",
        "error",
        "dynamics differ",
        "The mass matrix or the gravity forces that an engine computes are not those of the robot.",
        "Controllers that are tuned on this file are tuned for another robot.",
        "If masses and poses agree, the engine changes them on loading. " + _OURS,
    ),
    Code(
        "SB808",
        "error",
        "loop does not close",
        "A closure is missing, is somewhere else than it should be, or opens when the mechanism moves.",
        "The mechanism moves differently, or not at all.",
        _OURS,
    ),
    Code(
        "SB809",
        "error",
        "meshes differ",
        "A mesh is missing, or what an engine loaded has another extent than it should have.",
        "What is seen or touched is not the robot: a unit, a scale or a path is wrong.",
        "Keep the `meshes` folder beside the file. " + _OURS,
    ),
    Code(
        "SB810",
        "warning",
        "links overlap",
        "In the drawn pose the collision shapes of two links that no joint holds together penetrate each other.",
        "A simulator pushes them apart with great force, so that the robot jumps or trembles, unless it ignores this pair.",
        "Convex hulls fill hollows: choose `collision: mesh`, `decompose` or a primitive for one of them, or `none` where "
        "the pair never meets. If the parts themselves overlap, correct the CAD.",
    ),
    Code(
        "SB811",
        "error",
        "simulation diverges",
        "Let go from its initial pose without control, the robot does not stay finite for a second.",
        "Nothing can be simulated with it.",
        "Look for tiny masses on long arms, great damping on light links, or overlapping collision shapes (SB810).",
    ),
    Code(
        "SB812",
        "error",
        "engine warns about a written file",
        "An engine loads a file that stepbot wrote, but not without complaint.",
        "Engines that complain mostly go on with a guess of their own, such as a mass of 1 kg.",
        _OURS,
    ),
    Code(
        "SB813",
        "warning",
        "engine warns about a file",
        "An engine loads a file, but not without complaint.",
        "Engines that complain mostly go on with a guess of their own, such as a mass of 1 kg.",
        "Correct what the engine complains about.",
    ),
    Code(
        "SB814",
        "error",
        "not a robot description",
        "A file to verify is not XML, or its first element is none of `robot` (URDF), `sdf` (SDFormat), `mujoco` (MJCF).",
        "No engine could read it.",
        "Name a URDF, SDFormat or MJCF file.",
    ),
    Code(
        "SB815",
        "warning",
        "file not verified",
        "No engine that is installed reads this file, so nothing was compared.",
        "A check that did not run is not a check that passed.",
        "Install an engine that reads it: `pip install mujoco`, `pip install pybullet`.",
    ),
    Code(
        "SB816",
        "error",
        "actuators, sensors or initial pose differ",
        "An actuator, a sensor, or the pose in which the file says that the robot starts, is not what it should be.",
        "Controllers find another robot, or find it elsewhere.",
        _OURS,
    ),
    Code(
        "SB817",
        "warning",
        "self-collision not checked",
        "The collision shapes could not be tested against each other in the drawn pose.",
        "A check that did not run is not a check that passed.",
        "Look at the notes for the reason.",
    ),
    Code(
        "SB818",
        "warning",
        "loop cannot stay closed",
        "A loop closes as drawn, but opens by more than a micrometre when the mechanism moves.",
        "Pins that should be parallel, or in one plane, are not quite. Simulators hold such a loop by force: it runs stiffly, "
        "trembles, or locks.",
        "Correct the CAD, or choose a closure that holds less: `ball` leaves the pins free to tilt.",
    ),
    Code(
        "SB819",
        "warning",
        "mechanism cannot move",
        "The closures take all freedom from the joints: by the rank of the constraints nothing can move in the drawn pose.",
        "A gripper or linkage that should move is a rigid frame for every simulator.",
        "Axes that should be parallel are more than 0.1 mrad apart, or the mechanism was drawn at a dead centre: correct the "
        "CAD, or choose a closure that holds less (`ball` in place of `revolute`).",
    ),
    Code(
        "SB820",
        "error",
        "XML entities in a robot description",
        "The file, or one that it includes, declares XML entities in its DOCTYPE.",
        "Engines differ in what they take entities for: some leave them as they are, some expand them, and a few lines of "
        "them can stand for gigabytes. So no two engines read the same robot.",
        "Write the text itself in place of each entity, and remove the DOCTYPE.",
    ),
    Code(
        "SB821",
        "error",
        "include from outside of the folder",
        "The MJCF includes a file that is not in its own folder or below.",
        "Engines read whatever an include names, so a file from somebody else could have them read any file of yours.",
        "Copy the included file beside the one that includes it, or write a file in a folder above both that includes both.",
    ),
    Code(
        "SB822",
        "error",
        "reference to something that is no regular file",
        "The file names a pipe, a device or a socket as an include, a mesh or a texture.",
        "An engine that opens it waits until its time is up, or reads without end.",
        "Name a regular file.",
    ),
)
