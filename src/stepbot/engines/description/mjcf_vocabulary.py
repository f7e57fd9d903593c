"""What is read of an MJCF: https://mujoco.readthedocs.io/en/stable/XMLreference.html. MuJoCo applies its defaults."""

from typing import Any

from stepbot.robot.mesh_names import MOTOR_LINE, SCOPE

from .vocabulary import Unread, Vocabulary, each, paths

_PLACE = "pos quat axisangle xyaxes zaxis euler"
_GEOM = (
    "name class type size fromto mesh rgba material contype conaffinity group mass density shellinertia "
    f"friction condim priority solref {_PLACE}"
)
_JOINT = (
    "name class type pos axis springdamper stiffness springref range limited actuatorfrcrange actuatorfrclimited ref "
    "damping frictionloss armature"
)
_IN_BODIES = {
    "geom": f"{_GEOM} fitscale",
    "joint": _JOINT,
    "site": f"name class {_PLACE} fromto",
    "camera": f"name class mode fovy resolution {_PLACE}",
}
_ACTUATOR = (
    "name class joint gear ctrlrange ctrllimited forcerange forcelimited inheritrange "
    "tendon site body jointinparent cranksite slidersite refsite"  # reported one by one
)
_ACTUATORS = {
    "position": f"{_ACTUATOR} kp kv damping dampratio timeconst",
    "velocity": f"{_ACTUATOR} kv",
    "motor": _ACTUATOR,
    "general": f"{_ACTUATOR} dyntype gaintype biastype dynprm gainprm biasprm",
    "*": "*",  # of other kinds, which are reported one by one
}
_TIMING = "name interval nsample"
_SENSORS = {
    **dict.fromkeys(("accelerometer", "gyro", "force", "torque"), f"{_TIMING} site"),
    **dict.fromkeys(("jointpos", "jointvel", "ballquat", "ballangvel"), f"{_TIMING} joint"),
    "framequat": f"{_TIMING} objtype objname",
    "*": "*",  # of other kinds, which are reported one by one
}
_DEFAULTS = {**_IN_BODIES, **_ACTUATORS, "mesh": "scale inertia", "material": "rgba", "equality": "active"}
del _DEFAULTS["*"]
LED = "equality constraint of a mocap body"
"""By it programs lead a robot in a simulation: it closes no loop of the robot."""
_CONTACT = "contact friction and stiffness are those of the formats' defaults"

MJCF = Vocabulary(
    strict=True,
    read={
        "mujoco": "model",
        "mujoco/compiler": "*",
        "mujoco/option": "timestep integrator",
        "mujoco/default": "class",
        **paths("mujoco/default", _DEFAULTS),
        "mujoco/worldbody": "",
        "mujoco/worldbody/body": f"name class childclass {_PLACE}",
        "mujoco/worldbody/body/inertial": f"mass diaginertia fullinertia {_PLACE}",
        "mujoco/worldbody/body/freejoint": "name group align",
        **paths("mujoco/worldbody/body", _IN_BODIES),
        "mujoco/asset": "",
        "mujoco/asset/mesh": "*",
        "mujoco/asset/material": "name class rgba",
        "mujoco/asset/model": "name file content_type",
        "mujoco/contact": "",
        "mujoco/contact/exclude": "name body1 body2",
        "mujoco/equality": "",
        **each(
            [f"mujoco/equality/{kind}" for kind in ("connect", "weld", "joint", "tendon")],
            {"": "name class active body1 body2 site1 site2 joint1 joint2 tendon1 tendon2 anchor relpose polycoef"},
        ),
        "mujoco/actuator": "",
        **paths("mujoco/actuator", _ACTUATORS),
        "mujoco/sensor": "",
        **paths("mujoco/sensor", _SENSORS),
        "mujoco/custom": "",
        "mujoco/custom/velocity": "*",
        **each(("mujoco/lines", "mujoco/lines/fixed", "mujoco/lines/fixed/joint"), {"": "*"}),
        "mujoco/keyframe": "",
        "mujoco/keyframe/key[home]": "name qpos",
    },
    neutral={
        "mujoco/option@gravity": ("0 0 -9.81", "0 0 -9.8", "0 0 -9.80665"),
        # As stepbot writes them.
        "mujoco/option@cone": ("elliptic",),
        "mujoco/option@impratio": ("100", "10"),
        "mujoco/default/geom@solimp": ("0.95 0.99 0.001",),
        "mujoco/default/equality@solimp": ("0.99 0.999 0.001",),
        "mujoco/default/equality@solref": ("0.002 0.5", "0.004 0.5"),
        "mujoco/default/site@group": ("4",),
    },
    effects={
        "gravity": "the written files have standard gravity",
        "solref": _CONTACT,
        "solimp": _CONTACT,
        "margin": _CONTACT,
        "gap": _CONTACT,
        "pair": _CONTACT,
        "solreflimit": "limits are as soft as the engines' defaults",
        "solimplimit": "limits are as soft as the engines' defaults",
        "solreffriction": "friction is as soft as the engines' defaults",
        "gravcomp": "gravity acts on the whole weight of the body",
        "mocap": "the body is fixed, and leads nothing",
        "tendon": "what tendons pull, measure and limit is not converted",
        "texture": "visuals have their plain colours",
        "geom": "only the robot is converted, not its surroundings",
        "light": "the written scenes have lights of their own",
        "density": "the robot moves in empty space",
        "viscosity": "the robot moves in empty space",
        "wind": "the robot moves in empty space",
        "ctrl": "the written keyframe has the inputs that hold its pose",
        "user": "data for programs",
    },
    nests=("default", "body"),
    holders={
        "frame": f"name childclass {_PLACE}",
        "replicate": "count offset euler sep",
        "include": "file",
        "attach": "model body prefix",
    },
    kinds={"mujoco/keyframe/key": "name"},
)


def unread_of_mjcf(root: Any, file: str, at: str) -> tuple[Unread, ...]:
    """What of a document is not read.

    Args:
        root: The root element; it is changed.
        file: The file, relative to the description's folder; empty for the description itself.
        at: Path of the element that its content is part of: ``mujoco``, or ``mujoco/worldbody`` of an included one.
    """
    for number in root.iter("numeric"):
        if number.get("name", "").endswith(f"{SCOPE}velocity"):  # a limit, as stepbot writes it
            number.tag = "velocity"
    for tendons in root.iterfind("tendon"):
        if all(tendon.get("name", "").endswith(MOTOR_LINE) for tendon in tendons):
            tendons.tag = "lines"
    return MJCF.unread(root, file, at)
