"""Draw the arm: ``python -m robot_library.stepbot_arm2.build [--unit inch] [-o FILE]`` in the root of the checkout.

Writes arm2.step and expected.json beside this file; every run gives the same bytes. ``--unit`` changes the length unit
of the file, not the arm.
"""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import build123d as bd

from ..command import run
from ..moments import Array, pose
from ..step_file import Assembly, Occurrence, Part
from . import closed_form
from . import dimensions as d

_FLOOR = (bd.Align.CENTER, bd.Align.CENTER, bd.Align.MIN)
_BEHIND = (bd.Align.MIN, bd.Align.CENTER, bd.Align.CENTER)
_ACROSS = bd.Rot(-90, 0, 0)
"""Rotates z to y."""


def draw_base_plate() -> bd.Solid:
    """A plate with four bores for the screws."""
    bores = [bd.Pos(*X[:3, 3]) * _cylinder(d.BOLT_BORE, d.BASE_PLATE[2]) for X in d.screw_places()]
    return (bd.Box(*d.BASE_PLATE, align=_FLOOR) - bores).solid()


def draw_screw() -> bd.Solid:
    """A shank, and a head with a round socket."""
    s = d.SCREW
    head = _cylinder(s.head_radius, s.head) - bd.Pos(0, 0, s.head - s.socket) * _cylinder(s.socket_radius, s.socket)
    return (_cylinder(s.shank_radius, s.shank) + bd.Pos(0, 0, s.shank) * head).solid()


def draw_column() -> bd.Solid:
    """A hollow post with a chamfered pivot on top."""
    c = d.COLUMN
    pivot = _cylinder(c.pivot_radius, c.pivot + c.chamfer)
    pivot = bd.chamfer(pivot.edges().group_by(bd.Axis.Z)[-1], c.chamfer)
    post = _cylinder(c.radius, c.height) + bd.Pos(0, 0, c.height) * pivot
    return (post - _cylinder(c.bore, c.height + c.pivot + c.chamfer)).solid()


def draw_turntable() -> bd.Solid:
    """A disc with a bore for the pivot."""
    return (_cylinder(d.TURNTABLE.radius, d.TURNTABLE.height) - _cylinder(d.TURNTABLE.bore, d.TURNTABLE.height)).solid()


def draw_cheek() -> bd.Solid:
    """A plate with a round top and a bore for the elbow's shaft."""
    c = d.CHEEK
    foot = bd.Box(2 * c.half_width, c.thickness, c.foot, align=(bd.Align.CENTER, bd.Align.CENTER, bd.Align.MAX))
    plate = foot + _ACROSS * bd.Cylinder(c.half_width, c.thickness)
    return (plate - _ACROSS * bd.Cylinder(c.bore, c.thickness)).solid()


def draw_motor() -> bd.Solid:
    """A round case with an encoder on its back."""
    m = d.MOTOR
    return (_cylinder(m.radius, m.length) + bd.Pos(0, 0, m.length) * _cylinder(m.encoder_radius, m.encoder)).solid()


def draw_beam() -> bd.Solid:
    """A block with a round end, a shaft across it between two spacers, and three openings."""
    b = d.BEAM
    block = bd.Box(b.length, 2 * b.half_width, 2 * b.half_height, align=_BEHIND)
    beam = block + _ACROSS * bd.Cylinder(b.half_height, 2 * b.half_width)
    beam += _ACROSS * bd.Cylinder(b.spacer_radius, 2 * b.spacer_end)
    beam += _ACROSS * bd.Cylinder(b.shaft_radius, 2 * b.shaft_end)
    return (beam - [bd.Pos(x, 0, 0) * bd.Cylinder(b.opening_radius, 2 * b.half_height) for x in b.openings]).solid()


