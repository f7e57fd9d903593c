"""Meshes in closed form."""

import numpy as np

from stepbot.geometry.mesh import TriMesh


def trough(facets: int) -> TriMesh:
    """A block of 100 mm with a cylindrical trough of radius 100 mm and depth 13.4 mm, of ``facets`` flat strips."""
    x = np.linspace(-0.05, 0.05, facets + 1)
    z = np.sqrt(0.1**2 - 0.05**2) - np.sqrt(0.1**2 - x**2)
    low = np.full_like(x, -0.05)
    rows = [np.column_stack([x, np.full_like(x, y), height]) for y in (-0.05, 0.05) for height in (low, z)]
    n = len(x)
    front_low, front_high, back_low, back_high = (np.arange(n) + n * row for row in range(4))
    strips = [(front_low, front_high), (front_high, back_high), (back_high, back_low), (back_low, front_low)]
    faces = [
        triangle
        for a, b in strips
        for i in range(facets)
        for triangle in ((a[i], a[i + 1], b[i + 1]), (a[i], b[i + 1], b[i]))
    ]
    start, end = (front_low, front_high, back_high, back_low), (back_low, back_high, front_high, front_low)
    for a, b, c, d in ([row[0] for row in start], [row[-1] for row in end]):
        faces += [(a, b, c), (a, c, d)]
    return TriMesh.of(np.concatenate(rows), faces)


def dented_box(depth: float) -> TriMesh:
    """A box of 1 m whose top is a pyramid that points down, ``depth`` [m] deep."""
    corners = [(x, y, z) for z in (-0.5, 0.5) for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))]
    sides = [(i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4) for i in range(4)]
    squares = [(3, 2, 1, 0), *sides]
    faces = [triangle for a, b, c, d in squares for triangle in ((a, b, c), (a, c, d))]
    faces += [(i + 4, (i + 1) % 4 + 4, 8) for i in range(4)]
    return TriMesh.of([*corners, (0.0, 0.0, 0.5 - depth)], faces)
