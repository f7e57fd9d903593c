"""How a joint moves: its bounds, and the passive forces in it."""

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
