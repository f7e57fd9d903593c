"""Closed forms of the arm, without CAD: mass, centre of mass and inertia of each link, frames and axes.

Every part is a sum of boxes and cylinders minus its bores, so each number is a formula.
"""

from typing import Any

from ..expected import frame, joint, mass_properties
from ..moments import Array, Moments, box, cylinder, frustum, half_cylinder, inverse, pose, total, turn
from . import dimensions as d

ALUMINIUM, STEEL, NYLON, ABS = 2700.0, 7850.0, 1010.0, 1040.0
"""[kg/m^3]: the first two are in the STEP, nylon is the sidecar's default, ABS its rule for the fingers."""
MOTOR_MASS = 0.18
"""[kg], measured: the sidecar's rule for the motor."""

ALONG_Y = turn("x", -d.QUARTER)
"""Rotates z to y."""


def base_plate() -> Moments:
    """Frame: the middle of the lower face."""
    x, y, z = d.BASE_PLATE
    bores = (cylinder(d.BOLT_BORE, z).moved(X) for X in d.screw_places())
    return box(x, y, z).at(0, 0, z / 2) - total(*bores)


def screw() -> Moments:
    """Frame: the middle of the end of the shank."""
    s = d.SCREW
    head = cylinder(s.head_radius, s.head) - cylinder(s.socket_radius, s.socket).at(0, 0, s.head - s.socket)
    return cylinder(s.shank_radius, s.shank) + head.at(0, 0, s.shank)


def column() -> Moments:
    """Frame: the middle of the lower face."""
    c = d.COLUMN
    tip = frustum(c.pivot_radius, c.pivot_radius - c.chamfer, c.chamfer)
    pivot = cylinder(c.pivot_radius, c.pivot) + tip.at(0, 0, c.pivot)
    bore = cylinder(c.bore, c.height + c.pivot + c.chamfer)
    return cylinder(c.radius, c.height) + pivot.at(0, 0, c.height) - bore


def turntable() -> Moments:
    """Frame: the middle of the lower face."""
    t = d.TURNTABLE
    return cylinder(t.radius, t.height) - cylinder(t.bore, t.height)


def cheek() -> Moments:
    """Frame: the centre of the round top, y through the plate."""
    c = d.CHEEK
    # A half disc with its flat side down: its x to z, its axis to y.
    upright = turn("y", -d.QUARTER) @ turn("x", -d.QUARTER)
    top = half_cylinder(c.half_width, c.thickness).at(0, 0, -c.thickness / 2).moved(pose(rotation=upright))
    bore = cylinder(c.bore, c.thickness).at(0, 0, -c.thickness / 2).moved(pose(rotation=ALONG_Y))
    return top + box(2 * c.half_width, c.thickness, c.foot).at(0, 0, -c.foot / 2) - bore


def motor() -> Moments:
    """Frame: the middle of the front face, z along the axis."""
    m = d.MOTOR
    return cylinder(m.radius, m.length) + cylinder(m.encoder_radius, m.encoder).at(0, 0, m.length)


def beam() -> Moments:
    """Frame: the elbow's axis, x along the arm."""
    b = d.BEAM
    width = 2 * b.half_width
    across = pose(rotation=ALONG_Y)
    # The half disc behind the axis: its x to -x, its axis to y.
    behind = pose(rotation=turn("z", 2 * d.QUARTER) @ ALONG_Y)
    end = half_cylinder(b.half_height, width).at(0, 0, -b.half_width).moved(behind)
    block = box(b.length, width, 2 * b.half_height).at(b.length / 2, 0, 0)
    side = total(
        cylinder(b.spacer_radius, b.spacer_end - b.half_width).at(0, 0, b.half_width),
        cylinder(b.shaft_radius, b.shaft_end - b.spacer_end).at(0, 0, b.spacer_end),
    )
    openings = (cylinder(b.opening_radius, 2 * b.half_height).at(x, 0, -b.half_height) for x in b.openings)
    sides = side.moved(across) + side.moved(pose(rotation=turn("x", d.QUARTER)))
    return end + block + sides - total(*openings)


def palm() -> Moments:
    """Frame: the middle of the face at the beam."""
    p = d.PALM
    plate = box(p.plate, 2 * p.half_width, 2 * p.half_height).at(p.plate / 2, 0, 0)
    ear = box(p.ear_length, p.ear, 2 * p.half_height).at(p.plate + p.ear_length / 2, 0, 0)
    bore = cylinder(p.rod_bore, p.ear).at(0, 0, -p.ear / 2).moved(pose(rotation=ALONG_Y))
    ear -= bore.at(p.rod_x, 0, p.rod_z) + bore.at(p.rod_x, 0, -p.rod_z)
    y = p.half_width - p.ear / 2
    return plate + ear.at(0, y, 0) + ear.at(0, -y, 0)


def rod() -> Moments:
    """Frame: the middle, z along the rod."""
    return cylinder(d.ROD.radius, d.ROD.length).at(0, 0, -d.ROD.length / 2)


