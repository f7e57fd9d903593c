"""The joints of a MuJoCo model: single joints, and several in one body that form one multi-dof joint."""

import re
from collections.abc import Iterator, Sequence
from math import inf, nan
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.spatial import Pose, vector3
from stepbot.robot.joint_types import HINGES
from stepbot.robot.mesh_names import SCOPE
from stepbot.robot.model import JointDynamics, JointKind, Limit

from ..observation import ObservedJoint

if TYPE_CHECKING:
    from .model import NamedModel

VELOCITY = f"{SCOPE}velocity"
"""Suffix of the custom number with a joint's velocity limit, for which MJCF has no attribute."""

_UNIQUE = re.compile("(_joint)+$")
"""What stepbot adds to names of such joints that are taken."""
_SQUARE = 1e-9
"""Largest cosine of the angle between axes that count as perpendicular."""


def observed_joints(compiled: "NamedModel", body: int, mjcf: bool) -> Iterator[ObservedJoint]:
    """The joint above a body; a body without one is fixed to its parent, by a nameless joint.

    Several joints in one body are one multi-dof joint if they form one of the known types; otherwise each is reported
    separately.
    """
    engine, model = compiled.engine, compiled.model
    parent, child = (compiled.name("BODY", index) for index in (model.body_parentid[body], body))
    above = range(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body])
    if not above and model.body_parentid[body] > 0:
        yield ObservedJoint("", "fixed", parent, child)
    free = engine.mjtJoint.mjJNT_FREE
    if any(compiled.joint_type(joint) == free and model.body_parentid[body] == 0 for joint in above):
        return
    seen = [_single_joint(compiled, joint, parent, child, mjcf) for joint in above]
    if any(one.axis and model.qpos0[model.jnt_qposadr[at]] for at, one in zip(above[1:], seen[1:], strict=True)):
        # Axes are stated where all joints are at their `ref`.
        seen = _where_all_are_zero(compiled, body, above, seen)
    whole = _as_one(compiled, above, seen) if len(seen) > 1 else None
    yield from seen if whole is None else (_with_steps(compiled, whole, seen),)


def _where_all_are_zero(
    compiled: "NamedModel", body: int, above: range, seen: Sequence[ObservedJoint]
) -> list[ObservedJoint]:
    """The joints with axes and anchors in the frame that the body has where all joints are at 0."""
    model, data = compiled.model, compiled.engine.MjData(compiled.model)
    data.qpos[model.jnt_qposadr[[joint for joint, one in zip(above, seen, strict=True) if one.axis]]] = 0.0
    compiled.engine.mj_kinematics(model, data)
    X_BW = Pose.of(data.xmat[body].reshape(3, 3), data.xpos[body]).inverse()
    anchors = X_BW.apply(data.xanchor[list(above)])
    return [
        replace(one, axis=one.axis and vector3(X_BW.R @ data.xaxis[joint]), anchor=vector3(anchor))
        for one, joint, anchor in zip(seen, above, anchors, strict=True)
    ]


def _with_steps(compiled: "NamedModel", joint: ObservedJoint, seen: Sequence[ObservedJoint]) -> ObservedJoint:
    """A multi-dof joint with its component joints; the two of a screw share one coordinate.

    The velocity limit stored under its name applies to each rotating component.
    """
    if joint.kind == "screw":
        return joint
    velocity = _velocity_limits(compiled).get(joint.name, inf)
    steps = (
        replace(step, limit=replace(step.limit, velocity=min(step.limit.velocity, velocity)))
        if step.limit is not None and step.kind != "prismatic"
        else step
        for step in seen
    )
    limit = joint.limit and replace(joint.limit, velocity=min(joint.limit.velocity, velocity))
    return replace(joint, limit=limit, steps=tuple(steps))


def _as_one(compiled: "NamedModel", above: range, seen: Sequence[ObservedJoint]) -> ObservedJoint | None:
    """The joint that several joints of a body form; None if it is not one of the known types."""
    kinds = tuple("turn" if joint.kind in HINGES else joint.kind for joint in seen)
    axes = [np.array(joint.axis or (0.0, 0.0, 0.0)) for joint in seen]
    last, first = seen[-1], seen[0]
    if kinds == ("turn", "turn"):
        limit = first.limit if first.limit is not None and first.limit == last.limit else Limit(nan, nan, nan, nan)
        dynamics = first.dynamics if first.dynamics == last.dynamics else JointDynamics(*[nan] * 5)
        name = _whole_name(JointKind.UNIVERSAL.chain, seen)
        return replace(first, name=name, kind="universal", axis2=last.axis, limit=limit, dynamics=dynamics)
    if kinds == ("prismatic", "turn") and np.array_equal(axes[0], axes[1]):
        pitch = screw_pitch(compiled, above[0])
        if pitch is not None:
            return replace(last, kind="screw", pitch=pitch)
        return replace(last, name=_whole_name(JointKind.CYLINDRICAL.chain, seen), kind="cylindrical")
    flat = len(axes) == 3 and max(abs(float(axes[2] @ axis)) for axis in axes[:2]) < _SQUARE
    if kinds == ("prismatic", "prismatic", "turn") and flat:
        return replace(last, name=_whole_name(JointKind.PLANAR.chain, seen), kind="planar")
    if kinds == ("prismatic", "prismatic", "prismatic", "ball") and np.array_equal(axes[:3], np.eye(3)):
        return replace(last, name=_whole_name((*JointKind.FLOATING.chain[:3], "_turn"), seen), kind="floating")
    return None


