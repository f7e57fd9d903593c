"""SB86x: conversion of a URDF, SDFormat or MJCF to other formats."""

from .code import Code

CODES: tuple[Code, ...] = (
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
        "Put the mesh where the file names it, name the folder of its package with `--package-path`, or "
        "convert it to STL, OBJ, PLY, Collada or glTF. Express motion by the types of joints and closures in "
        "`stepbot docs sidecar`.",
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