def finger() -> Moments:
    """Frame: the face that meets the other finger, y outwards, rods at x = 0."""
    f = d.FINGER
    (x, y, z), (length, thickness, height) = f.slider, f.blade
    bore = cylinder(f.bore, y).moved(pose(rotation=ALONG_Y))
    slider = box(x, y, z).at(0, y / 2, 0) - bore.at(0, 0, d.PALM.rod_z) - bore.at(0, 0, -d.PALM.rod_z)
    return slider + box(length, thickness, height).at(x / 2 + length / 2, thickness / 2, 0)


def parts() -> dict[str, Moments]:
    """Each part by its product name, in its own frame, density 1 [mm]."""
    return {
        "base plate": base_plate(),
        "screw M6x12": screw(),
        "column": column(),
        "turntable": turntable(),
        "cheek": cheek(),
        "elbow motor": motor(),
        "beam": beam(),
        "palm": palm(),
        "rod": rod(),
        "finger": finger(),
    }


def links(elbow: float, opening: float) -> dict[str, Moments]:
    """Each link in the assembly's frame [kg, m], the elbow raised by ``elbow`` [rad], each finger open [mm]."""
    p = {name: body.in_metres() for name, body in parts().items()}
    base = p["base plate"] + p["column"].moved(_m(pose((0, 0, d.BASE_PLATE[2]))))
    screws = (p["screw M6x12"].moved(_m(X)).weighing(STEEL) for X in d.screw_places())
    cheeks = (p["cheek"].moved(_m(X)).weighing(ALUMINIUM) for X in d.cheek_places())
    motor = p["elbow motor"].moved(_m(d.motor_place()))
    X_WF = d.forearm_place(elbow)
    X_WG = X_WF @ d.gripper_place()
    rods = (p["rod"].moved(_m(X_WG @ X)).weighing(STEEL) for X in d.rod_places())
    left, right = (p["finger"].moved(_m(X_WG @ X)).weighing(ABS) for X in d.finger_places(opening))
    return {
        "base": base.weighing(ALUMINIUM) + total(*screws),
        "upper_arm": total(
            p["turntable"].moved(_m(d.turntable_place())).weighing(ALUMINIUM),
            *cheeks,
            motor.weighing(MOTOR_MASS / motor.mass),
        ),
        "forearm": total(
            p["beam"].moved(_m(X_WF)).weighing(ALUMINIUM), p["palm"].moved(_m(X_WG)).weighing(NYLON), *rods
        ),
        "left_finger": left,
        "right_finger": right,
    }


def _m(X_AB: Array) -> Array:
    """A pose in millimetres, in metres."""
    return pose(X_AB[:3, 3] / 1000, X_AB[:3, :3])


def joint_frames() -> dict[str, Array]:
    """Joint frames at q = 0, shape (4, 4) [m]. The origins of the sliding fingers are arbitrary."""
    middle = d.TURNTABLE_FOOT + d.TURNTABLE.height / 2
    return {"shoulder": pose((0, 0, middle / 1000)), "elbow": pose((0, 0, d.ELBOW_HEIGHT / 1000), ALONG_Y)}


def expected() -> dict[str, Any]:
    """The content of expected.json."""
    drawn, zero = links(d.ELBOW_DRAWN, d.FINGER_DRAWN), links(0.0, 0.0)
    opening = d.FINGER_DRAWN / 1000
    frames = joint_frames()
    link_frames = {"base": pose(), "upper_arm": frames["shoulder"], "forearm": frames["elbow"]}
    tool = _m(d.forearm_place(0.0) @ d.gripper_place() @ pose((d.TOOL, 0, 0)))
    return {
        "robot": "arm2",
        "about": "Closed forms from closed_form.py [m, kg, rad]; no CAD kernel took part. Everything is in the frame "
        "of the assembly, at q = 0 and as drawn; inertias are about the centre of mass. link_frames holds the frames "
        "at q = 0 of the links whose joint fixes an origin, and their mass properties along them.",
        "drawn": {"shoulder": 0.0, "elbow": d.ELBOW_DRAWN, "finger": opening, "finger_mirror": opening},
        "links_at_zero": {name: mass_properties(body) for name, body in zero.items()},
        "links_as_drawn": {name: mass_properties(body) for name, body in drawn.items()},
        "link_frames": {
            name: {"frame": frame(X_WL), "in_link_frame": mass_properties(zero[name].moved(inverse(X_WL)))}
            for name, X_WL in link_frames.items()
        },
        "total_at_zero": mass_properties(total(*zero.values())),
        "total_as_drawn": mass_properties(total(*drawn.values())),
        "joints": {
            "shoulder": joint(frames["shoulder"], (0, 0, 1)),
            "elbow": joint(frames["elbow"], (0, -1, 0)),
            "finger": {"axis": [0, 1, 0]},
            "finger_mirror": {"axis": [0, -1, 0]},
        },
        "frames": {"tool0": frame(tool)},
    }
