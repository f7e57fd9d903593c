"""Axes that two components share, for a joint between them, and the axes that a joint could have."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from stepbot.geometry.spatial import Vector3, vector3
from stepbot.report.words import direction_words, in_millimetres, point_words
from stepbot.robot.joint_table import Basis
from stepbot.step.assembly import Assembly
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

_WORDS = {Basis.FIT: "shaft in bore", Basis.FLANGE: "equal bores", Basis.TOUCH: "faces touch", Basis.APART: "apart"}


Form = Literal["mate", "auto", "axis_of"]


@dataclass(frozen=True)
class SharedLine:
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
    """How an origin refers to it: by both components, by the links of both, or by the first component alone."""


MOST_LINES = 40
"""Maximum number of lines to choose among."""


@dataclass(frozen=True)
class Wanted:
    """What an existing origin selects a line by."""

    radius: float | None = None
    """[m]."""
    near: Vector3 | None = None
    """[m] in the assembly."""
    direction_only: bool = False
    """Whether parallel lines are equivalent, as for a prismatic joint."""
    all_explicit: bool = False
    """Whether the line that needs no selectors gets some, too: they state that it was chosen."""


def shared_lines(assembly: Assembly, a: int, b: int, link: Iterable[int] = ()) -> tuple[SharedLine, ...]:
    """The lines that two components share, everything below them included; the strongest first.

    Args:
        a: Index of a component.
        b: Index of another one.
        link: Components of the first one's link; if ``a`` and ``b`` share no line, those of the link and ``b``, or
            else those of ``a`` alone.
    """
    below = assembly.subtree(b)
    of_a, of_b = axis_faces(assembly, assembly.subtree(a)), axis_faces(assembly, below)
    form: Form = "mate"
    found = mates(of_a, of_b)
    if not found:
        form, found = "auto", mates(axis_faces(assembly, [index for index in link if index not in set(below)]), of_b)
    if not found:
        form, found = "axis_of", lines(of_a)
    chosen, offered = choose(found).line, selectors(found)
    pairs = list(zip(found, offered, strict=True))[:MOST_LINES]
    return tuple(_shared(assembly, a, line, line is chosen, one, form) for line, one in pairs)


def lines_of_origin(
    assembly: Assembly, a: Sequence[int], b: Sequence[int] | None, wanted: Wanted
) -> tuple[SharedLine, ...]:
    """The lines among which an origin selects, the strongest first.

    Args:
        a: Components of one side.
        b: Those of the other; None for an origin on the faces of one component.
        wanted: The selectors of the origin.
    """
    if not a:
        return ()
    faces = axis_faces(assembly, a)
    found = lines(faces) if b is None else mates(faces, axis_faces(assembly, b))
    candidates = [line for line in found if wanted.radius is None or _has_radius(line, wanted.radius)]
    selected = wanted.radius is not None
    chosen = choose(candidates, wanted.near, direction_only=wanted.direction_only, selected=selected).line
    plain = choose(found, direction_only=wanted.direction_only).line
    made = []
    for line in found:
        one = Selector() if line is plain and not wanted.all_explicit else selector(line, found)
        made.append(_shared(assembly, a[0], line, line is chosen, one, "mate"))
    return tuple(made)


def _has_radius(line: AxisLine, radius: float) -> bool:
    return bool(np.abs(np.array(line.radii) - radius).min() <= DISTANCE_TOLERANCE)


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
