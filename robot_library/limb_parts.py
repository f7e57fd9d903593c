"""Shapes across a leg or an arm. Lengths are in millimetres."""

import build123d as bd

from .shapes import at


def across(shape: bd.Shape, y: float, x: float = 0.0, z: float = 0.0) -> bd.Shape:
    """A shape on z = 0, rotated along y: (x, y) becomes (x, z), and it extends from ``y`` towards smaller y."""
    return at(shape, (x, y, z), (90, 0, 0))


def rounded_rims(body: bd.Part, radius: float) -> bd.Part:
    """The body with rounded edges of its lowest and highest faces."""
    faces = body.faces().sort_by(bd.Axis.Z)
    return bd.fillet(faces[0].edges() + faces[-1].edges(), radius)
