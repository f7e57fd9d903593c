"""Axes for joints: of a clicked face, of two components that share them, and those that a joint could have."""

from collections.abc import Iterable, Sequence
from typing import Literal

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array, Vector3, vector3
from stepbot.report.words import direction_words, in_millimetres, point_words
from stepbot.robot.joint_table import Basis
from stepbot.step.assembly import Assembly, AxisFace, Body
from stepbot.step.features.axes import (
    DISTANCE_TOLERANCE,
    AxisLine,
    Selector,
    axis_faces,
    choose,
    lines,
    mates,
    selector,
    selectors,
)
from stepbot.step.structure.paths import quoted

_ON_SURFACE = 2e-6
"""Distance [m] up to which a vertex lies on a cylinder: vertices are on a grid of a nanometre, the kernel's tolerance
is a micrometre."""


def clicked_face(
    assembly: Assembly, component: int, triangle: Sequence[Sequence[float]]
) -> tuple[AxisFace, str] | None:
    """The face that a triangle belongs to, and the ``origin`` of its axis in a sidecar; None if the face has no axis.

    Args:
        triangle: Corners (3, 3) [m] in the component's frame, to the accuracy of a drawing.
    """
    body = assembly.bodies[assembly.components[component].body]
    if not len(body.mesh.faces):
        return None
    corners = _nearest_triangle(body, np.array(triangle, dtype=np.float64).reshape(3, 3))
    face = min(body.axis_faces, key=lambda one: _distance(one, corners), default=None)
    if face is None or not _distance(face, corners) <= _ON_SURFACE:
        return None
    lines_of_component = lines(axis_faces(assembly, [component]))
    placed = face.moved(assembly.components[component].X_WC)
    index = min(range(len(lines_of_component)), key=lambda i: _apart(lines_of_component[i], placed))
    origin = f"{{axis_of: {quoted(assembly.components[component].path)}{selectors(lines_of_component)[index]}}}"
    return face, origin


def _nearest_triangle(body: Body, drawn: Array) -> Array:
    """Corners of the mesh's own triangle that was drawn: a drawing rounds them."""
    corners = body.mesh.vertices[body.mesh.faces]
    distances = np.linalg.norm(corners.mean(axis=1) - drawn.mean(axis=0), axis=1)
    return np.asarray(corners[int(distances.argmin())])


def _distance(face: AxisFace, corners: Array) -> float:
    """Largest distance [m] of corners (3, 3) from a face; infinite beyond its ends."""
    direction = np.array(face.direction)
    arm = corners - np.array(face.point)
    along = arm @ direction
    if along.min() < face.low - DISTANCE_TOLERANCE or along.max() > face.high + DISTANCE_TOLERANCE:
        return np.inf
    radii = np.linalg.norm(arm - np.outer(along, direction), axis=1)
    if not face.cone:
        return float(np.abs(radii - face.radius).max())
    # The lines of a cone meet its axis: three corners on it span a plane whose normal is not along the axis.
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    flat = abs(float(normal @ direction)) > (1.0 - 1e-6) * float(np.linalg.norm(normal))
    spread = along.max() - along.min()
    if flat or radii.max() > face.radius + _ON_SURFACE or spread <= 0.0:
        return np.inf
    slope = np.polyfit(along, radii, 1)
    return float(np.abs(np.polyval(slope, along) - radii).max())


def _apart(line: AxisLine, face: AxisFace) -> float:
    """How far a face's axis is from a line: distance [m] and sine of the angle, in one number."""
    turned = float(np.linalg.norm(np.cross(line.direction, face.direction)))
    return (
        line.distance_to(vector3(np.array(face.point) + 0.5 * (face.low + face.high) * np.array(face.direction)))
        + turned
    )


_WORDS = {Basis.FIT: "shaft in bore", Basis.FLANGE: "equal bores", Basis.TOUCH: "faces touch", Basis.APART: "apart"}


Form = Literal["mate", "auto", "second", "first"]


