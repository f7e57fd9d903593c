"""SB45x and SB46x: the mechanism that the sidecar's joints make, before the STEP is read."""

from .code import Code

CODES = (
    Code(
        "SB450",
        "error",
        "joint between a link and itself",
        "Both ends of a joint or closure are the same link.",
        "Nothing could move.",
        "Correct one of the two names.",
    ),
    Code(
        "SB451",
        "error",
        "link with two parents",
        "Two joints have the same child.",
        "Joints make a tree: each link hangs on one joint. URDF cannot say anything else, and PyBullet crashes on it.",
        "If the mechanism is a closed loop, make one of the joints a closure: move it to `closures` and name its links "
        "`link_a` and `link_b`.",
    ),
    Code(
        "SB452",
        "error",
        "cycle of joints",
        "Going from parent to child leads back to where it started.",
        "A tree has a root; links in a ring have none.",
        "Turn one of the joints around, or, if the mechanism is a closed loop, move one of them to `closures`.",
    ),
    Code(
        "SB453",
        "error",
        "links that are not connected",
        "More than one link has no joint above it, so there are several roots.",
        "A robot is one tree: a link without a joint would fall, or hang in the air, depending on the engine.",
        "Add the joint that is missing (`type: fixed` for what does not move), or give its parts to another link.",
    ),
    Code(
        "SB454",
        "error",
        "root is not the root",
        "`root` names a link that a joint moves.",
        "The root is what carries all others; joints point away from it.",
        "Name the link that no joint has as its child, or turn the joints around.",
    ),
    Code(
        "SB455",
        "error",
        "limits missing",
        "A revolute or prismatic joint has no `lower` or no `upper`.",
        "URDF requires both, and engines take a missing one for zero: the joint would not move.",
        "Add them to the joint or to `joint_defaults`. A joint that turns without end is `continuous`; an open end is "
        "`-inf` or `inf`.",
    ),
    Code(
        "SB456",
        "error",
        "limits swapped",
        "`lower` is not less than `upper`.",
        "No position is within such limits. MuJoCo ignores them, Drake aborts.",
        "Swap the two. A joint that shall not move is `fixed`.",
    ),
    Code(
        "SB457",
        "error",
        "drawn position outside the limits",
        "The position in which the CAD drew the joint, `zero` or 0 without it, is not within its limits.",
        "It is the initial pose: simulation would start with the joint pushed back by its own limit.",
        "Say with `zero` which position is drawn, or correct the limits. Limits are measured from where q = 0, not from "
        "the drawn pose.",
    ),
    Code(
        "SB458",
        "error",
        "mimic of itself",
        "A joint follows itself, directly or through others.",
        "No position would satisfy it but by chance.",
        "One joint of the group leads and has no `mimic`.",
    ),
    Code(
        "SB459",
        "error",
        "joint that cannot be driven or followed",
        "An actuator or a mimic names a joint that has no position of its own: it is fixed, has several freedoms, or "
        "already follows another joint.",
        "A drive and a mimic on the same joint pull against each other; a fixed joint does not move.",
        "Name the joint that leads, or a revolute, continuous, prismatic or screw joint.",
    ),
    Code(
        "SB460",
        "warning",
        "mimic leads beyond the limits",
        "Over the range of the joint that leads, the joint that follows leaves its own limits.",
        "Engines resolve the contradiction each in its own way: one stops the leader, another breaks the limit.",
        "Narrow the leader's limits, widen the follower's, or correct multiplier and offset.",
    ),
    Code(
        "SB461",
        "warning",
        "drawn pose contradicts a mimic",
        "With the positions in which the CAD drew them, the joint that follows is not where its mimic puts it.",
        "The initial pose breaks the constraint, and simulation starts with a jolt.",
        "Correct `offset`, or say with `zero` which positions are drawn.",
    ),
    Code(
        "SB462",
        "error",
        "axes of a universal joint are parallel",
        "`axis` and `axis2` of a universal joint have the same direction.",
        "It would turn about one axis only.",
        "Give `axis2` a direction at right angles to `axis`.",
    ),
    Code(
        "SB463",
        "warning",
        "limits to be filled in",
        "A joint has `limits: todo`, as `stepbot init` writes it: neither it nor `joint_defaults` says how far it moves.",
        "The joint moves without bounds: in URDF a revolute joint becomes continuous, and a prismatic one gets limits of "
        "+-1e9 m. A planner would turn it through its own cables.",
        "Replace `todo` by `{lower: ..., upper: ...}`, or give a joint that turns without end `type: continuous`.",
    ),
)
