"""Primitive shapes, each around the origin of its own frame."""

from msgspec import Struct

from .spatial import ZERO3, Vector3


class Box(Struct, frozen=True):
    """A box around its frame's origin."""

    size: Vector3
    """Full edge lengths [m]."""


class Cylinder(Struct, frozen=True):
    """A cylinder along z around its frame's origin."""

    radius: float
    """Radius [m]."""
    length: float
    """Full length [m]."""


class Sphere(Struct, frozen=True):
    """A sphere around its frame's origin."""

    radius: float
    """Radius [m]."""


class Capsule(Struct, frozen=True):
    """A cylinder along z with half spheres on both ends, around its frame's origin."""

    radius: float
    """Radius [m]."""
    length: float
    """Length [m] of the cylinder, without the half spheres."""


Primitive = Box | Cylinder | Sphere | Capsule


def primitive(kind: str, *, size: Vector3 = ZERO3, radius: float = 0.0, length: float = 0.0) -> Primitive | None:
    """The shape that descriptions call ``box``, ``cylinder``, ``sphere`` or ``capsule``; None for others."""
    match kind:
        case "box":
            return Box(size)
        case "cylinder":
            return Cylinder(radius, length)
        case "sphere":
            return Sphere(radius)
        case "capsule":
            return Capsule(radius, length)
    return None


def half_size(shape: Primitive) -> Vector3:
    """Half edge lengths [m] of the bounding box of a primitive, in its own frame."""
    match shape:
        case Box((x, y, z)):
            return 0.5 * x, 0.5 * y, 0.5 * z
        case Cylinder(radius, length):
            return radius, radius, 0.5 * length
        case Capsule(radius, length):
            return radius, radius, 0.5 * length + radius
        case Sphere(radius):
            return radius, radius, radius


Color = tuple[float, float, float, float]
"""Colour and opacity, each 0 to 1, sRGB."""


def srgb_from_linear(channel: float) -> float:
    """A channel of sRGB, 0 to 1, from a linear one."""
    return 12.92 * channel if channel <= 0.0031308 else 1.055 * float(channel) ** (1.0 / 2.4) - 0.055


def linear_from_srgb(channel: float) -> float:
    """A linear channel, 0 to 1, from one of sRGB."""
    return channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4
