"""Closed forms of the four-bar linkage, without CAD: masses, centres, inertias, axes and the motion of the loop."""

from math import pi
from typing import Any

from ..expected import joint, link, mass_properties
from ..moments import Array, Moments, box, cylinder, frustum, pose, stadium, total, turn
from . import dimensions as d

ALUMINIUM, STEEL = 2700.0, 7850.0
"""[kg/m^3], as in the sidecar."""

AXIS = (0.0, -1.0, 0.0)
"""Of every joint: towards the viewer, so that counter-clockwise is positive."""


def bar(spec: d.Bar) -> Moments:
    """A bar in its own frame, density 1 [mm]: a plate with a slot, and on each end a hub with a bore or a pin."""
    body = stadium(spec.length, d.BAR_RADIUS, d.PLATE)
    body -= stadium(spec.slot.length, spec.slot.radius, d.PLATE).at(spec.slot.start, 0, 0)
    hub = cylinder(d.HUB_RADIUS, d.HUB).at(0, 0, d.PLATE)
    bore = cylinder(d.BORE_RADIUS, d.LAYER)
    pin = total(
        cylinder(d.SPACER_RADIUS, d.GAP).at(0, 0, d.LAYER),
        cylinder(d.PIN_RADIUS, d.LAYER).at(0, 0, d.LAYER + d.GAP),
        frustum(d.PIN_RADIUS, d.PIN_RADIUS - d.TIP, d.TIP).at(0, 0, 2 * d.LAYER + d.GAP),
    )
    for x, end in zip((0.0, spec.length), spec.ends, strict=True):
        body += (hub + pin if end == "pin" else hub - bore).at(x, 0, 0)
    return body


def base() -> Moments:
    """The base in its own frame, density 1 [mm]."""
    body = box(*d.BASE).at(0, 0, d.BASE[2] / 2)
    for x, y in d.bolt_places():
        body -= cylinder(d.BOLT_RADIUS, d.BASE[2]).at(x, y, 0)
    return body


def pillar() -> Moments:
    """A pillar in its own frame, density 1 [mm]."""
    return box(*d.PILLAR).at(0, 0, d.PILLAR[2] / 2)


def links() -> dict[str, Moments]:
    """Each link in the assembly's frame, in the drawing [kg, m]."""
    frame = total(
        base().moved(d.base_place()),
        *(pillar().moved(X) for X in d.pillar_places()),
        bar(d.GROUND_BAR).moved(d.placed(d.GROUND_BAR)),
    )
    moving = {spec.name: bar(spec).moved(d.placed(spec)).weighing(ALUMINIUM) for spec in d.BARS[1:]}
    return {name: body.in_metres() for name, body in {"ground": frame.weighing(STEEL), **moving}.items()}


def joint_frames() -> dict[str, Array]:
    """Frames of the joints and the closure, shape (4, 4) [m]: z along +y, the origin in the middle of the bore."""
    R = turn("x", -pi / 2)
    places = {
        "crank_turn": d.placed(d.CRANK_BAR) @ pose((0, 0, d.LAYER / 2)),
        "coupler_turn": d.placed(d.COUPLER_BAR) @ pose((0, 0, d.LAYER / 2)),
        "rocker_swing": d.placed(d.ROCKER_BAR) @ pose((0, 0, d.LAYER / 2)),
        "rocker_pin": d.placed(d.COUPLER_BAR) @ pose((d.COUPLER, 0, d.LAYER / 2)),
    }
    return {name: pose(X[:3, 3] / 1000, R) for name, X in places.items()}


def motion(crank_turn: float) -> dict[str, float]:
    """Joint positions [rad], 0 in the drawing, of the closed loop at a position of the crank [rad]."""
    now, drawn = d.closed(d.CRANK_ANGLE + crank_turn), d.closed(d.CRANK_ANGLE)
    coupler, rocker = (_near(a - b) for a, b in ((now.coupler, drawn.coupler), (now.rocker, drawn.rocker)))
    return {"crank_turn": crank_turn, "coupler_turn": coupler - crank_turn, "rocker_swing": rocker}


def _near(angle: float) -> float:
    """The same angle [rad] between -pi and pi: coupler and rocker only swing."""
    return (angle + pi) % (2 * pi) - pi


def expected() -> dict[str, Any]:
    """The content of expected.json."""
    frames = joint_frames()
    bodies = links()
    carried = {"crank": "crank_turn", "coupler": "coupler_turn", "rocker": "rocker_swing"}
    return {
        "robot": "four_bar",
        "about": "Closed forms from closed_form.py [m, kg, rad]; no CAD kernel took part. Poses and centres of mass "
        "are those of the drawing, in the frame of the assembly; inertias are about the centre of mass.",
        "links": {
            name: link(body, frames[carried[name]] if name in carried else pose()) for name, body in bodies.items()
        },
        "total": mass_properties(total(*bodies.values())),
        "joints": {name: joint(X, AXIS) for name, X in frames.items()},
        "linkage": {
            "lengths": {spec.name.removesuffix(" bar"): spec.length / 1000 for spec in d.BARS},
            "drawn": vars(d.closed(d.CRANK_ANGLE)),
            "motion": [motion(2 * pi * i / 72) for i in range(73)],
        },
    }
