"""Limits, passive forces and coupling of a joint."""

from typing import Annotated, Literal

from pydantic import Tag

from .quantities import (
    JointAcceleration,
    JointBound,
    JointDamping,
    JointEffort,
    JointFriction,
    JointInertia,
    JointJerk,
    JointPosition,
    JointSpeed,
    JointStiffness,
    JointValue,
    Multiplier,
)
from .section import WORD_OR_MAPPING, Reference, Section


class LimitsSection(Section):
    """Limits of a joint; the units depend on its type."""

    lower: JointBound | None = None
    """Lowest position [rad or m]; `-inf` for unlimited."""
    upper: JointBound | None = None
    """Highest position [rad or m]; `inf` for unlimited."""
    effort: JointEffort | None = None
    """Maximum torque or force [N m or N]."""
    velocity: JointSpeed | None = None
    """Maximum velocity [rad/s or m/s]."""
    acceleration: JointAcceleration | None = None
    """Maximum acceleration [rad/s^2 or m/s^2], for URDF 1.2 and MoveIt."""
    deceleration: JointAcceleration | None = None
    """Maximum deceleration [rad/s^2 or m/s^2], if it is not that of `acceleration`."""
    jerk: JointJerk | None = None
    """Maximum rate of change of the acceleration [rad/s^3 or m/s^3], for URDF 1.2 and MoveIt."""


JointLimits = Annotated[
    Annotated[Literal["todo"], Tag("<word>")] | Annotated[LimitsSection, Tag("<mapping>")], WORD_OR_MAPPING
]
"""The limits of a joint, or `todo` if they are not known yet."""


class DynamicsSection(Section):
    """Passive forces of a joint; the units depend on its type."""

    damping: JointDamping | None = None
    """Viscous damping [N m s/rad or N s/m]."""
    friction: JointFriction | None = None
    """Coulomb friction [N m or N]."""
    stiffness: JointStiffness | None = None
    """Stiffness of a spring in the joint [N m/rad or N/m]."""
    spring_reference: JointPosition | None = None
    """Rest position [rad or m] of the spring."""
    armature: JointInertia | None = None
    """Inertia [kg m^2] or mass [kg] of the actuator, reflected to the joint."""


class MimicSection(Section):
    """q = multiplier * q of `joint` + offset."""

    joint: Reference
    """The joint to follow."""
    multiplier: Multiplier = JointValue(1.0)
    """Ratio of this joint's motion to the other's; with units where one turns and the other slides: `3 mm/rad`."""
    offset: JointPosition = JointValue(0.0)
    """Position [rad or m] of this joint when the other is at zero."""
