"""A compiled MuJoCo model, with access to names."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class NamedModel:
    """A compiled model with the names of its elements."""

    engine: Any
    model: Any

    def name(self, kind: str, index: int) -> str:
        """Name of an element; empty if it has none. ``kind`` as in ``mjOBJ_<kind>``."""
        return self.engine.mj_id2name(self.model, getattr(self.engine.mjtObj, f"mjOBJ_{kind}"), index) or ""

    @property
    def bodies(self) -> range:
        """Indices of the links: every body but the world."""
        return range(1, self.model.nbody)

    def joint_type(self, joint: int) -> Any:
        """MuJoCo's name of a joint's type."""
        return self.engine.mjtJoint(self.model.jnt_type[joint])
