"""Draw the desk arm: ``python -m robot_library.stepbot_desk_arm.build`` in the root of the checkout.

Writes desk_arm.step and expected.json beside this file; every run gives the same bytes.
"""

from math import pi

import build123d as bd

from .. import shapes
from ..limb_parts import across
from ..machine import PLASTIC, RUBBER, STEEL, JointFrame, Link, Machine, Material, draw, part, placed
from ..machine_parts import chamfered_top, drilled, pin, plate, slab
from ..moments import Array, pose, turn
from ..shapes import at, block, cylinder, hull_plate, on_circle
from . import closed_form
from . import dimensions as d

SERVO = Material("servo, as weighed", 1560.0, shapes.BLACK)
"""55 g in its outer dimensions."""
PRINTED = Material("PLA, printed", 1000.0, shapes.YELLOW)
"""Walls and infill together."""
BOARD = Material("circuit board, as weighed", 1900.0, shapes.GREEN)

_OUT = d.SERVO[0] - d.SERVO_END
"""From a servo's axis to its farther end."""
_ACROSS = d.SERVO[1] / 2
_LYING = turn("x", -pi / 2)
"""Turns z to y, and keeps x."""
_BACKWARDS = turn("z", pi)


def servo_box() -> bd.Part:
    """The volume of a servo between its faces, the axis z through the origin, its longer end towards x."""
    return bd.Pos(d.SERVO[0] / 2 - d.SERVO_END, 0, 0) * bd.Box(*d.SERVO)


def draw_servo() -> bd.Part:
    """The servo's case: a seam around it, the socket of a plug, countersinks for its screws."""
    body = servo_box()
    middle = d.SERVO[0] / 2 - d.SERVO_END
    seam = bd.Pos(middle, 0, 0) * (bd.Box(60, 40, 0.8) - bd.Box(d.SERVO[0] - 1, d.SERVO[1] - 1, 2))
    sinks = [at(cylinder(1.6, 3), (x, y * 9, z)) for x in (-7, 31) for y in (1, -1) for z in (-d.HALF, d.HALF - 3)]
    return body - [bd.Pos(0, 0, z) * seam for z in (-9, 9)] - sinks


def draw_horn() -> bd.Part:
    """A horn on the servo's face z = 0: a disc with holes for its screws."""
    return drilled(pin(d.HORN_RADIUS, d.HORN, rim=0.4), 1.0, d.HORN, on_circle(4, 14, 45))


def draw_foot() -> bd.Part:
    """The base: a foot with holes for the desk's screws, and a tower around the pan servo, open in front."""
    foot = chamfered_top(hull_plate([((40, 0), 24), ((-74, 34), 12), ((-74, -34), 12)], 8), 1.5)
    tower = at(block(64, 38, d.PAN_FLOOR + d.SERVO[2] - 7, 6, only="z"), (-14, 0, 8))
    tower = chamfered_top(tower, 2)
    walls = foot + tower - bd.Rot(0, 0, 180) * at(servo_box(), (0, 0, d.PAN_FLOOR + d.HALF))
    walls -= at(block(20, 26, d.SERVO[2], 3, only="z"), (18, 0, d.PAN_FLOOR))
    walls -= [at(cylinder(9, 60), (-24, 30, 32), (90, 0, 0)), at(cylinder(11, 80), (0, 0, 30))]
    return drilled(walls, 2.6, 8, [(-74, 34), (-74, -34), (46, 12), (46, -12)])


def draw_board() -> bd.Part:
    """The servos' board behind the tower, standing on z = 0, its plugs on top."""
    return plate(26, 52, 1.6, edge=2) + [at(block(7, 9, 8), (x, y, 1.6)) for x, y in ((6, -14), (6, 0), (6, 14))]


def draw_socket() -> bd.Part:
    """The barrel of the power plug on the board."""
    return block(13, 9, 11, 1, only="x")


