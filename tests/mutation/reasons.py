"""Why some removals and changes in a file are not detected."""

import re
from collections.abc import Sequence

NO_REASON = "no reason known"
"""In the tables, for what the makers of the page must look into."""

_PYBULLET = (
    (r"link/(visual|collision)@name", "PyBullet keeps no names of shapes"),
    (r"(visual|collision)/pose", "of a link with a capsule, of which PyBullet reports no box"),
    (r"inertia/i..|inertial/inertia", "PyBullet computes inertias from the collision shapes in SDFormat"),
    (r"sdf@version", "PyBullet ignores the version"),
    (r"(model/frame|frame/).*", "PyBullet reads no frames"),
    (r"(axis/mimic|mimic/).*", "PyBullet reads no mimics"),
    (r"dynamics/spring_.*|axis/dynamics", "PyBullet reads no springs"),
    (
        r"limit/(effort|velocity)",
        "PyBullet reads no effort and velocity limits of joints that turn without end, be it to one side",
    ),
    (r"limit/lower", "0, PyBullet's default; or of a joint that closes a loop"),
    (
        r"model/joint.*|joint/(parent|child|pose)|axis2?/limit|limit/upper",
        "PyBullet reads a copy without the joint to the world and those that close loops",
    ),
)
"""What the core install's engine alone does not detect in SDFormat: kind of removal, and reason."""

_SDFORMAT = (
    (r"inertia/i..", "far below the precision of the largest moment: rounding of a sum of parts"),
    (r"inertial/pose", "zero: a massless link, or one with its centre of mass at its origin"),
    (r"(axis/mimic|mimic/).*", "Drake does not read mimics"),
    (r"axis2?/xyz|joint/axis2?", "z, the default"),
    (r"model/frame@attached_to", "attached to the first link, the default"),
    (r"model/ball_constraint", "one of two constraints of a pin: in a plane, one is sufficient"),
    (
        r"model/joint.*|joint/(parent|child|pose)",
        "of a joint that closes a loop: PyBullet reads a copy without it, and Drake another file",
    ),
    (r"limit/(lower|upper)", "1e16, which means unlimited, the default; or of a screw, whose limits Drake ignores"),
    (r"limit/(effort|velocity)", "Drake reads neither of universal joints, and no velocity limit of screws"),
    (
        r"axis2?/limit",
        "1e16, which means unlimited, the default; or effort and velocity of a universal joint, ignored by Drake",
    ),
    (r"dynamics/friction", "Drake has no joint friction"),
)
_MJCF = (
    (r"mujoco/compiler(@angle)?", "no angle in the file"),
    (r"worldbody/body@pos", "the height at which a floating base stands in its world"),
    (r"body/inertial@diaginertia", "zero: a massless link"),
    (r"actuator/\w+@name", "an actuator without a name is matched by its joint"),
    (r"body/freejoint@name", "the free joint of the base is not a joint of the robot"),
    (r"body/geom@pos", "at the link's origin, except for rounding of a product of poses"),
    (r"mujoco/keyframe|keyframe/key.*", "all joints are drawn at zero, MuJoCo's default"),
    (r"key/.*|keyframe/key@ctrl", "the actuators' targets in the keyframe are not compared"),
    (r"equality/connect.*", "one of two constraints of a pin: in a plane, one is sufficient"),
    (r"body/joint@(pos|axis|type)", "at the origin, about z, or a hinge: MuJoCo's defaults"),
    (r"body/site@quat", "rotation of the site of a point constraint, without effect; for a weld, only rounding"),
    (r"(body/camera|sensor/contact)@name", "a device without a name is matched by its link"),
    (r"sensor/contact@(data|reduce)", "the readings of a contact sensor are not compared"),
    (r"actuator/.*@(ctrlrange|forcerange)", "MuJoCo's default range"),
    (r"(body/camera|body/site|body/frame|frame/|sensor/).*", "MuJoCo's default pose or rate"),
)
_URDF = (
    (r"mimic@.*|joint/mimic", "the follower does not move at the requested positions"),
    (r"(visual|collision)/origin@.*", "rotated about an axis of symmetry"),
    (r"joint/axis.*|axis@xyz", "x, the default"),
)
_OF = {"urdf": _URDF, "mjcf": _MJCF, "sdf": _SDFORMAT, "drake.sdf": _SDFORMAT}


def reason_for(format_: str, kind: str, *, core: bool) -> str:
    """The reason for a kind of removal, as in the table."""
    return _first((*(_PYBULLET if core and format_ == "sdf" else ()), *_OF[format_]), kind)


def _first(known: Sequence[tuple[str, str]], kind: str) -> str:
    return next((reason for pattern, reason in known if re.fullmatch(pattern, kind)), NO_REASON)


_CHANGES = {
    "mjcf": (
        (r"mujoco/option@.*", "settings of the simulation, which MJCF alone has"),
        (r"default/(equality|site)@.*", "stiffness of closures, and the group of sites, which MJCF alone has"),
        (r"default/geom@(solref|solimp)", "stiffness of contacts, which MJCF alone has"),
        (r"sensor/.*@nsample", "the buffer of a sensor: any positive length keeps its last reading"),
        (r"worldbody/body@pos", "the height at which a floating base stands in its world"),
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
    """The reason why a change of a kind of number is not detected, as in the table."""
    return _first(_CHANGES[format_], kind)
