"""Relative mobility of two bodies from the faces in contact: linear algebra on twists.

Each contact forbids some twists (w, v): a shared plane constrains its normal, a shared axis its line, a ball its
centre. The remaining twists are free. Planes constrain in both directions: faces that are drawn flush are assumed to
stay flush.
"""

from collections.abc import Iterable, Sequence
from enum import StrEnum

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.contacts import Fit, FitKind, Patch, Socket
from stepbot.geometry.spatial import Array, cross, cross_matrix, perpendicular_frame, unit
from stepbot.step.features.coaxial import signed

_Row = list[float]


class FreedomKind(StrEnum):
    """Kinds of relative mobility."""

    RIGID = "rigid"
    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"
    SCREW = "screw"
    CYLINDRICAL = "cylindrical"
    PLANAR = "planar"
    BALL = "ball"
    UNIVERSAL = "universal"
    LOOSE = "loose"
    """Anything else."""


_RANK = 2e-3
"""Singular value below which a twist is free: 1e-5 m over a part of 1 cm, or 1 mrad."""
_TURNING = 1e-2
"""Singular value of the free rotations below which there is no free rotation."""
_STEEP = 1e-2
"""Sine of an angle up to which directions of free twists agree; share of the size up to which a screw has no pitch."""
_SHORT = 0.1
"""Length of a shaft as a share of its radius, below which it does not constrain the direction."""


class Freedom(Struct, frozen=True, eq=False):
    """The free twists."""

    kind: FreedomKind
    dof: int
    point: Array | None = None
    """Shape (3,) [m]: on the axis; the centre of a ball or a universal joint."""
    direction: Array | None = None


def freedom(
    fits: Sequence[Fit], patches: Sequence[Patch], sockets: Sequence[Socket], about: Array, size: float
) -> Freedom:
    """The motion that the contacts leave free.

    Args:
        fits: Coaxial cylinders; flush ones constrain nothing.
        about: A reference point (3,) [m] near the contacts.
        size: Their extent [m], used to compare lengths with angles.
    """
    rows = list(_rows(fits, patches, sockets, about, size))
    if not rows:
        return Freedom(FreedomKind.LOOSE, 6)
    A = np.array(rows) / max(1.0, np.sqrt(len(rows)) / 3.0)
    _, values, twists = np.linalg.svd(A, full_matrices=True)
    return _named(twists[int((values > _RANK).sum()) :], about, size)


def _rows(
    fits: Sequence[Fit], patches: Sequence[Patch], sockets: Sequence[Socket], about: Array, size: float
) -> Iterable[_Row]:
    """Rows (6,) that are orthogonal to all allowed (w, v / size) about a point."""
    ax, ay, az = about.tolist()

    def keeps(point: Array, direction: _Row) -> _Row:
        px, py, pz = point.tolist()
        x, y, z = (px - ax) / size, (py - ay) / size, (pz - az) / size
        u, v, w = direction
        return [y * w - z * v, z * u - x * w, x * v - y * u, u, v, w]

    for fit in fits:
        if fit.kind == FitKind.FLUSH:
            continue
        guides = fit.kind == FitKind.HOLES or fit.length >= _SHORT * fit.radius_a
        for across in _across(fit.axis.d):
            yield keeps(fit.axis.point, across)
            if guides:
                yield [*across, 0.0, 0.0, 0.0]
    for patch in patches:
        yield keeps(patch.point, patch.normal.tolist())
        for across in _across(patch.normal):
            yield [*across, 0.0, 0.0, 0.0]
    for socket in sockets:
        for axis in ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]):
            yield keeps(socket.point, axis)


def _across(direction: Array) -> list[_Row]:
    """Two directions normal to a unit direction and to each other."""
    x, y, _ = perpendicular_frame(direction).T.tolist()
    return [x, y]


def _named(basis: Array, about: Array, size: float) -> Freedom:
    """Classify free twists (dof, 6)."""
    dof = len(basis)
    if dof == 0:
        return Freedom(FreedomKind.RIGID, 0)
    W, V = basis[:, :3], basis[:, 3:] * size
    _, values, directions = np.linalg.svd(W)
    turning = int((values > _TURNING).sum())
    if turning == 0 and dof == 1:
        return Freedom(FreedomKind.PRISMATIC, 1, about, _direction(V[0]))
    if turning == 1:
        return _about_one_axis(W, V, _direction(directions[0]), about, size)
    kind = {(3, 3): FreedomKind.BALL, (2, 2): FreedomKind.UNIVERSAL}.get((turning, dof))
    centre = _centre(W, V, about) if kind else None
    return Freedom(kind, dof, centre) if kind and centre is not None else Freedom(FreedomKind.LOOSE, dof)


def _about_one_axis(W: Array, V: Array, axis: Array, about: Array, size: float) -> Freedom:
    """Free twists that all rotate about one direction."""
    dof = len(W)
    velocity = V.T @ (np.linalg.pinv(W.T) @ axis)
    point = about + cross(axis, velocity)
    if dof == 1:
        has_pitch = abs(float(velocity @ axis)) > _STEEP * size
        return Freedom(FreedomKind.SCREW if has_pitch else FreedomKind.REVOLUTE, 1, point, axis)
    slides = V - np.outer(W @ axis, velocity)
    along = np.abs(np.linalg.svd(slides)[2][: dof - 1] @ axis)
    if dof == 2 and abs(along[0] - 1.0) < _STEEP:
        return Freedom(FreedomKind.CYLINDRICAL, 2, point - axis * float((point - about) @ axis), axis)
    if dof == 3 and along.max() < _STEEP:
        return Freedom(FreedomKind.PLANAR, 3, about, axis)
    return Freedom(FreedomKind.LOOSE, dof, point, axis)


def _centre(W: Array, V: Array, about: Array) -> Array | None:
    """The point (3,) that no twist moves."""
    A = np.concatenate([cross_matrix(w) for w in W])
    offset = np.linalg.lstsq(A, -V.reshape(-1), rcond=None)[0]
    residual = float(np.abs(A @ offset + V.reshape(-1)).max())
    return np.asarray(about + offset) if residual < 1e-5 + 1e-3 * float(np.abs(offset).max()) else None


def _direction(v: Array) -> Array:
    """The unit vector whose sign does not depend on that of ``v``."""
    return np.asarray(signed(unit(v)[None, :])[0])