def draw_shoulder() -> bd.Part:
    """The link above the pan: a disc on its horn, and a bracket that holds the lift servo upright, horns sideways."""
    rise = d.SHOULDER_Z - d.pan_height()
    disc = pin(26, 6, rim=1)
    stem = at(block(50, 2 * d.HALF, rise - 6, 5, only="z"), (d.SHOULDER_X - 15, 0, 6))
    slope = at(bd.Box(40, 60, 60), (d.SHOULDER_X - 50, 0, rise + 6), (0, -32, 0))
    body = disc + stem - slope - _box_at((d.SHOULDER_X, 0, rise), down=True)
    return body - at(bd.Box(40, 60, 40), (d.SHOULDER_X + 6, 0, rise + 12.5))


def _box_at(place: tuple[float, float, float], down: bool = False, back: bool = False) -> bd.Shape:
    """The volume of a servo at a position, its axis along y, its longer end forwards, backwards or downwards."""
    lying = at(servo_box(), rpy=(-90, 0, 0))
    return bd.Pos(*place) * bd.Rot(0, 90 if down else 180 if back else 0, 0) * lying


def draw_upper_arm() -> bd.Part:
    """Two plates from the lift's horns to the elbow's, a spine behind between them."""
    outline = hull_plate([((0, 0), 15), ((0, d.UPPER), 13)], d.PLATE)
    hollow = hull_plate([((3, 32), 5.5), ((3, d.UPPER - 32), 5)], d.PLATE)
    web = chamfered_top(outline, 1.2) - hollow
    sides = [across(web, -d.GAP), bd.Rot(0, 0, 180) * across(web.mirror(bd.Plane.YZ), -d.GAP)]
    spine = at(block(7, 2 * d.GAP, 62, 2, only="y"), (-10, 0, 27))
    bores = [across(cylinder(2.2, 60), 30, z=z) for z in (0, d.UPPER)]
    return sides[0] + sides[1] + spine - bores


def draw_forearm() -> bd.Part:
    """The spine between the elbow's servo and the wrist's, a grip around the end of each."""
    start, end = _OUT, d.FORE - _OUT
    web = at(block(end - start + 26, 2 * d.HALF, d.SERVO[1] + 8, 6, only="y"), ((start + end) / 2, 0, -_ACROSS - 4))
    body = web - _box_at((0, 0, 0)) - _box_at((d.FORE, 0, 0), back=True)
    windows = [across(hull_plate([((start + 16, 0), 8), ((end - 16, 0), 8)], 9), y) for y in (d.HALF, -d.HALF + 9)]
    return body - windows


def draw_wrist() -> bd.Part:
    """The yoke on the wrist's horns, with the roll servo's seat across its front."""
    seat = d.WRIST - d.HORN - d.SERVO[2]
    web = hull_plate([((0, 0), 13), ((seat - 6, 0), 13)], d.PLATE)
    web -= at(bd.Box(30, 40, 20), (seat + 15, 0, 0))
    sides = [across(web, -d.GAP), across(web, d.GAP + d.PLATE)]
    wall = at(block(2 * (d.GAP + d.PLATE), 30, 5, 3, only="z"), (seat - 5, 0, 0), (90, 0, 90))
    bores = across(cylinder(2.2, 60), 30)
    return wall + sides[0] + sides[1] - bores


def draw_palm() -> bd.Part:
    """The link after the roll: a plate on its horn, a shell around the jaw's servo, and the fixed jaw."""
    disc = at(pin(15, 5, foot=0), (0, 0, 0), (0, 90, 0))
    inner = d.JAW_X - _ACROSS
    shell = at(block(inner + 24 - 5, 46, 2 * d.HALF, 4, only="z"), ((inner + 24 + 5) / 2, -5, -d.HALF))
    end, start = d.TIP + 6, inner + 18
    outline = [(start, -26), (start + 8, -26), (end, -10), (end, -3), (62, -3), (48, -11), (start, -13)]
    finger = slab(outline, 2 * d.HALF - 4)
    body = disc + shell + at(finger, (0, 0, -d.HALF + 2))
    servo = at(bd.Rot(0, 0, -90) * servo_box(), (d.JAW_X, d.JAW_Y, 0))
    room = at(block(40, 30, 2 * d.HALF), (d.JAW_X + 7, d.JAW_Y + 4, -d.HALF))
    return body - servo - room


