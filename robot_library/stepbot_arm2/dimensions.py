"""Dimensions of the arm [mm], and the pose of every part in the drawing.

A turntable on a column (joint ``shoulder``, vertical), a forearm between its cheeks (joint ``elbow``, horizontal), and
two fingers that slide on rods across its end. In the drawing the elbow is raised by 30 degrees and each finger is 15 mm
open: the drawn pose is not the zero of every joint.
"""

from dataclasses import dataclass
from math import pi, radians

from ..moments import Array, pose, turn

ELBOW_DRAWN = radians(30)
FINGER_DRAWN = 15.0

BASE_PLATE = (120.0, 120.0, 12.0)
BOLT_CIRCLE = 48.0
"""Half the distance between the screws, along x and along y."""
BOLT_BORE = 3.3


@dataclass(frozen=True)
class Screw:
    """A socket head cap screw; its frame is the middle of the end of the shank, z towards the head."""

    shank_radius: float = 3.0
    shank: float = 12.0
    head_radius: float = 5.0
    head: float = 6.0
    socket_radius: float = 2.5
    socket: float = 3.0


@dataclass(frozen=True)
class Column:
    """A post with a thinner pivot on top, hollow for cables."""

    radius: float = 30.0
    height: float = 80.0
    pivot_radius: float = 10.0
    pivot: float = 20.0
    chamfer: float = 1.0
    bore: float = 5.0


@dataclass(frozen=True)
class Turntable:
    """A disc around the pivot of the column."""

    radius: float = 32.0
    height: float = 18.0
    bore: float = 10.05


@dataclass(frozen=True)
class Cheek:
    """An upright plate with a round top; its frame is the centre of the top, x along the plate, y through it."""

    half_width: float = 20.0
    thickness: float = 8.0
    foot: float = 39.0
    """From the centre of the top down to the turntable."""
    bore: float = 8.05
    inside: float = 18.0
    """From the middle of the arm to the plate."""


@dataclass(frozen=True)
class Motor:
    """A round motor with an encoder on its back; its frame is the middle of its front face, z along its axis."""

    radius: float = 16.0
    length: float = 36.0
    encoder_radius: float = 6.0
    encoder: float = 4.0


@dataclass(frozen=True)
class Beam:
    """The forearm; its frame is on the elbow's axis, x along the arm, y along the axis."""

    half_height: float = 16.0
    half_width: float = 14.0
    length: float = 200.0
    """From the elbow to the gripper."""
    shaft_radius: float = 8.0
    shaft_end: float = 25.5
    """Half the length of the shaft, from end to end."""
    spacer_radius: float = 12.0
    spacer_end: float = 17.0
    openings: tuple[float, ...] = (60.0, 100.0, 140.0)
    opening_radius: float = 9.0


@dataclass(frozen=True)
class Palm:
    """A plate with two ears that hold the rods; its frame is the middle of the face at the beam, x along the arm."""

    plate: float = 8.0
    half_width: float = 60.0
    half_height: float = 25.0
    ear: float = 8.0
    ear_length: float = 38.0
    rod_x: float = 32.0
    rod_z: float = 15.0
    rod_bore: float = 4.05


@dataclass(frozen=True)
class Rod:
    """A guide; its frame is its middle, z along it."""

    radius: float = 4.0
    length: float = 120.0


@dataclass(frozen=True)
class Finger:
    """A slider with a blade; its frame is on the face that meets the other finger, x from rods to tip, y outwards."""

    slider: tuple[float, float, float] = (28.0, 16.0, 46.0)
    bore: float = 4.1
    blade: tuple[float, float, float] = (56.0, 8.0, 20.0)
    half_gap: float = 0.5
    """From the middle to the face when the gripper is closed."""


SCREW, COLUMN, TURNTABLE, CHEEK, MOTOR = Screw(), Column(), Turntable(), Cheek(), Motor()
BEAM, PALM, ROD, FINGER = Beam(), Palm(), Rod(), Finger()

AIR = 1.0
"""Between the column and the turntable."""
COLUMN_TOP = BASE_PLATE[2] + COLUMN.height
TURNTABLE_FOOT = COLUMN_TOP + AIR
ELBOW_HEIGHT = TURNTABLE_FOOT + TURNTABLE.height + CHEEK.foot
TOOL = 100.0
"""From the palm to the tool frame, along the arm."""

QUARTER = pi / 2


def screw_places() -> tuple[Array, ...]:
    """X_BS of the screws in the base."""
    c = BOLT_CIRCLE
    return tuple(pose((x, y, 0)) for x, y in ((c, c), (-c, c), (-c, -c), (c, -c)))


def cheek_places() -> tuple[Array, ...]:
    """X_SC of the cheeks in the shoulder."""
    y = CHEEK.inside + CHEEK.thickness / 2
    return tuple(pose((0, side * y, ELBOW_HEIGHT)) for side in (1, -1))


def turntable_place() -> Array:
    """X_ST of the turntable in the shoulder."""
    return pose((0, 0, TURNTABLE_FOOT))


def motor_place() -> Array:
    """X_SM of the motor in the shoulder: on the outside of the cheek at positive y."""
    return pose((0, CHEEK.inside + CHEEK.thickness, ELBOW_HEIGHT), turn("x", -QUARTER))


def forearm_place(elbow: float) -> Array:
    """X_WF of the forearm, with the elbow raised by an angle [rad]."""
    return pose((0, 0, ELBOW_HEIGHT), turn("y", -elbow))


def gripper_place() -> Array:
    """X_FG of the gripper in the forearm; the gripper's frame is the palm's."""
    return pose((BEAM.length, 0, 0))


def rod_places() -> tuple[Array, ...]:
    """X_GR of the rods in the gripper."""
    return tuple(pose((PALM.rod_x, 0, side * PALM.rod_z), turn("x", QUARTER)) for side in (1, -1))


def finger_places(opening: float) -> tuple[Array, ...]:
    """X_GF of both fingers in the gripper, open by a distance [mm]; the second is the first, rotated by half a turn."""
    y = FINGER.half_gap + opening
    return (pose((PALM.rod_x, y, 0)), pose((PALM.rod_x, -y, 0), turn("x", pi)))
