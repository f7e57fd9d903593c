"""Axes that two components share, for a joint between them."""

from dataclasses import dataclass

from stepbot.geometry.spatial import Vector3, vector3
from stepbot.report.joint_words import in_millimetres
from stepbot.robot.joint_table import Basis
from stepbot.step.assembly import Assembly
from stepbot.step.features.axes import AxisLine, axis_faces, choose, mates, selectors

_WORDS = {Basis.FIT: "shaft in bore", Basis.FLANGE: "equal bores", Basis.TOUCH: "faces touch", Basis.APART: "apart"}


@dataclass(frozen=True)
class SharedLine:
    """A line with cylindrical faces of both components."""

    words: str
    """``shaft in bore, radius 8 mm``."""
    chosen: bool
    """Whether an origin without selectors means it."""
    radius: float | None
    """Selects it by its radius [m]; None if not needed."""
    near: Vector3 | None
    """Selects it by a point [m] of the assembly; None if not needed."""
    component: str
    """The first component, in whose frame the line is given."""
    point: Vector3
    """[m]."""
    direction: Vector3


def shared_lines(assembly: Assembly, a: int, b: int) -> tuple[SharedLine, ...]:
    """The lines that two components share, everything below them included; the strongest first."""
    found = mates(axis_faces(assembly, assembly.subtree(a)), axis_faces(assembly, assembly.subtree(b)))
    chosen = choose(found).line
    shown = next((i for i in assembly.subtree(a) if assembly.components[i].body >= 0), a)
    X_CW = assembly.components[shown].X_WC.inverse()
    return tuple(
        SharedLine(
            _words(line),
            line is chosen,
            selector.radius,
            selector.near,
            assembly.components[shown].path,
            vector3(X_CW.apply(line.point)),
            vector3(X_CW.turn(line.direction)),
        )
        for line, selector in zip(found, selectors(found), strict=True)
    )


def _words(line: AxisLine) -> str:
    """How the faces of a line meet, and their radii."""
    radii = " and ".join(in_millimetres(radius) for radius in line.radii[:2])
    return f"{_WORDS.get(line.basis, line.basis.value)}, radius {radii} mm"