def draw_jaw() -> bd.Part:
    """The moving jaw: a fork on both horns, a finger in front; the axis z through the origin, closed along x."""
    end = d.TIP + 6 - d.JAW_X
    web = hull_plate([((0, 0), 13), ((26, -4), 9)], d.PLATE)
    finger = slab([(18, -13.5), (30, -13.5), (end, -13.5), (end, -8), (32, 5), (18, 5)], 2 * d.HALF - 4)
    bridge = slab([(18, -13.5), (32, -13.5), (32, 5), (18, 5)], 2 * (d.GAP + d.PLATE))
    body = at(web, (0, 0, d.GAP)) + at(web, (0, 0, -d.GAP - d.PLATE)) + at(finger, (0, 0, -d.HALF + 2))
    return body + at(bridge, (0, 0, -d.GAP - d.PLATE)) - at(cylinder(2.2, 60), (0, 0, -30))


def draw_pad() -> bd.Part:
    """The rubber on a jaw's inner face, 1.5 mm thick along y."""
    return at(block(34, 22, 1.5, 3, only="z"), rpy=(90, 0, 0))


def horns(X_LS: Array) -> list[Array]:
    """Frames of the two horns of a servo, given the frame of its axis."""
    return [X_LS @ pose((0, 0, d.HALF)), X_LS @ pose((0, 0, -d.HALF), turn("x", pi))]


def machine() -> Machine:
    """Base, shoulder, upper arm, forearm, wrist, gripper and its jaw."""
    servo, horn = part("STS3215", draw_servo(), SERVO), part("horn", draw_horn(), STEEL, shapes.LIGHT)
    pad = part("pad", draw_pad(), RUBBER)
    rise = d.SHOULDER_Z - d.pan_height()
    along_y = pose(rotation=_LYING)
    pan = pose((0, 0, d.PAN_FLOOR + d.HALF), _BACKWARDS)
    lift = pose((d.SHOULDER_X, 0, rise), turn("y", pi / 2) @ _LYING)
    wrist = pose((d.FORE, 0, 0), turn("y", pi) @ _LYING)
    roll = pose((d.WRIST - d.HORN - d.HALF, 0, 0), turn("y", pi / 2))
    jaw = pose((d.JAW_X, d.JAW_Y, 0), turn("z", -pi / 2))
    drawings = {
        "base": draw_foot,
        "shoulder": draw_shoulder,
        "upper arm": draw_upper_arm,
        "forearm": draw_forearm,
        "wrist": draw_wrist,
        "palm": draw_palm,
        "jaw": draw_jaw,
    }
    printed = {name: part(f"{name} print", drawing(), PRINTED) for name, drawing in drawings.items()}
    links = {
        "base": [
            *placed(printed["base"]),
            *placed(servo, pan),
            *placed(part("board", draw_board(), BOARD), pose((-64, 0, 8))),
            *placed(part("socket", draw_socket(), PLASTIC, shapes.BLACK), pose((-70, 0, 9.6))),
        ],
        "shoulder": [*placed(horn, pose((0, 0, -d.HORN))), *placed(printed["shoulder"]), *placed(servo, lift)],
        "upper_arm": [
            *placed(printed["upper arm"]),
            *placed(horn, *horns(along_y), *horns(pose((0, 0, d.UPPER), _LYING))),
        ],
        "forearm": [*placed(printed["forearm"]), *placed(servo, along_y, wrist)],
        "wrist": [*placed(printed["wrist"]), *placed(horn, *horns(along_y)), *placed(servo, roll)],
        "gripper_body": [
            *placed(printed["palm"]),
            *placed(horn, pose((-d.HORN, 0, 0), turn("y", pi / 2))),
            *placed(servo, jaw),
            *placed(pad, pose((84, -1.5, 0))),
        ],
        "jaw": [*placed(printed["jaw"]), *placed(horn, *horns(pose())), *placed(pad, pose((84 - d.JAW_X, -13.5, 0)))],
    }
    places = d.places()
    axes = ("z", "y", "y", "y", "x", "z")
    unit = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
    moving = list(places)[1:]
    return Machine(
        "desk_arm",
        [Link(name, places[name], links[name]) for name in places],
        {joint: JointFrame(places[link], unit[axis]) for joint, link, axis in zip(d.JOINTS, moving, axes, strict=True)},
        closed_form.known(),
    )


if __name__ == "__main__":
    draw(__file__, machine)
