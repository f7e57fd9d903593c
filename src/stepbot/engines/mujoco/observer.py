"""MuJoCo as an observer of MJCF and URDF: the compiled model, its mass matrix, and loops closed by Newton's method.

URDF is read from a copy with compiler options that keep what MuJoCo drops by default: the base (``fusestatic``),
visuals (``discardvisual``), folders in mesh paths (``strippath``). Its equality constraints are soft, so closures are
solved on their own rows. https://mujoco.readthedocs.io/en/stable/XMLreference.html
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.spatial import Array, Pose, matrix3, turn_inertia, vector3
from stepbot.robot.dynamics import GRAVITY, Rates

from ..ball_coordinates import inner_joints
from ..distribution import provider
from ..observation import (
    Dynamics,
    EngineCannotRead,
    EngineRefused,
    Observation,
    ObservedJoint,
    ObservedLink,
    Quantity,
    Request,
)
from ..resources import MeshSubstitutes, resolve, with_shapes
from ..urdf_versions import readable
from ..xml import xml_root
from . import ENGINE
from .compiled import Compiled, excluded_pairs
from .devices import observed_actuators, observed_frames, observed_sensors
from .joints import observed_joints
from .model import WORLD_LINK, collected_warnings
from .settings import content_hash, settings, stated_defaults
from .shapes import collides, observed_shapes, stray_mesh

_URDF_COMPILER = {"fusestatic": "false", "discardvisual": "false", "strippath": "false"}
_EXTENSION = "MuJoCo ignores the URDF extension blocks that contain it"
_NOT_RUN: Mapping[str, Mapping[Quantity, str]] = {
    "urdf": {
        Quantity.CLOSURES: "URDF cannot represent closed loops",
        Quantity.ACTUATORS: _EXTENSION,
        Quantity.SENSORS: _EXTENSION,
    },
    "mjcf": {},
}
_CONTENT = ("inertial", "visual", "collision")
_READABLE = (".obj", ".stl", ".msh")
"""Suffixes of meshes that MuJoCo reads."""
_ABOUT_SIZE = ("inertia must have positive eigenvalues", "must be larger than mjMINVAL")
_TOO_SMALL = "MuJoCo has no moving link below 1e-15 kg or 1e-14 kg m^2"
_CHECK = "check the length unit and the densities; for a robot of a few millimetres, leave out MJCF (`-f urdf,sdf`)"
_SINGULAR = "Inertia matrix is too close to singular"
_TOO_LIGHT = "without the armature that URDF lacks, links of several joints in a row are too light for MuJoCo"
_FOR_COMPILING = 1e-6
"""Temporary mass [kg] and moments of inertia [kg m^2] of massless moving links while MuJoCo compiles."""
HOME = "home"
"""Name of the keyframe with the initial pose."""


def prepare() -> None:
    """Import the engine's slow modules."""
    import mujoco  # noqa: F401


def observe(request: Request) -> Observation:
    """Compile the file and report its content.

    Raises:
        EngineRefused: MuJoCo does not compile the file.
        EngineCannotRead: It is a URDF with a floating joint within the robot, or with links that are too small.
    """
    import mujoco as engine

    from .motion import close_by_newton, initial_penetrations, simulate

    with readable(request) as (request, replaced), collected_warnings() as warnings:
        model, notes = _compile(engine, request)
        compiled = Compiled(engine, model, request.balls)
        if not compiled.bodies:
            raise EngineRefused("the file has no bodies")
        observation = observe_model(compiled, request)
        if request.format == "mjcf":
            observation = replace(observation, closures=close_by_newton(compiled, request))
        if request.simulate:
            known = len(warnings)
            finite, reversals = simulate(compiled, request)
            observation, notes = replace(observation, simulation_finite=finite), (*notes, *reversals)
            if not finite:
                notes = (*notes, *dict.fromkeys(warnings[known:]))  # where it diverged, which is one failure, not two
                observation = replace(observation, initial_penetrations=initial_penetrations(compiled, request))
                del warnings[known:]
        if request.format == "urdf":
            observation = replace(observation, joints=_without_ignored_bounds(observation.joints, warnings, request))
            light = [text for text in dict.fromkeys(warnings) if text.startswith(_SINGULAR)]
            notes = (*notes, *(f"{_TOO_LIGHT}: {text}" for text in light))
            warnings[:] = [text for text in warnings if text not in light]
    notes = (*replaced, *notes, *_strays(compiled))
    return replace(observation, warnings=tuple(dict.fromkeys(warnings)), notes=notes)