def draw_palm() -> bd.Solid:
    """A plate with two ears, bored for the rods."""
    p = d.PALM
    palm = bd.Box(p.plate, 2 * p.half_width, 2 * p.half_height, align=_BEHIND)
    for side in (1, -1):
        y = side * (p.half_width - p.ear / 2)
        palm += bd.Pos(p.plate, y, 0) * bd.Box(p.ear_length, p.ear, 2 * p.half_height, align=_BEHIND)
    return (palm - [_rod_bore(p.rod_bore, 2 * p.half_width, p.rod_x, side * p.rod_z) for side in (1, -1)]).solid()


def draw_rod() -> bd.Solid:
    """A round bar."""
    return bd.Cylinder(d.ROD.radius, d.ROD.length).solid()


def draw_finger() -> bd.Solid:
    """A slider that runs on both rods, and a blade that grips."""
    f = d.FINGER
    slider = bd.Box(*f.slider, align=(bd.Align.CENTER, bd.Align.MIN, bd.Align.CENTER))
    blade = bd.Box(*f.blade, align=(bd.Align.MIN, bd.Align.MIN, bd.Align.CENTER))
    finger = slider + bd.Pos(f.slider[0] / 2, 0, 0) * blade
    return (finger - [_rod_bore(f.bore, 2 * f.slider[1], 0, side * d.PALM.rod_z) for side in (1, -1)]).solid()


def _rod_bore(radius: float, length: float, x: float, z: float) -> bd.Part:
    return bd.Pos(x, 0, z) * (_ACROSS * bd.Cylinder(radius, length))


def _cylinder(radius: float, height: float) -> bd.Part:
    return bd.Cylinder(radius, height, align=_FLOOR)


def assembly() -> Assembly:
    """Base, shoulder and forearm; the gripper is an assembly inside the forearm."""
    aluminium = partial(Part, material="aluminium 6082", density=closed_form.ALUMINIUM)
    steel = partial(Part, material="steel", density=closed_form.STEEL)
    base_plate = aluminium("base plate", draw_base_plate().wrapped, "#2f3640")
    screw = steel("screw M6x12", draw_screw().wrapped, "#1e1e1e")
    column = aluminium("column", draw_column().wrapped, "#a4b0be")
    turntable = aluminium("turntable", draw_turntable().wrapped, "#f08a24")
    cheek = aluminium("cheek", draw_cheek().wrapped, "#f08a24")
    motor = Part("elbow motor", draw_motor().wrapped, "#1e1e1e")
    beam = aluminium("beam", draw_beam().wrapped, "#f1f2f6")
    palm = Part("palm", draw_palm().wrapped, "#57606f")
    rod = steel("rod", draw_rod().wrapped, "#ced6e0")
    finger = Part("finger", draw_finger().wrapped, "#2e86de")

    base = Assembly(
        "base",
        [
            Occurrence(base_plate, "base plate:1"),
            Occurrence(column, "column:1", pose((0, 0, d.BASE_PLATE[2]))),
            *_several(screw, d.screw_places()),
        ],
    )
    shoulder = Assembly(
        "shoulder",
        [
            Occurrence(turntable, "turntable:1", d.turntable_place()),
            *_several(cheek, d.cheek_places()),
            Occurrence(motor, "elbow motor:1", d.motor_place()),
        ],
    )
    fingers = _several(finger, d.finger_places(d.FINGER_DRAWN))
    gripper = Assembly("gripper", [Occurrence(palm, "palm:1"), *_several(rod, d.rod_places()), *fingers])
    forearm = Assembly("forearm", [Occurrence(beam, "beam:1"), Occurrence(gripper, "gripper:1", d.gripper_place())])
    return Assembly(
        "arm2",
        [
            Occurrence(base, "base:1"),
            Occurrence(shoulder, "shoulder:1"),
            Occurrence(forearm, "forearm:1", d.forearm_place(d.ELBOW_DRAWN)),
        ],
    )


def _several(part: Part, places: Sequence[Array]) -> list[Occurrence]:
    return [Occurrence(part, f"{part.name}:{i}", X) for i, X in enumerate(places, start=1)]


if __name__ == "__main__":
    run(Path(__file__).parent / "arm2.step", assembly, closed_form.parts(), closed_form.expected)
