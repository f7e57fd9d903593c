"""Draw the four-bar linkage: ``python -m robot_library.stepbot_four_bar.build`` in the root of the checkout.

Writes four_bar.step and expected.json beside this file; every run gives the same bytes.
"""

from pathlib import Path

import build123d as bd

from ..command import run
from ..step_file import Assembly, Occurrence, Part
from . import closed_form
from . import dimensions as d


def draw_bar(spec: d.Bar) -> bd.Solid:
    """A plate with round ends and a slot; on each end a hub with a bore, or with a spacer and a chamfered pin."""
    plate = _stadium(spec.length, d.BAR_RADIUS, d.PLATE)
    slot = _stadium(spec.slot.length, spec.slot.radius, d.PLATE)
    body = plate - bd.Pos(spec.slot.start, 0, 0) * slot
    for x, end in zip((0.0, spec.length), spec.ends, strict=True):
        body += bd.Pos(x, 0, d.PLATE) * _cylinder(d.HUB_RADIUS, d.HUB)
        if end == "pin":
            body += bd.Pos(x, 0, d.LAYER) * draw_pin()
        else:
            body -= bd.Pos(x, 0, 0) * _cylinder(d.BORE_RADIUS, d.LAYER)
    return body.solid()


def draw_pin() -> bd.Part:
    """A spacer to the next layer, and the pin through it."""
    pin = bd.chamfer(_cylinder(d.PIN_RADIUS, d.LAYER + d.TIP).edges().group_by(bd.Axis.Z)[-1], d.TIP)
    return _cylinder(d.SPACER_RADIUS, d.GAP) + bd.Pos(0, 0, d.GAP) * pin


def draw_base() -> bd.Solid:
    """A plate with four holes to bolt it to a table."""
    body = bd.Box(*d.BASE, align=_ON_FLOOR)
    for x, y in d.bolt_places():
        body -= bd.Pos(x, y, 0) * _cylinder(d.BOLT_RADIUS, d.BASE[2])
    return body.solid()


def draw_pillar() -> bd.Solid:
    """A block that carries one end of the ground bar."""
    return bd.Box(*d.PILLAR, align=_ON_FLOOR).solid()


def assembly() -> Assembly:
    """The whole linkage: a fixed frame and three moving bars."""
    bars = {spec.name: Part(spec.name, draw_bar(spec).wrapped, spec.color) for spec in d.BARS}
    base = Part("base", draw_base().wrapped, "#33373d")
    pillar = Part("pillar", draw_pillar().wrapped, "#6b737d")
    first, second = d.pillar_places()
    frame = Assembly(
        "frame",
        (
            Occurrence(base, "base:1", d.base_place()),
            Occurrence(pillar, "pillar:1", first),
            Occurrence(pillar, "pillar:2", second),
            Occurrence(bars["ground bar"], "ground bar:1", d.placed(d.GROUND_BAR)),
        ),
    )
    moving = (Occurrence(bars[spec.name], f"{spec.name}:1", d.placed(spec)) for spec in d.BARS[1:])
    return Assembly("four_bar", (Occurrence(frame, "frame:1"), *moving))


_ON_FLOOR = (bd.Align.CENTER, bd.Align.CENTER, bd.Align.MIN)


def _cylinder(radius: float, height: float) -> bd.Part:
    return bd.Cylinder(radius, height, align=_ON_FLOOR)


def _stadium(length: float, radius: float, height: float) -> bd.Part:
    ends = bd.Circle(radius) + bd.Pos(length, 0) * bd.Circle(radius)
    return bd.extrude(ends + bd.Pos(length / 2, 0) * bd.Rectangle(length, 2 * radius), height)


CLOSED_FORMS = {
    **{spec.name: closed_form.bar(spec) for spec in d.BARS},
    "base": closed_form.base(),
    "pillar": closed_form.pillar(),
}


if __name__ == "__main__":
    run(Path(__file__).parent / "four_bar.step", assembly, CLOSED_FORMS, closed_form.expected)
