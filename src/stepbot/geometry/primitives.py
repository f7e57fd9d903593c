"""Primitive shapes, each around the origin of its own frame."""

from dataclasses import dataclass

from .spatial import Vector3


@dataclass(frozen=True)
class Box:
    """A box around its frame's origin."""

    size: Vector3
    """Full edge lengths [m]."""


@dataclass(frozen=True)
class Cylinder:
    """A cylinder along z around its frame's origin."""

    radius: float
    """Radius [m]."""
    length: float
    """Full length [m]."""


@dataclass(frozen=True)
class Sphere:
    """A sphere around its frame's origin."""

    radius: float
    """Radius [m]."""


@dataclass(frozen=True)
class Capsule:
    """A cylinder along z with half spheres on both ends, around its frame's origin."""

    radius: float
    """Radius [m]."""
    length: float
    """Length [m] of the cylinder, without the half spheres."""


Primitive = Box | Cylinder | Sphere | Capsule
