"""Evidence for and against the axis line chosen for a joint."""

from collections.abc import Callable, Sequence

from stepbot.geometry.spatial import Vector3
from stepbot.robot.joint_table import Basis, Evidence, Rival, Side
from stepbot.step.features.axes import DISTANCE_TOLERANCE, OUTWEIGHS, AxisLine, LineFace, is_parallel, millimetres
from stepbot.step.structure.paths import quoted

RIVALS = 5
"""Maximum number of other lines in a record."""
_CENTRE = "a ball joint turns about the centre of its ball, and this is the middle of"
_OFF_CENTRE = f"{_CENTRE} the faces on the line"
_BALL = 1.02
"""Ratio of the two largest edges of a box up to which a ball, or one with flat ends, may be in it."""
CENTRE = (
    "give the centre of the ball: `origin: {xyz: [...]}`, as `stepbot init` drafts it, "
    "or `{center: PATH}` of a whole ball",
)
"""Remedy for a ball joint without a stated centre."""


def evidence_of(
    line: AxisLine,
    lines: Sequence[AxisLine],
    words: str,
    path: Callable[[int], str],
    *,
    selected: bool,
    radius: float | None = None,
    confirmed: bool = True,
    direction_only: bool = False,
    is_ball: bool = False,
) -> Evidence:
    """Describe how a frame on a line was found.

    Args:
        selected: Whether the sidecar selected the line by a radius or a point.
        radius: The radius [m] that it was selected by; None if by none.
        confirmed: Whether a selection is that of a person: if not, weak evidence for it stays a doubt.
        direction_only: Whether parallel lines are equivalent.
        is_ball: Whether the line is to give the centre of a ball joint.
    """
    parts = ", ".join(quoted(path(index)) for index in line.components)
    others = [one for one in lines if one is not line and not (direction_only and is_parallel(one, line))]
    return Evidence(
        line.basis,
        f"{words}, of faces of {parts}: {_placed(line)}",
        tuple(_side(face, path) for face in line.faces),
        line.overlap,
        selected,
        tuple(_side(face, path) for face in faces_of_radius(line, radius)),
        tuple(_rival(other, line) for other in others[:RIVALS]),
        "" if selected and confirmed else doubt(line, others) or (_OFF_CENTRE if is_ball else ""),
    )


def off_centre(box: tuple[Vector3, Vector3]) -> str:
    """Why the middle of a part's box [m] is not the centre of a ball joint; empty if the part may be a ball."""
    sizes = [high - low for low, high in zip(*box, strict=True)]
    _, middle, largest = sorted(sizes)
    if largest <= _BALL * middle:
        return ""
    return f"{_CENTRE} a box of {' x '.join(f'{1e3 * size:.4g}' for size in sizes)} mm, which is not that of a ball"


def faces_of_radius(line: AxisLine, radius: float | None) -> tuple[LineFace, ...]:
    """The faces on a line that a radius [m] selects it by; none without a radius."""
    if radius is None:
        return ()
    return tuple(face for face in line.members if abs(face.radius - radius) <= DISTANCE_TOLERANCE)


def doubt(line: AxisLine, others: Sequence[AxisLine]) -> str:
    """Why the evidence for a line that no person selected is weak; empty if it is strong."""
    if line.basis is Basis.APART:
        a, b = line.faces
        return f"{face_words(a)} and {face_words(b)} {_along(line)}"
    if line.basis is Basis.TOUCH:
        a, b = line.faces
        if abs(a.radius - b.radius) <= DISTANCE_TOLERANCE and a.bore == b.bore:
            both = f"two {'bores' if a.bore else 'shafts'} of radius {millimetres(a.radius)}"
            return f"{both} {_along(line)}, and no shaft is in a bore"
        if abs(a.radius - b.radius) <= DISTANCE_TOLERANCE:
            return f"{face_words(a)} and {face_words(b)} {_along(line)}, but the shaft is not in the bore"
        return f"{face_words(a)} and {face_words(b)} {_along(line)}, but their radii do not match"
    wider = [other for other in others if other.basis is Basis.TOUCH and other.weight >= OUTWEIGHS * line.weight]
    if wider and line.basis is not Basis.AXIS:
        several = f"{len(wider)} axes with wider faces have" if len(wider) > 1 else "an axis with wider faces has"
        return f"{several} faces that touch with different radii"
    return ""


def described(line: AxisLine, path: Callable[[int], str]) -> str:
    """A line shared by two sides, for the notes of a message: its faces, how they meet, and its position."""
    if len(line.faces) != 2:
        return _placed(line)
    sides = " and ".join(f"{face_words(face)} of {quoted(path(face.component))}" for face in line.faces)
    return f"{sides} {_along(line)}; {_directed(line)}"


def met(line: AxisLine) -> str:
    """How the two decisive faces of a shared line meet: ``shaft of ... and bore of ... overlap by 12 mm``."""
    return f"{' and '.join(map(face_words, line.faces))} {_along(line)}"


def radii_of(line: AxisLine) -> str:
    """The radii of a line's faces, formatted for messages."""
    radii = ", ".join(millimetres(radius).removesuffix(" mm") for radius in line.radii[:4])
    return f"radius {radii}{', ...' if len(line.radii) > 4 else ''} mm"


def _side(face: LineFace, path: Callable[[int], str]) -> Side:
    return Side(path(face.component), face.radius, face.bore)


def face_words(face: LineFace) -> str:
    """A face: ``bore of radius 4 mm``."""
    return f"{'bore' if face.bore else 'shaft'} of radius {millimetres(face.radius)}"


def _along(line: AxisLine) -> str:
    overlap = line.overlap or 0.0
    if round(abs(overlap), 6) == 0.0:
        return "meet end to end"
    return f"overlap by {millimetres(overlap)}" if overlap > 0.0 else f"are {millimetres(-overlap)} apart"


def _placed(line: AxisLine) -> str:
    return f"{radii_of(line)}, {_directed(line)}"


def _directed(line: AxisLine) -> str:
    at: Vector3 = line.point
    direction = ", ".join(f"{round(c, 6) + 0.0:.4g}" for c in line.direction)
    return f"direction [{direction}], at [{', '.join(map(millimetres, at))}]"


def _rival(other: AxisLine, line: AxisLine) -> Rival:
    return Rival(other.basis, other.point, other.direction, other.radii, other.weight / line.weight)
