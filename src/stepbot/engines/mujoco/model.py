"""A compiled MuJoCo model, with access to names."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from stepbot.engines.observation import EngineRefused

_NUMBERED = ("BODY", "JOINT", "EQUALITY")
"""Kinds of elements that others refer to."""
WORLD_LINK = "stepbot/world"
"""Name in MuJoCo of a link ``world`` of a URDF that is more than the place of the base: MuJoCo's world is no link."""


@dataclass(frozen=True)
class NamedModel:
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
        model, free = self.model, self.engine.mjtJoint.mjJNT_FREE
        held = (j for j in range(model.njnt) if model.body_parentid[model.jnt_bodyid[j]] == 0)
        return range(0 if any(self.joint_type(joint) != free for joint in held) else 1, model.nbody)

    def joint_type(self, joint: int) -> Any:
        """MuJoCo's name of a joint's type."""
        return self.engine.mjtJoint(self.model.jnt_type[joint])


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
