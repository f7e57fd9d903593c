"""SB4xx: kinematics: tree, loops, axes, limits; SB45x and SB46x before the STEP file is read."""

from .code import Code

CODES = (
    Code(
        "SB401",
        "error",
        "no shared axis",
        "No axis matches the cylindrical faces that the origin requires. Without an axis the position of the joint is "
        "undefined.",
        "The notes list axes that nearly coincide, which suggests a misplaced part. Correct the CAD, or define the "
        "origin with `axis_of`, `center`, `component` or coordinates. `stepbot inspect --between A B` lists the axes "
        "shared by two components.",
    ),
    Code(
        "SB402",
        "error",
        "ambiguous axis",
        "Several axes match, and none is at least twice as wide as the next. Bolt circles resemble bearings. Selecting "
        "the wrong axis would misplace the joint.",
        "Add `radius` or `near` to the origin. The help contains an origin to paste for each axis.",
    ),
    Code(
        "SB403",
        "error",
        "circular frame reference",
        "The origin of a joint is relative to a link whose own frame depends on that joint. The frames depend on each "
        "other, so none of them can be computed.",
        "Define one of the origins relative to the assembly or to a component.",
    ),
    Code(
        "SB404",
        "error",
        "component has no bounding box",
        "An origin refers to the center of a component that has no geometry. The center is that of the bounding box, "
        "which requires geometry.",
        "Refer to a component that contains a body.",
    ),
    Code(
        "SB405",
        "error",
        "link has no components",
        "`auto` searches for an axis shared by the components of two links, and one of the links has no components. "
        "There are no faces to search.",
        "Add `parts` to the link, or define the origin without its faces: `axis_of` a component of the other link, "
        "`component`, `center` or coordinates.",
    ),
    Code(
        "SB406",
        "error",
        "coaxial faces without contact",
        "The two sides have coaxial cylindrical faces, but no shaft fits a bore, and no faces overlap or touch "
        "along the axis. Parts of a straight arm share many axes, and no engine detects a joint on the wrong "
        "one.",
        "Check which parts carry the axis: the pin or the bearing often belongs to another link. If one of the "
        "listed axes is correct, paste its origin: an explicitly selected axis is accepted with any gap.",
    ),
    Code(
        "SB407",
        "warning",
        "weak evidence for an axis",
        "The faces on the axis overlap or touch but do not fit, a wider axis has faces in contact, or the "
        "joint still has the REVIEW comment of a draft without a fit. The axis may be correct, for example "
        "where the CAD omits a bearing, or a coincidence.",
        "Check the axis in the joint table. Paste the origin of the correct axis into the sidecar, and remove "
        "the REVIEW comment of a draft.",
    ),
    Code(
        "SB411",
        "error",
        "closure does not close",
        "The two sides of a closure do not meet in the assembled pose (as modelled in CAD). A simulator would pull the "
        "loop together with a large force at the start.",
        "Check `zero` of the joints in the loop, and the origin of the closure.",
    ),
    Code(
        "SB414",
        "error",
        "non-finite or excessive number",
        "A pose, an axis, a mass, a limit or a dimension of the robot is NaN, infinite or beyond 1e30 in SI units, or "
        "a position is beyond 1e6 m. Only limits may be infinite. Engines cannot load the file, or compute with "
        "infinite numbers.",
        "Check the numbers in the named section of the sidecar. If they are correct, please report a bug.",
    ),
    Code(
        "SB415",
        "error",
        "axis or rotation not normalized",
        "An axis does not have unit length, or a rotation matrix is not orthonormal. Engines would scale or shear the "
        "links attached to it.",
        "Check the axis in the sidecar. If it is correct, please report a bug.",
    ),
    Code(
        "SB417",
        "error",
        "unresolved reference",
        "A joint, closure, frame, actuator or shape refers to an element that the robot does not have. Engines cannot "
        "load the file.",
        "Correct the name in the sidecar. If it is correct, please report a bug.",
    ),
    Code(
        "SB418",
        "error",
        "contact sensor without collision geometry",
        "A contact sensor is mounted on a link that has no collision geometry. The link makes no contact in "
        "simulation, and the formats require the name of a collision shape.",
        "Give the link collision geometry, mount the sensor on another link, or remove it.",
    ),
    Code(
        "SB420",
        "warning",
        "robot larger than 20 m",
        "The robot, or for `inspect` and `init` the assembly, is larger than 20 m. A wrong length unit in the "
        "STEP file scales everything by a factor of 25 or 1000.",
        "Check the unit of the CAD export, or the dimensions of collision shapes where the message names them. "
        "If the size is correct, no action is needed.",
    ),
    Code(
        "SB421",
        "warning",
        "assembly probably not z-up",
        "The base of the robot has a large flat face perpendicular to an axis other than z, with a joint along "
        "it, and none perpendicular to z; along z the assembly is at most 1.5 times as long. In robot files z "
        "is up: a robot drawn with y up would lie on its side.",
        "Set the axis that is up: `root: {up: y}`. If z is up, confirm it with `root: {up: z}`.",
    ),
    Code(
        "SB422",
        "warning",
        "axis not along the line of its origin",
        "The origin of a turning joint or closure is on the line of cylindrical faces, with z of its frame "
        "along that line, and `axis` names another direction of this frame. The joint turns about a line "
        "across the shaft. Every check of the files passes, because all have the same axis.",
        "Write `axis: z` or `axis: -z`. To turn the frame first, use `offset: {rpy: [...]}`. Directions in the "
        "joint table of `stepbot check --step` are in the STEP's frame, and no values for `axis`.",
    ),
    Code(
        "SB423",
        "warning",
        "axis far from the assembly",
        "The axis of a turning joint is farther from the assembly than the assembly is large. Its coordinates "
        "are probably in another unit or frame: `xyz: [0, 4, 8]` is 8 m, not 8 inches. Every check of the "
        "files passes, because all have the same axis.",
        "Write coordinates with their unit, in the frame of the assembly: `xyz: [0, 4 in, 8 in]`. `stepbot "
        "inspect --features` lists the axes of parts; `axis_of` and `mate` need no coordinates.",
    ),
    Code(
        "SB450",
        "error",
        "links and joints are not a tree",
        "A joint connects a link to itself, a link has two parents, joints form a cycle, the root has a "
        "parent, or links are not connected to it (`disconnected`). The formats require a tree of joints, in "
        "which each link but the root has one parent joint; PyBullet crashes on other files.",
        "Move the joint that closes a loop to `closures`, with its links as `link_a` and `link_b`, or swap "
        "parent and child of a joint. Add the missing joint (`type: fixed` for a rigid connection). Set `root` "
        "to the link that is not the child of any joint.",
        features="disconnected",
    ),
    Code(
        "SB455",
        "error",
        "missing limits",
        "A revolute or prismatic joint has no `lower` or no `upper` limit. URDF requires both. Engines default to "
        "zero, which locks the joint.",
        "Add the limits to the joint or to `joint_defaults`. Use `type: continuous` for unlimited rotation, and `-inf` "
        "or `inf` for an unbounded side.",
    ),
    Code(
        "SB456",
        "error",
        "invalid limits",
        "`lower` is greater than or equal to `upper`, or a limit of velocity or effort is negative. The range is "
        "empty: depending on the engine, the joint becomes free or locked, or the file is rejected.",
        "Swap the limits. Use `type: fixed` for a joint that does not move.",
    ),
    Code(
        "SB457",
        "error",
        "assembled position outside limits",
        "The joint position in the assembled pose (as modelled in CAD; `zero`, default 0) is outside the joint "
        "limits. The assembled pose is the initial pose, from which the limit would push the joint back.",
        "Set `zero` to the joint position in the assembled pose, or correct the limits. Limits are measured "
        "from q = 0, not from the assembled pose.",
    ),
    Code(
        "SB458",
        "error",
        "circular mimic",
        "A joint mimics itself, directly or through other joints. The positions of these joints are undefined.",
        "Remove `mimic` from one joint of the group, which becomes the leader.",
    ),
    Code(
        "SB459",
        "error",
        "joint cannot be actuated or mimicked",
        "An actuator or a mimic refers to a joint without an independent position: a fixed joint, a joint with several "
        "degrees of freedom, or a joint that mimics another joint. An actuator on a mimic joint works against the "
        "mimic constraint, and a fixed joint does not move.",
        "Refer to the leading joint, or to a revolute, continuous, prismatic or screw joint.",
    ),
    Code(
        "SB460",
        "warning",
        "mimic conflicts with limits or pose",
        "Over the range of the leading joint, the mimic joint exceeds its own limits, which engines resolve "
        "differently; or its position in the assembled pose (as modelled in CAD) is not that of its mimic "
        "relation, so that the simulation starts with a jump.",
        "Narrow the limits of the leading joint, widen those of the mimic joint, correct `multiplier` and "
        "`offset`, or set `zero` to the joint positions in the assembled pose.",
    ),
    Code(
        "SB462",
        "error",
        "parallel axes of a universal joint",
        "`axis` and `axis2` of a universal joint are parallel. The joint would rotate about a single axis.",
        "Set `axis2` to a direction perpendicular to `axis`.",
    ),
    Code(
        "SB463",
        "warning",
        "placeholder limits",
        "A joint has `limits: todo`, the placeholder written by `stepbot init`, and `joint_defaults` does not set its "
        "limits. The joint is unlimited. In URDF, a revolute joint becomes continuous and a prismatic joint gets "
        "limits of +-1e9 m. A planner may rotate the joint beyond what the cables allow.",
        "Replace `todo` by `{lower: ..., upper: ...}`, or set `type: continuous` for unlimited rotation.",
    ),
    Code(
        "SB464",
        "warning",
        "actuator too weak for its joint",
        "The effort limit of an actuator with `gains: auto`, or of its joint, is below what the weight needs "
        "in the drawn pose. The joint falls.",
        "Correct the effort limit, the masses or the drawn pose. If a spring or a counterweight carries the "
        "joint, set `kp` and `kv`.",
    ),
    Code(
        "SB465",
        "warning",
        "limit beyond a stop",
        "Parts of the two links of a joint meet between the drawn pose and a limit, as `check --step` finds "
        "along the motion of their meshes (not for parts with very many faces). A planner that uses the limit "
        "drives the joint into the stop.",
        "Set the limit at the stop or before it. If the parts overlap in the drawing only, such as a screw in "
        "a solid block, correct the drawing, or ignore the finding.",
    ),
)
