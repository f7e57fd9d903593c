"""SB45x and SB46x: kinematic structure of the sidecar, checked before the STEP file is read."""

from .code import Code

CODES = (
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
