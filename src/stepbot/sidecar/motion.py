"""How a joint moves: its bounds, and the passive forces in it."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Tag

from .quantities import (
    JointBound,
    JointDamping,
    JointEffort,
    JointFriction,
    JointInertia,
    JointPosition,
    JointSpeed,
    JointStiffness,
)
from .section import Section


class LimitsSection(Section):
    """Bounds of a joint; the units are those of its type."""

    lower: JointBound | None = None
    """Lowest position [rad or m]; `-inf` for none."""
    upper: JointBound | None = None
    """Highest position [rad or m]; `inf` for none."""
    effort: JointEffort | None = None
    """Highest torque or force [N m or N]."""
    velocity: JointSpeed | None = None
    """Highest speed [rad/s or m/s]."""


def _limits_form(value: Any) -> str:
    """The word ``todo``, or a mapping."""
    return "<word>" if isinstance(value, str) else "<limits>"


JointLimits = Annotated[
    Annotated[Literal["todo"], Tag("<word>")] | Annotated[LimitsSection, Tag("<limits>")],
    Discriminator(_limits_form),
]
"""The limits of a joint, or `todo` as long as they are not known."""


class DynamicsSection(Section):
    """Passive forces of a joint; the units are those of its type."""

    damping: JointDamping | None = None
    """Viscous damping [N m s/rad or N s/m]."""
    friction: JointFriction | None = None
    """Coulomb friction [N m or N]."""
    stiffness: JointStiffness | None = None
    """Rate of a spring in the joint [N m/rad or N/m]."""
    spring_reference: JointPosition | None = None
    """Position [rad or m] where the spring is at rest."""
    armature: JointInertia | None = None
    """Inertia [kg m^2] or mass [kg] of the drive, seen at the joint."""