class SharedLine(Struct, frozen=True):
    """A line with cylindrical faces that a joint can turn about."""

    words: str
    """``shaft in bore, radius 8 mm, +z through [0, 12.5, 3] mm``."""
    chosen: bool
    """Whether the origin means it."""
    radius: float | None
    """Selects it by its radius [m]; None if not needed."""
    near: Vector3 | None
    """Selects it by a point [m] of the assembly; None if not needed."""
    component: str
    """A component with a body, in whose frame the line is given."""
    point: Vector3
    """[m]."""
    direction: Vector3
    form: Form = "mate"
    """How an origin refers to it: by both components, by the links of both, or by one component alone."""


MOST_LINES = 40
"""Maximum number of lines to choose among."""


def shared_lines(assembly: Assembly, a: int, b: int, link: Iterable[int] = ()) -> tuple[SharedLine, ...]:
    """The lines that two components share, everything below them included; the strongest first.

    Args:
        link: Components of the first one's link; if ``a`` and ``b`` share no line, those of the link and ``b``, or
            else those of each alone, ``b`` first.
    """
    below = assembly.subtree(b)
    of_a, of_b = axis_faces(assembly, assembly.subtree(a)), axis_faces(assembly, below)
    form: Form = "mate"
    shared = mates(of_a, of_b)
    if not shared:
        form, shared = "auto", mates(axis_faces(assembly, [index for index in link if index not in set(below)]), of_b)
    if shared:
        return _offered(assembly, a, shared, form)[:MOST_LINES]
    return (*_offered(assembly, b, lines(of_b), "second"), *_offered(assembly, a, lines(of_a), "first"))[:MOST_LINES]


def _offered(assembly: Assembly, a: int, lines: Sequence[AxisLine], form: Form) -> tuple[SharedLine, ...]:
    chosen = choose(lines).line
    pairs = zip(lines, selectors(lines), strict=True)
    return tuple(_shared(assembly, a, line, line is chosen, one, form) for line, one in pairs)


def lines_of_origin(
    assembly: Assembly,
    a: Sequence[int],
    b: Sequence[int] | None,
    selected: Selector,
    *,
    direction_only: bool = False,
    all_explicit: bool = False,
) -> tuple[SharedLine, ...]:
    """The lines among which an origin selects, the strongest first.

    Args:
        a: Components of one side.
        b: Those of the other; None for an origin on the faces of one component.
        selected: What the origin selects a line by.
        direction_only: Whether parallel lines are equivalent, as for a prismatic joint.
        all_explicit: Whether the line that needs no selectors gets some, too: they state that it was chosen.
    """
    if not a:
        return ()
    faces = axis_faces(assembly, a)
    all_lines = lines(faces) if b is None else mates(faces, axis_faces(assembly, b))
    radius = selected.radius
    candidates = [
        one for one in all_lines if radius is None or min(abs(r - radius) for r in one.radii) <= DISTANCE_TOLERANCE
    ]
    chosen = choose(candidates, selected.near, direction_only=direction_only, selected=radius is not None).line
    plain = choose(all_lines, direction_only=direction_only).line
    made = []
    for line in all_lines:
        one = Selector() if line is plain and not all_explicit else selector(line, all_lines)
        made.append(_shared(assembly, a[0], line, line is chosen, one, "mate"))
    return tuple(made)


def _shared(assembly: Assembly, a: int, line: AxisLine, chosen: bool, offered: Selector, form: Form) -> SharedLine:
    shown = next((i for i in assembly.subtree(a) if assembly.components[i].body >= 0), a)
    X_CW = assembly.components[shown].X_WC.inverse()
    return SharedLine(
        _words(line),
        chosen,
        offered.radius,
        offered.near,
        assembly.components[shown].path,
        vector3(X_CW.apply(line.point)),
        vector3(X_CW.turn(line.direction)),
        form,
    )


def _words(line: AxisLine) -> str:
    """How the faces of a line meet, their radii, and where it is."""
    radii = " and ".join(in_millimetres(radius) for radius in line.radii[:2])
    how = f"{_WORDS[line.basis]}, " if line.basis in _WORDS else ""
    return f"{how}radius {radii} mm, {direction_words(line.direction)} through {point_words(line.point)}"
