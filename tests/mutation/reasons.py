"""Why some of what a file says is noticed by nobody when it is missing."""

import re

_PYBULLET = (
    (r"link/(visual|collision)@name", "PyBullet keeps no names of shapes"),
    (r"inertia/i..|inertial/inertia", "PyBullet makes inertias of the collision shapes in SDFormat"),
    (r"sdf@version", "PyBullet reads all versions alike"),
    (r"(model/frame|frame/).*", "PyBullet reads no frames"),
    (r"(axis/mimic|mimic/).*", "PyBullet reads no mimics"),
    (r"dynamics/spring_.*", "PyBullet reads no springs"),
    (
        r"limit/(effort|velocity)|axis2?/limit",
        "PyBullet reads no effort and velocity limits of joints that turn freely",
    ),
    (r"limit/lower", "PyBullet takes 0 for a lower limit that is not there"),
    (r"model/joint@name|joint/(parent|child)", "PyBullet reads a copy without the joint to the world"),
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
        r"model/joint.*|joint/.*|axis2?/.*|limit/.*",
        "1e16 means no limit, as nothing does; Drake reads none of universal, screw and closing joints",
    ),
    (r"dynamics/friction", "Drake has no joint friction"),
)
_MJCF = (
    (r"actuator/\w+@name", "a drive without a name is taken for the one on its joint"),
    (r"body/freejoint@name", "what lets a base float is no joint of the robot"),
    (r"body/geom@pos", "rounding: nothing to speak of"),
    (r"frame/replicate@sep", "names of rays alone"),
    (r"mujoco/keyframe|keyframe/key.*", "all joints are drawn at zero, which is where MuJoCo starts by itself"),
    (r"key/.*|keyframe/key@ctrl", "what the drives hold in the keyframe is not compared"),
    (r"equality/connect.*", "one of two that hold a pin: in a plane, a point is enough"),
    (r"body/joint@(pos|axis|type)", "what MuJoCo takes where nothing is said"),
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
    """The reason for a kind of removal, as it stands in a table.

    Raises:
        KeyError: Nobody has looked for one yet.
    """
    known = (*(_PYBULLET if core and format_ == "sdf" else ()), *_OF[format_])
    for pattern, reason in known:
        if re.fullmatch(pattern, kind):
            return reason
    raise KeyError(f"{format_}: {kind}")