def _without_ignored_bounds(
    joints: Iterable[ObservedJoint], warnings: Collection[str], request: Request
) -> tuple[ObservedJoint, ...]:
    """The joints of a URDF without a report of the bounds that MuJoCo ignores, because both are equal."""
    bounded = xml_root(Path(request.file)).xpath("joint[@type != 'continuous']/@name")
    ignored = [f"joint '{name}' has equal lower and upper limits, limit ignored" for name in bounded]
    names = {name for name, text in zip(bounded, ignored, strict=True) if text in warnings}
    return tuple(
        replace(
            joint,
            kind="revolute" if joint.kind == "continuous" else joint.kind,
            limit_fields=tuple(name for name in joint.limit_fields if name not in ("lower", "upper")),
        )
        if joint.name in names
        else joint
        for joint in joints
    )


def _strays(compiled: Compiled) -> tuple[str, ...]:
    """A note on visuals whose size MuJoCo does not report."""
    meshes = [stray_mesh(compiled, g) for g in range(compiled.model.ngeom) if not collides(compiled, g)]
    names = ", ".join(f"'{name}'" for name in sorted({name for name in meshes if name is not None}))
    return (f"size of visuals not compared, of meshes with vertices without faces: {names}",) if names else ()


def _compile(engine: Any, request: Request) -> tuple[Any, tuple[str, ...]]:
    """The compiled model, and notes on what was changed to compile it."""
    path = Path(request.file)
    try:
        if request.format == "urdf":
            substitutes = MeshSubstitutes("MuJoCo", _READABLE)
            spec = _urdf_spec(engine, path, substitutes)
            for mesh in spec.meshes:  # URDF states every mass, so a flat mesh is not a fault
                mesh.inertia = engine.mjtMeshInertia.mjMESH_INERTIA_SHELL
            unstated = _without_inferred_masses(spec)
            _exclude_contacts_of_base(spec)
            model, notes = _with_weightless_links(engine, spec)
            model, rounded = without_rounding(engine, model, lambda: spec)
            return model, (*unstated, *notes, *rounded, *substitutes.notes())
        model = engine.MjModel.from_xml_path(str(path))
        return without_rounding(engine, model, lambda: engine.MjSpec.from_file(str(path)))
    except ValueError as error:
        floating = inner_joints(path, ("floating",)) if request.format == "urdf" else ""
        if floating:
            raise EngineCannotRead(f"MuJoCo has no floating joints within a robot: {floating}") from error
        # Local folders must not be in a message that may be part of a report.
        text = str(error).replace(f"{path.parent.as_posix()}/", "").strip()
        if not any(words in text for words in _ABOUT_SIZE):
            raise EngineRefused(text) from error
        if request.format == "urdf":  # which other engines read
            raise EngineCannotRead(f"{_TOO_SMALL} ({'; '.join(text.splitlines())})") from error
        raise EngineRefused(f"{text}; {_TOO_SMALL}{EngineRefused.HELP}{_CHECK}") from error


def _without_inferred_masses(spec: Any) -> tuple[str, ...]:
    """Give links without ``<inertial>`` the mass 0 that URDF defines; returns a note on those that have geometry.

    MuJoCo computes the mass of these from the volume of their collisions and a density of 1000 kg/m^3.
    """
    unstated = [body for body in spec.bodies if body.name != "world" and not body.explicitinertial]
    inferred = ["world" if body.name == WORLD_LINK else body.name for body in unstated if body.geoms]
    for body in unstated:
        body.explicitinertial, body.mass, body.inertia, body.ipos = True, 0.0, [0.0] * 3, [0.0] * 3
    names = ", ".join(inferred)
    return (f"mass 0 in place of one that MuJoCo computes from geometry, without <inertial>: {names}",) if names else ()


def _exclude_contacts_of_base(spec: Any) -> None:
    """Exclude contacts of the base with the links that move on it, as MuJoCo excludes those of other adjacent links.

    It does not where the parent is fixed to the world, and a URDF cannot state the exclusion.
    """
    base = [body for top in spec.worldbody.bodies if not top.joints for body in _welded(top)]
    for body in base:
        for moving in (child for child in body.bodies if child.joints):
            for one, other in product(base, _welded(moving)):
                if one.geoms and other.geoms:
                    spec.add_exclude(bodyname1=one.name, bodyname2=other.name)


def _welded(body: Any) -> list[Any]:
    """A body and those fixed to it."""
    return [body, *(each for child in body.bodies if not child.joints for each in _welded(child))]


def _with_weightless_links(engine: Any, spec: Any) -> tuple[Any, tuple[str, ...]]:
    """The compiled model of a spec with massless moving bodies, and a note on them.

    MuJoCo does not compile moving bodies without mass, although it can simulate them: they get a small mass during
    compilation, which is removed afterwards.
    """
    weightless = [body.name for body in spec.bodies if body.name != "world" and body.joints and body.mass == 0.0]
    for name in weightless:
        body = spec.body(name)
        body.mass, body.inertia = _FOR_COMPILING, [_FOR_COMPILING] * 3
    model = spec.compile()
    if not weightless:
        return model, ()
    for name in weightless:
        index = engine.mj_name2id(model, engine.mjtObj.mjOBJ_BODY, name)
        model.body_mass[index], model.body_inertia[index] = 0.0, 0.0
    engine.mj_setConst(model, engine.MjData(model))
    return model, (f"compiled with a placeholder mass for massless moving links: {', '.join(weightless)}",)