def _whole_name(chain: Sequence[str], seen: Sequence[ObservedJoint]) -> str:
    """The name of a joint that stepbot has written as several; empty if they have names of their own."""
    names = [_UNIQUE.sub("", joint.name) for joint in seen]
    stem = names[0].removesuffix(chain[0])
    return stem if names == [f"{stem}{suffix}" for suffix in chain] else ""


def screw_pitch(compiled: "NamedModel", joint: int) -> float | None:
    """Advance of a slide joint with the following hinge in its body; None if no equality couples them."""
    model, (follows, _) = compiled.model, compiled.couplings.get(joint, (None, 0))
    after = joint + 1
    if follows is None or follows.offset or after >= model.njnt or model.jnt_bodyid[after] != model.jnt_bodyid[joint]:
        return None
    return follows.multiplier if follows.joint == compiled.name("JOINT", after) else None


def _single_joint(compiled: "NamedModel", joint: int, parent: str, child: str, mjcf: bool) -> ObservedJoint:
    engine = compiled.engine
    kind = compiled.joint_type(joint)
    if kind in (engine.mjtJoint.mjJNT_HINGE, engine.mjtJoint.mjJNT_SLIDE):
        return _moving_joint(compiled, joint, parent, child, mjcf)
    if kind == engine.mjtJoint.mjJNT_BALL:
        velocities, name = _velocity_limits(compiled), compiled.name("JOINT", joint)
        widest = float(compiled.model.jnt_range[joint][1]) if compiled.model.jnt_limited[joint] else inf
        return ObservedJoint(
            name,
            "ball",
            parent,
            child,
            anchor=vector3(compiled.model.jnt_pos[joint]),
            limit=Limit(upper=widest, velocity=velocities.get(name, inf)),  # a cone, in MuJoCo only
            limit_fields=("upper", "velocity") if mjcf else (),
            dynamics=_passive(compiled, joint, 0.0),
            dynamics_fields=("damping", "friction", "stiffness", "armature"),
        )
    return ObservedJoint(compiled.name("JOINT", joint), "floating", parent, child)


def _passive(compiled: "NamedModel", joint: int, reference: float) -> JointDynamics:
    model = compiled.model
    dof = model.jnt_dofadr[joint]
    return JointDynamics(
        damping=float(model.dof_damping[dof]),
        friction=float(model.dof_frictionloss[dof]),
        stiffness=float(model.jnt_stiffness[joint]),
        spring_reference=reference,
        armature=float(model.dof_armature[dof]),
    )


def _moving_joint(compiled: "NamedModel", joint: int, parent: str, child: str, mjcf: bool) -> ObservedJoint:
    model, name = compiled.model, compiled.name("JOINT", joint)
    position = model.jnt_qposadr[joint]
    limited, forced = bool(model.jnt_limited[joint]), bool(model.jnt_actfrclimited[joint])
    kind = "prismatic"
    if compiled.joint_type(joint) == compiled.engine.mjtJoint.mjJNT_HINGE:
        kind = "revolute" if limited else "continuous"
    velocities = _velocity_limits(compiled)
    lower, upper = model.jnt_range[joint].tolist() if limited else (-inf, inf)
    limit = Limit(lower, upper, velocities.get(name, inf), _effort(*model.jnt_actfrcrange[joint]) if forced else inf)
    return ObservedJoint(
        name,
        kind,
        parent,
        child,
        axis=vector3(model.jnt_axis[joint]),
        anchor=vector3(model.jnt_pos[joint]),
        limit=limit,
        limit_fields=("lower", "upper", *(("velocity",) if mjcf else ()), "effort"),
        dynamics=_passive(compiled, joint, float(model.qpos_spring[position])),
        dynamics_fields=("damping", "friction", *(("stiffness", "spring_reference", "armature") if mjcf else ())),
        mimic=compiled.couplings.get(joint, (None, 0))[0],
        mimic_read=True,
    )


def _effort(lower: float, upper: float) -> float:
    """The effort limit of a force range; NaN if the range is asymmetric."""
    return float(upper) if lower == -upper else nan


def _velocity_limits(compiled: "NamedModel") -> dict[str, float]:
    """Velocity limits [rad/s] or [m/s] stored as custom numbers, by joint."""
    model = compiled.model
    names = {compiled.name("NUMERIC", i): int(model.numeric_adr[i]) for i in range(model.nnumeric)}
    return {
        name.removesuffix(VELOCITY): float(model.numeric_data[address])
        for name, address in names.items()
        if name.endswith(VELOCITY)
    }
