"""Draw the humanoid upper body: ``python -m robot_library.stepbot_upper_body.build`` in the root of the checkout.

Writes upper_body.step and expected.json beside this file; every run gives the same bytes.
"""

from math import pi

from .. import shapes
from ..machine import CAST, METAL, RUBBER, JointFrame, Link, Machine, Material, draw, part, placed
from ..moments import pose, turn
from ..step_file import Occurrence
from . import arm_shapes, body_shapes, closed_form
from . import dimensions as d

SHELL = Material("ABS shell, hollow", 420.0, shapes.WHITE)
"""Walls of 3 mm, weighed."""
TRUNK = Material("trunk, as weighed", 620.0, shapes.WHITE)
"""Shell, frame, computer and batteries."""
DRIVE = Material("drive, as weighed", 1300.0, shapes.DARK)
"""Motor, gear and bearings in their housing."""
HOLLOW = Material("cast aluminium, hollow", 1100.0, shapes.WHITE)

_AXES = {"pitch": (0, 1, 0), "roll": (1, 0, 0), "yaw": (0, 0, 1), "elbow": (0, 1, 0)}
_LINKS = ("shoulder", "shoulder_fork", "upper_arm", "forearm", "wrist", "wrist_cross", "hand")


def body() -> dict[str, list[Occurrence]]:
    """Parts of stand, torso, neck and head."""
    drive = part("shoulder drive", body_shapes.draw_shoulder_drive(), DRIVE)
    ear = part("ear", body_shapes.draw_ear(), SHELL, shapes.BLUE)
    both = (pose(), pose(rotation=turn("z", pi)))
    eyes = [part(f"{side} eye", body_shapes.draw_eye(sign), SHELL, "#9fd4ff") for side, sign in d.SIDES.items()]
    # An ear is in front of the middle of the head: rotated about z it would be behind it.
    right_ear = part("right ear", body_shapes.draw_ear().mirror(body_shapes.MIDDLE), SHELL, shapes.BLUE)
    return {
        "base": placed(part("stand", body_shapes.draw_stand(), CAST)),
        "torso": [
            *placed(part("waist", body_shapes.draw_waist(), DRIVE)),
            *placed(part("abdomen", body_shapes.draw_abdomen(), TRUNK, shapes.DARK)),
            *placed(part("chest", body_shapes.draw_chest(), TRUNK)),
            *placed(part("lamp", body_shapes.draw_lamp(), METAL, shapes.DARK)),
            *placed(part("light", body_shapes.draw_light(), SHELL, shapes.BLUE)),
            *placed(drive, *both),
            *placed(part("collar", body_shapes.draw_neck_seat(), METAL, shapes.DARK)),
        ],
        "neck": placed(part("neck column", body_shapes.draw_neck(), DRIVE)),
        "head": [
            *placed(part("skull", body_shapes.draw_head(), SHELL)),
            *placed(part("visor", body_shapes.draw_visor(), SHELL, shapes.BLACK)),
            *(one for eye in eyes for one in placed(eye)),
            *placed(ear),
            *placed(right_ear),
        ],
    }


def arms() -> dict[str, dict[str, list[Occurrence]]]:
    """Parts of both arms and hands by side; the right arm uses the products of the left one, rotated about z."""
    shoulder = part("roll drive", arm_shapes.draw_shoulder(), DRIVE)
    disc = part("shoulder disc", arm_shapes.draw_roll_cap(), METAL, shapes.BLUE)
    cap = part("elbow disc", arm_shapes.draw_elbow_cap(), METAL, shapes.BLUE)
    finger = part("finger", arm_shapes.draw_finger(), RUBBER)
    beside = d.ROLL_HALF + 1 + d.FORK
    discs = [pose((x * beside, 0, 0), turn("y", x * pi / 2)) for x in (1, -1)]
    outer = d.ELBOW_HALF + 12
    caps = [pose((0, y * outer, -d.UPPER), turn("x", -y * pi / 2)) for y in (1, -1)]
    shared = {
        "shoulder_fork": [*placed(part("fork", arm_shapes.draw_fork(), HOLLOW)), *placed(disc, *discs)],
        "upper_arm": [
            *placed(part("turntable", arm_shapes.draw_turntable(), DRIVE)),
            *placed(part("upper shell", arm_shapes.draw_upper_arm(), HOLLOW)),
            *placed(cap, *caps),
        ],
        "forearm": [
            *placed(part("elbow drive", arm_shapes.draw_elbow(), DRIVE)),
            *placed(part("forearm shell", arm_shapes.draw_forearm(), HOLLOW)),
        ],
        "wrist": placed(part("wrist fork", arm_shapes.draw_wrist(), METAL, shapes.DARK)),
        "wrist_cross": placed(part("cross", arm_shapes.draw_cross(), DRIVE, shapes.STEEL)),
        "hand": placed(part("palm", arm_shapes.draw_palm(), SHELL)),
        "fingers": [
            *placed(part("knuckles", arm_shapes.draw_knuckles(), METAL, shapes.STEEL)),
            *placed(finger, *(pose((x, 0, 0)) for x in d.FINGERS_X)),
        ],
        "thumb": placed(part("thumb", arm_shapes.draw_thumb(), RUBBER)),
    }
    turned = {"left": pose(), "right": pose(rotation=turn("z", pi))}
    return {side: {"shoulder": placed(shoulder, X), **shared} for side, X in turned.items()}


def machine() -> Machine:
    """A stand, a torso that turns on it, a head, two arms of seven joints, two hands."""
    places = d.places()
    parts = body() | {f"{side}_{name}": held for side, arm in arms().items() for name, held in arm.items()}
    joints = {
        "waist_yaw": JointFrame(places["torso"]),
        "neck_yaw": JointFrame(places["neck"]),
        "neck_pitch": JointFrame(places["head"], (0, 1, 0)),
    }
    for side, left in d.SIDES.items():
        for joint, link in zip(d.ARM, _LINKS, strict=True):
            joints[f"{side}_{joint}"] = JointFrame(places[f"{side}_{link}"], _AXES[joint.rpartition("_")[2]])
        for joint, link in (("grip", "fingers"), ("thumb_grip", "thumb")):
            joints[f"{side}_{joint}"] = JointFrame(places[f"{side}_{link}"], (-left, 0, 0))
    return Machine(
        "upper_body", [Link(name, X_WL, parts[name]) for name, X_WL in places.items()], joints, closed_form.known()
    )


if __name__ == "__main__":
    draw(__file__, machine)