def _urdf_spec(engine: Any, path: Path, substitutes: MeshSubstitutes) -> Any:
    """The URDF with MuJoCo's compiler options, with resolved mesh paths, and with meshes that MuJoCo reads."""
    from lxml import etree

    top = xml_root(path)
    assets: dict[str, bytes] = {}
    for mesh in top.iter("mesh"):
        mesh_file = resolve(mesh.get("filename", ""), path)
        if mesh_file is None:
            continue
        content = substitutes.of(mesh_file)
        name = f"{mesh_file.absolute().as_posix()}{'' if content is None else '.obj'}"
        if content is not None:
            assets[name] = content
        mesh.set("filename", name)
    _rename_world(top)
    extension = top.find("mujoco")
    if extension is None:
        extension = etree.SubElement(top, "mujoco")
    compiler = extension.find("compiler")
    if compiler is None:
        compiler = etree.SubElement(extension, "compiler")
    for name, value in _URDF_COMPILER.items():
        compiler.set(name, value)
    return engine.MjSpec.from_string(str(etree.tostring(top, encoding="unicode")), assets=assets)


def _rename_world(robot: Any) -> None:
    """Give the link ``world`` of a URDF another name, unless it has nothing but one joint.

    MuJoCo takes it for its world, and leaves out the joints that fix several bases to it, as of the arms of a cell.
    """
    links = [link for link in robot.findall("link") if link.get("name") == "world"]
    on_it = [one for one in robot.iterfind("joint/parent") if one.get("link") == "world"]
    if len(on_it) == 1 and not any(link.find(tag) is not None for link in links for tag in _CONTENT):
        return
    for link in links:
        link.set("name", WORLD_LINK)
    for parent in on_it:
        parent.set("link", WORLD_LINK)


def observe_model(compiled: Compiled, request: Request) -> Observation:
    """Report what a compiled model contains, without closures and simulation."""
    mjcf = request.format == "mjcf"
    sensors = observed_sensors(compiled)
    return Observation(
        engine=ENGINE.name,
        **provider("mujoco"),
        format=request.format,
        name=_name(compiled),
        base=("floating" if compiled.free_joints else "fixed") if mjcf else None,
        links=tuple(_link(compiled, body, mjcf) for body in compiled.bodies),
        joints=tuple(joint for body in compiled.bodies for joint in observed_joints(compiled, body, mjcf)),
        gravity=_gravity(compiled) if mjcf else None,
        coordinates=compiled.coordinates.names,
        poses=tuple(compiled.poses(compiled.data(q)) for q in [*request.configurations, *request.closed]),
        dynamics=tuple(_dynamics(compiled, *at) for at in request.moments),
        frames=observed_frames(compiled, sensors) if mjcf else None,
        actuators=observed_actuators(compiled) if mjcf else None,
        sensors=sensors if mjcf else None,
        initial=_initial(compiled) if mjcf else None,
        excluded_pairs=excluded_pairs(compiled) if mjcf else None,
        not_run=_NOT_RUN[request.format],
        settings=settings(compiled) if mjcf else {},
        compiled=content_hash(compiled) if mjcf and request.compiled else "",
        stated_defaults=stated_defaults(compiled, Path(request.file)) if mjcf and request.compiled else (),
    )


def _name(compiled: Compiled) -> str:
    """Name of the model: MuJoCo stores it before all other names."""
    return bytes(compiled.model.names).split(b"\0", 1)[0].decode("utf-8", "replace")


def _link(compiled: Compiled, body: int, mjcf: bool) -> ObservedLink:
    model = compiled.model
    X_LI = Pose.from_quaternion(model.body_iquat[body].tolist(), model.body_ipos[body])
    sides = (False, True) if body else ()  # what stands in the world is not part of the robot
    seen, touched = [observed_shapes(compiled, body, touched=side, mjcf=mjcf) for side in sides] or [(), ()]
    link = ObservedLink(
        compiled.name("BODY", body),
        float(model.body_mass[body]),
        X_LI.position,
        matrix3(turn_inertia(X_LI.R, np.diag(model.body_inertia[body]))),
        gravity_compensation=float(model.body_gravcomp[body]) if mjcf else None,
    )
    return with_shapes(link, seen, touched)


