"""Why some removals and changes in a file are not noticed."""

import re

_PYBULLET = (
    (r"link/(visual|collision)@name", "PyBullet keeps no names of shapes"),
    (r"inertia/i..|inertial/inertia", "PyBullet makes inertias of the collision shapes in SDFormat"),
    (r"sdf@version", "PyBullet reads all versions alike"),
    (r"(model/frame|frame/).*", "PyBullet reads no frames"),
    (r"(axis/mimic|mimic/).*", "PyBullet reads no mimics"),
    (r"dynamics/spring_.*|axis/dynamics", "PyBullet reads no springs"),
    (
        r"limit/(effort|velocity)",
        "PyBullet reads no effort and velocity limits of joints that turn without end, be it to one side",
    ),
    (r"limit/lower", "0, which PyBullet takes for a lower limit that is not there; or of a joint that closes a loop"),
    (
        r"model/joint.*|joint/(parent|child|pose)|axis2?/limit|limit/upper",
        "PyBullet reads a copy without the joint to the world and those that close loops",
    ),
)
"""What the engine of the core install alone does not notice in SDFormat: kind of removal, and reason."""

_SDFORMAT = (
    (r"inertia/i..", "far below the precision of the largest moment: rounding of a sum of parts"),
    (r"inertial/pose", "zero: a link that weighs nothing, or whose centre of mass is its origin"),
    (r"(axis/mimic|mimic/).*", "Drake does not read mimics"),
    (r"axis2?/xyz|joint/axis2?", "z, which is what readers take where no axis is"),
    (r"model/frame@attached_to", "attached to the first link, which is what readers take where nothing is named"),
    (r"model/ball_constraint", "one of two that hold a pin: in a plane, a point is enough"),
    (
        r"model/joint.*|joint/(parent|child|pose)",
        "of a joint that closes a loop: PyBullet reads a copy without it, and Drake another file",
    ),
    (
        r"limit/(lower|upper)",
        "1e16, which means no limit, as nothing does; or of a screw, which Drake bounds in no way",
    ),
    (
        r"limit/(effort|velocity)",
        "Drake reads neither of universal joints, and no velocity limit of screws",
    ),
    (
        r"axis2?/limit",
        "1e16, which means no limit, as nothing does; or effort and velocity of a universal joint, unread by Drake",
    ),
    (r"dynamics/friction", "Drake has no joint friction"),
)
_MJCF = (
    (r"actuator/\w+@name", "a drive without a name is taken for the one on its joint"),
    (r"body/freejoint@name", "what lets a base float is no joint of the robot"),
    (r"body/geom@pos", "at the link's origin, but for the rounding of a product of poses"),
    (r"frame/replicate@sep", "names of rays alone"),
    (r"mujoco/keyframe|keyframe/key.*", "all joints are drawn at zero, which is where MuJoCo starts by itself"),
    (r"key/.*|keyframe/key@ctrl", "what the drives hold in the keyframe is not compared"),
    (r"equality/connect.*", "one of two that hold a pin: in a plane, a point is enough"),
    (r"body/joint@(pos|axis|type)", "at the origin, about z, or a hinge, which is what MuJoCo takes by itself"),
    (r"body/site@quat", "how the site of a point is turned, which holds nothing; of a weld, by rounding alone"),
    (r"(body/camera|sensor/contact)@name", "a device without a name is taken for the one on its link"),
    (r"sensor/contact@(data|reduce)", "what a contact sensor tells of a touch is not compared"),
    (r"frame/replicate@euler", "one ray, which no angle parts from another"),
    (r"actuator/.*@(ctrlrange|forcerange)", "a range that MuJoCo has by itself"),
    (r"(body/camera|body/site|body/frame|frame/|replicate/|sensor/).*", "a place or rate that MuJoCo has by itself"),
)
_URDF = (
    (r"mimic@.*|joint/mimic", "the follower stands still at the positions that are asked for"),
    (r"(visual|collision)/origin@.*", "turned about an axis of symmetry"),
    (r"joint/axis.*|axis@xyz", "x, which is what readers take where no axis is"),
)
_OF = {"urdf": _URDF, "mjcf": _MJCF, "sdf": _SDFORMAT, "drake.sdf": _SDFORMAT}


def reason_for(format_: str, kind: str, *, core: bool) -> str:
    """The reason for a kind of removal, as in the table."""
    known = (*(_PYBULLET if core and format_ == "sdf" else ()), *_OF[format_])
    for pattern, reason in known:
        if re.fullmatch(pattern, kind):
            return reason
    raise KeyError(f"{format_}: {kind}")


_CHANGES = {
    "mjcf": (
        (r"body/site@quat", "how the site of a point is turned, which holds nothing"),
        (r"default/geom@(group|contype|conaffinity)", "groups of shapes, which MJCF alone has"),
        (r"body/joint@armature", "armature, which MJCF alone has: there is nothing to compare it with"),
        (r"keyframe/key@(qpos|ctrl)", "the keyframe, which MJCF alone has; what drives hold in it is not compared"),
        (r"sensor/.*@interval", "the rate of encoders, which the other formats do not have"),
        (r"body/joint@damping", "damping of a ball joint, which SDFormat does not have"),
    ),
    "sdf": (),
    "urdf": (),
}


def reason_for_change(format_: str, kind: str) -> str:
    """The reason why a change of a kind of number is not noticed, as in the table."""
    for pattern, reason in _CHANGES[format_]:
        if re.fullmatch(pattern, kind):
            return reason
    raise KeyError(f"{format_}: {kind}")
