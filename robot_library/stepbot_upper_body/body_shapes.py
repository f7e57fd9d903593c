"""Shapes of stand, torso, neck and head, each in the frame of its link [mm]."""

import build123d as bd

from .. import shapes
from ..limb_parts import across
from ..machine_parts import drilled, pin
from ..shapes import at, block, cylinder, lathe, on_circle, tube
from . import dimensions as d

MIDDLE = bd.Plane.XZ
"""The plane of symmetry."""
_DRIVE = 48.0
_DRIVE_START, _DRIVE_END = 118.0, 164.0
"""Radius of a shoulder's drive in the torso, and its start and end along y."""
_SEAM = 158.0
"""Height between abdomen and chest."""
_CHEST = (68.0, 0.0, 268.0)
"""Start of the lamp's seat in the chest."""


def draw_stand() -> bd.Part:
    """A foot with holes for bolts, and a column that carries the waist."""
    foot = drilled(pin(175, 16, rim=3), 5.5, 16, on_circle(6, 310))
    return (
        foot
        + lathe([(108, 16), (92, 40), (78, 90), (76, d.WAIST_Z - 12)])
        + at(pin(84, 10, rim=2, foot=2), (0, 0, d.WAIST_Z - 12))
    )


def draw_waist() -> bd.Part:
    """The turntable below the torso."""
    return at(pin(80, 18, foot=2), (0, 0, -2)) + at(cylinder(62, 24), (0, 0, 16))


def _trunk(*sections: tuple[float, float, float, float]) -> bd.Part:
    """A shell through rounded rectangles, each a height, its sizes along x and y, and the radius of its corners."""
    return shapes.loft(*(bd.Plane((0, 0, z)) * bd.RectangleRounded(x, y, edge) for z, x, y, edge in sections))


def draw_abdomen() -> bd.Part:
    """The shell of the trunk below the chest."""
    return _trunk((40, 126, 164, 44), (100, 132, 176, 48), (_SEAM, 144, 206, 56))


def draw_chest() -> bd.Part:
    """The shell of chest and shoulders, with seats for the shoulders' drives and the lamp."""
    body = _trunk((_SEAM, 158, 226, 60), (290, 192, 322, 80), (365, 178, 318, 76), (440, 118, 220, 48))
    seats = [across(cylinder(_DRIVE, 200), y, z=d.SHOULDER_Z) for y in (_DRIVE_START + 200, -_DRIVE_START)]
    return body - seats - at(cylinder(31, 60), _CHEST, (0, 90, 0))


def draw_lamp() -> bd.Part:
    """The lamp in the chest, x forwards: its ring."""
    return at(tube(31, 23, 32), _CHEST, (0, 90, 0))


def draw_light() -> bd.Part:
    """The lamp's glass in its ring."""
    return at(shapes.housing(23, 30, 3, 0), _CHEST, (0, 90, 0))


def draw_shoulder_drive() -> bd.Part:
    """The drive of the left shoulder's first axis, along y, its lid's rim outside."""
    return across(shapes.housing(_DRIVE, _DRIVE_END - _DRIVE_START, 0, 4), _DRIVE_END, z=d.SHOULDER_Z)


def draw_neck_seat() -> bd.Part:
    """The collar on top of the torso."""
    return at(pin(50, 10, rim=3), (0, 0, 440))


def draw_neck() -> bd.Part:
    """A column with the drive of nodding across it."""
    return pin(36, d.NOD_Z, foot=2) + across(shapes.housing(30, 84, 3, 3), 42, z=d.NOD_Z)


def _skull(grow: float) -> bd.Part:
    """The head's rounded box, larger by ``grow`` all around."""
    size = (172 + 2 * grow, 150 + 2 * grow, 186 + 2 * grow)
    return bd.Pos(18, 0, 104) * bd.fillet(bd.Box(*size).edges(), 58 + grow)


def draw_head() -> bd.Part:
    """The head's shell, open below around the drive of nodding."""
    neck = across(cylinder(33, 90), 45) + at(bd.Box(74, 90, 80), (0, 0, -38))
    return _skull(0) - neck


def draw_visor() -> bd.Part:
    """The dark glass of the face, 2 mm over the shell."""
    window = at(block(86, 124, 100, 36, only="z"), (60, 0, 108), (0, 90, 0))
    return (_skull(2) & window) - _skull(0)


def draw_eye(side: int) -> bd.Part:
    """An eye in the glass, a millimetre over it."""
    return ((_skull(3) & at(cylinder(13, 100), (60, side * 30, 114), (0, 90, 0))) - _skull(2)).solid()


def draw_ear() -> bd.Part:
    """The disc on the left side of the head, along y, fitted to the shell."""
    disc = across(shapes.housing(30, 26, 0, 3), 84, x=8, z=104) - across(tube(21, 18, 2), 84, x=8, z=104)
    return disc - _skull(0)