def _gravity(compiled: Compiled) -> tuple[float, ...]:
    """Acceleration of gravity [m/s^2] that the file sets; empty for MuJoCo's default, which is :data:`GRAVITY`."""
    disabled = int(compiled.model.opt.disableflags) & int(compiled.engine.mjtDisableBit.mjDSBL_GRAVITY)
    gravity = (0.0, 0.0, 0.0) if disabled else vector3(compiled.model.opt.gravity)
    return () if gravity == GRAVITY else gravity


def _dynamics(compiled: Compiled, q: Mapping[str, float], rates: Rates) -> Dynamics:
    """Mass matrix without armature, also of tendons, gravity forces, and inverse dynamics, in the coordinates."""
    engine, model = compiled.engine, compiled.model
    E = compiled.coordinates.velocities.rates(q)
    kept = model.dof_armature.copy(), model.tendon_armature.copy(), model.dof_M0.copy(), model.opt.gravity.copy()
    flags = int(model.opt.disableflags)
    model.dof_M0[:] -= model.dof_armature  # the mass matrix of "simple" bodies is constant, and computed in advance
    model.dof_armature[:], model.tendon_armature[:] = 0.0, 0.0
    model.opt.gravity[:], model.opt.disableflags = GRAVITY, 0
    try:
        data = compiled.data(q)
        engine.mj_forward(model, data)
        M = np.zeros((model.nv, model.nv))
        for column, unit in enumerate(np.eye(model.nv)):
            product = np.zeros(model.nv)
            engine.mj_mulM(model, data, product, unit)
            M[:, column] = product
        gravity: Array = np.array(data.qfrc_bias)
        inverse = np.zeros(model.nv)
        data.qvel[:], data.qacc[:] = compiled.coordinates.velocities.moving(q, rates)
        engine.mj_fwdVelocity(model, data)
        engine.mj_rne(model, data, 1, inverse)
    finally:
        model.dof_armature[:], model.tendon_armature[:], model.dof_M0[:], model.opt.gravity[:] = kept
        model.opt.disableflags = flags
    return Dynamics(E.T @ M @ E, E.T @ gravity, E.T @ inverse)


def _initial(compiled: Compiled) -> dict[str, float]:
    """The pose in the keyframe :data:`HOME`, or else that of the model."""
    model = compiled.model
    keys = [k for k in range(model.nkey) if compiled.name("KEY", k) == HOME]
    return compiled.coordinates.read(model.key_qpos[keys[0]] if keys else model.qpos0)


_APART = 1.0
"""Displacement [m] of the inertial frame of a rounded body while MuJoCo compiles, beyond any rounding."""
_BODY = ("body_mass", "body_inertia", "body_ipos", "body_iquat")
_FLAGS = ("body_sameframe", "geom_sameframe", "site_sameframe")


def without_rounding(engine: Any, model: Any, spec: Callable[[], Any]) -> tuple[Any, tuple[str, ...]]:
    """A model with every frame where the file has it, and a note on the links that MuJoCo simulates otherwise.

    Args:
        engine: The module ``mujoco``.
        model: A compiled model.
        spec: Returns the specification that it was compiled from; called only if a body was rounded.
    """
    # Bodies whose inertial frame, or its rotation alone, counts as the body's without being it.
    moved = (model.body_ipos != 0.0).any(axis=1)
    turned = (model.body_iquat != (1.0, 0.0, 0.0, 0.0)).any(axis=1)
    whole = model.body_sameframe == int(engine.mjtSameFrame.mjSAMEFRAME_BODY)
    rotation = model.body_sameframe == int(engine.mjtSameFrame.mjSAMEFRAME_BODYROT)
    rounded = np.flatnonzero((whole & moved) | ((whole | rotation) & turned))
    if rounded.size:
        exact = _with_inertials_apart(spec(), model, rounded)
        for name in _BODY:
            getattr(exact, name)[:] = getattr(model, name)
        engine.mj_setConst(exact, engine.MjData(exact))
        model = exact
    for name in _FLAGS:
        getattr(model, name)[:] = int(engine.mjtSameFrame.mjSAMEFRAME_NONE)
    names = [engine.mj_id2name(model, engine.mjtObj.mjOBJ_BODY, body) or f"body {body}" for body in rounded.tolist()]
    words = "compared without MuJoCo's rounding of inertial frames less than 1e-6 from the link's:"
    return model, (f"{words} {', '.join(names)}",) if names else ()


def _with_inertials_apart(spec: Any, model: Any, rounded: Any) -> Any:
    """The model compiled again with the inertial frames of some bodies elsewhere."""
    spec.compile()  # numbers the bodies
    for body in (body for body in spec.bodies if body.id in rounded):
        body.explicitinertial = True
        body.fullinertia = [np.nan] * 6
        body.mass, body.inertia = model.body_mass[body.id], model.body_inertia[body.id]
        body.ipos = model.body_ipos[body.id] + _APART
    return spec.compile()
