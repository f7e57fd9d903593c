"""A compiled MuJoCo model, with access to names and to couplings of joints."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from typing import Any

import numpy as np
from msgspec import Struct

from stepbot.engines.observation import EngineRefused
from stepbot.robot.model import Mimic

_NUMBERED = ("BODY", "JOINT", "EQUALITY")
"""Kinds of elements that others refer to."""
WORLD_LINK = "stepbot/world"
"""Name in MuJoCo of a link ``world`` of a URDF that is more than the place of the base: MuJoCo's world is no link."""


class NamedModel(Struct, frozen=True, dict=True):
    """A compiled model with the names of its elements."""

    engine: Any
    model: Any

    def name(self, kind: str, index: int) -> str:
        """Name of an element, ``kind`` as in ``mjOBJ_<kind>``; empty if it has none.

        A body, joint or equality constraint without a name is named after its number, as in ``body_3``.
        """
        type_ = getattr(self.engine.mjtObj, f"mjOBJ_{kind}")
        name: str = self.engine.mj_id2name(self.model, type_, index) or ""
        if name or kind not in _NUMBERED or index < 0:
            return "world" if name == WORLD_LINK else name
        name = f"{kind.lower()}_{index}"
        while self.engine.mj_name2id(self.model, type_, name) >= 0:
            name += "_"
        return name

    @property
    def bodies(self) -> range:
        """Indices of the links: every body; the world only if a body moves on it by other joints than a free one."""
        model, free = self.model, self.free_joints
        held = (joint for joint in range(model.njnt) if model.body_parentid[model.jnt_bodyid[joint]] == 0)
        return range(0 if any(joint not in free for joint in held) else 1, model.nbody)

    def joint_type(self, joint: int) -> Any:
        """MuJoCo's name of a joint's type."""
        return self.engine.mjtJoint(self.model.jnt_type[joint])

    @property
    def free_joints(self) -> list[int]:
        """Indices of the free joints."""
        free = self.engine.mjtJoint.mjJNT_FREE
        return [joint for joint in range(self.model.njnt) if self.joint_type(joint) == free]

    def vertices(self, mesh: int) -> Any:
        """Vertices (n, 3) [m] of a mesh, in single precision."""
        start = self.model.mesh_vertadr[mesh]
        return self.model.mesh_vert[start : start + self.model.mesh_vertnum[mesh]]

    @cached_property
    def couplings(self) -> dict[int, tuple[Mimic, int]]:
        """For each joint that follows another one by an equality of both, or of their tendons: how, and the equality.

        The relations are converted from MuJoCo's reference positions to q = 0.
        """
        couplings = dict[int, tuple[Mimic, int]]()
        for e, (factors, constant) in self.relations.items():
            if len(factors) != 2:
                continue
            follower = next((one for one in _followers(self, factors, e) if one not in couplings), None)
            if follower is not None:
                leader = next(one for one in factors if one != follower)
                factor = factors[follower]
                mimic = Mimic(self.name("JOINT", leader), -factors[leader] / factor, constant / factor)
                couplings[follower] = mimic, e
        return couplings

    @cached_property
    def relations(self) -> dict[int, tuple[dict[int, float], float]]:
        """For each equality of joints or tendons that is linear: the factors of joints, and the constant they sum to.

        There are no factors for tendons that are not fixed.
        """
        kinds, model = self.engine.mjtEq, self.model
        relations = {}
        for kind, read in ((kinds.mjEQ_JOINT, _of_joints), (kinds.mjEQ_TENDON, _of_tendons)):
            for e in np.flatnonzero((model.eq_type == int(kind)) & (model.eq_active0 != 0)).tolist():
                if not np.any(model.eq_data[e][2:5]):
                    relations[e] = read(self, e)
        return relations


def _followers(compiled: NamedModel, factors: Mapping[int, float], equality: int) -> list[int]:
    """The joints that may follow, the likelier first: the one that no actuator drives, or else the later one."""
    model = compiled.model
    if model.eq_type[equality] == int(compiled.engine.mjtEq.mjEQ_JOINT):
        return [int(model.eq_obj1id[equality])]
    driven = {int(one) for one in model.actuator_trnid[model.actuator_trntype == 0, 0]}
    return sorted((number for number in factors if factors[number]), key=lambda number: (number in driven, -number))


def _of_joints(compiled: NamedModel, equality: int) -> tuple[dict[int, float], float]:
    """Factors of the joints of an equality, and the constant that the sum of their multiples is."""
    model = compiled.model
    follower, leader = int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])
    offset, multiplier = model.eq_data[equality][:2].tolist()
    if leader < 0:
        return {follower: 1.0}, offset
    q = [float(model.qpos0[model.jnt_qposadr[joint]]) for joint in (follower, leader)]
    return {follower: 1.0, leader: -multiplier}, offset + q[0] - multiplier * q[1]


def _of_tendons(compiled: NamedModel, equality: int) -> tuple[dict[int, float], float]:
    """The same of the joints that fixed tendons add up; none for other tendons."""
    model, wraps = compiled.model, int(compiled.engine.mjtWrap.mjWRAP_JOINT)
    offset, multiplier = model.eq_data[equality][:2].tolist()
    factors, constant = dict[int, float](), offset
    for tendon, of_tendon in ((model.eq_obj1id[equality], 1.0), (model.eq_obj2id[equality], -multiplier)):
        first = model.tendon_adr[tendon]
        for wrap in range(first, first + model.tendon_num[tendon]) if tendon >= 0 else ():
            if model.wrap_type[wrap] != wraps:
                return {}, 0.0
            joint, factor = int(model.wrap_objid[wrap]), of_tendon * float(model.wrap_prm[wrap])
            factors[joint] = factors.get(joint, 0.0) + factor
            constant += factor * float(model.qpos0[model.jnt_qposadr[joint]])
    return (factors, constant) if all(factors.values()) else ({}, 0.0)


@contextmanager
def collected_warnings() -> Iterator[list[str]]:
    """Collect the warnings of MuJoCo in this process.

    Raises:
        EngineRefused: MuJoCo gave up, as on a chain of hundreds of bodies, which exceeds its stack.
    """
    import mujoco as engine

    collected: list[str] = []
    former = engine.get_mju_user_warning()
    engine.set_mju_user_warning(collected.append)
    try:
        yield collected
    except engine.FatalError as error:
        raise EngineRefused(str(error).strip()) from error
    finally:
        engine.set_mju_user_warning(former)
