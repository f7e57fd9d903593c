"""What is read of an SDFormat file: http://sdformat.org/spec, and Gazebo's plugins that move and measure joints."""

from .vocabulary import SENSOR, Vocabulary, each, paths

_POSE = "relative_to degrees rotation_format"
_GEOMETRY = {
    "geometry": "",
    "geometry/box": "",
    "geometry/box/size": "",
    **each(("geometry/cylinder", "geometry/capsule"), {"": "", "radius": "", "length": ""}),
    "geometry/sphere": "",
    "geometry/sphere/radius": "",
    "geometry/ellipsoid": "",
    "geometry/ellipsoid/radii": "",
    **each(("geometry/cone",), {"": "", "radius": "", "length": ""}),
    "geometry/mesh": "",
    "geometry/mesh/uri": "",
    "geometry/mesh/scale": "",
}
_INERTIAL = {
    "": "auto",
    "pose": "degrees rotation_format",
    "mass": "",
    "inertia": "",
    **{f"inertia/{moment}": "" for moment in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")},
}
_LINK = {
    "": "name",
    "pose": _POSE,
    **paths("inertial", _INERTIAL),
    **each(("visual", "collision"), {"": "name", "pose": _POSE, **_GEOMETRY}),
    **dict.fromkeys(("collision/surface", "collision/surface/friction", "collision/surface/friction/ode"), ""),
    "collision/surface/friction/ode/mu": "",
    "collision/surface/bounce": "",
    "collision/surface/bounce/restitution_coefficient": "",
    "visual/material": "",
    "visual/material/diffuse": "",
    **paths("sensor", SENSOR),
}
_AXIS = {
    "": "",
    "xyz": "expressed_in",
    "use_parent_model_frame": "",
    "limit": "",
    **{f"limit/{bound}": "" for bound in ("lower", "upper", "effort", "velocity")},
    "dynamics": "",
    **{f"dynamics/{force}": "" for force in ("damping", "friction", "spring_stiffness", "spring_reference")},
    "mimic": "joint",
    **{f"mimic/{number}": "" for number in ("multiplier", "offset", "reference")},
}
_JOINT = {
    "": "name type",
    "pose": _POSE,
    "parent": "",
    "child": "",
    "screw_thread_pitch": "",
    **each(("axis", "axis2"), _AXIS),
    **paths("sensor", SENSOR),
}
_CONTROLLERS = ("gz-sim-joint-position-controller-system", "gz-sim-joint-controller-system")
_PLUGINS = {
    **{
        f"plugin[{library}]{path}": names
        for library in _CONTROLLERS
        for path, names in {
            "": "filename name",
            **{f"/{tag}": "" for tag in ("joint_name", "p_gain", "i_gain", "d_gain", "cmd_max", "cmd_min")},
            "/use_force_commands": "",
            "/use_velocity_commands": "",
        }.items()
    },
    **{
        f"plugin[{library}]{path}": names
        for library in ("gz-sim-apply-joint-force-system", "gz-sim-joint-state-publisher-system")
        for path, names in {"": "filename name", "/joint_name": ""}.items()
    },
}

MODEL = Vocabulary(
    read={
        "model": "name canonical_link placement_frame",
        "model/pose": _POSE,
        "model/static": "",
        **paths("model/link", _LINK),
        **paths("model/joint", _JOINT),
        "model/frame": "name attached_to",
        "model/frame/pose": _POSE,
        **paths("model", _PLUGINS),
    },
    neutral={
        "pose@frame": ("",),  # as Gazebo saves every pose
        "model/self_collide": ("false", "0"),
        "model/allow_auto_disable": ("true", "1"),
        "model/enable_wind": ("false", "0"),
        "model/link/gravity": ("true", "1"),
        "model/link/kinematic": ("false", "0"),
        "model/link/self_collide": ("false", "0"),
        "model/link/enable_wind": ("false", "0"),
        "model/link/must_be_base_link": ("false", "0"),
        "model/link/visual/material/emissive": ("0 0 0 0", "0 0 0 1", "0 0 0"),
        "model/link/visual/cast_shadows": ("true", "1"),
        "model/link/visual/transparency": ("0", "0.0"),
        "model/link/collision/max_contacts": ("10",),
        "model/joint/axis/initial_position": ("0", "0.0"),
    },
    effects={
        "gravity": "gravity acts on the link",
        "kinematic": "forces move the link",
        "self_collide": "which links collide is left to the formats' defaults",
        **dict.fromkeys(("contact", "torsional", "bullet"), "contact properties are those of the formats' defaults"),
        "mu2": "friction is the same in all directions",
        "script": "the visual has its plain colour",
        "texture": "the visual has its plain colour",
        "ambient": "the ambient colour is the diffuse one",
        "specular": "the visual has no highlights of its own",
        "emissive": "the visual does not glow",
        "transparency": "the visual is as opaque as its colour",
        "plugin": "simulator plugins are set up anew",
        "thread_pitch": "the pitch of the screw is lost: give `<screw_thread_pitch>`",
        "physics": "settings of the solver are those of the formats' defaults",
        "velocity_decay": "the link is not damped by the air",
    },
    nests=("model",),
    kinds={"model/plugin": "filename"},
    twins={"model/link/visual/material/ambient": "diffuse", "model/link/collision/surface/friction/ode/mu2": "mu"},
)
"""A model."""

AROUND = Vocabulary(
    read={"sdf": "version", "sdf/world": "name"},
    neutral={"sdf/world/gravity": ("0 0 -9.8", "0 0 -9.81", "0 0 -9.80665")},
    effects={
        "gravity": "the written worlds have standard gravity",
        "include": "only the robot is converted",
        "model": "only the robot is converted",
        "physics": "the written scenes have settings of their own",
    },
)
"""The file around a model."""
