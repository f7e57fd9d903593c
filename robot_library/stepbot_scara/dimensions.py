"""Dimensions of the SCARA [mm], and the poses of its links in the drawing.

x points forwards, z up; the drawing has the arm bent: shoulder at 40, elbow at -75 degrees. Zero is the straight arm.
"""

from math import pi, radians

from ..moments import Array, pose, turn

UPPER, FORE = 225.0, 175.0
"""Shoulder to elbow, elbow to quill."""
SHOULDER_DRAWN, ELBOW_DRAWN = radians(40), radians(-75)
PITCH = 20.0
"""Advance of the quill per turn of its screw."""
STROKE = 90.0
"""Travel of the quill downwards from the drawn position, its upper end."""

FOOT = (170.0, 170.0, 14.0)
COLUMN_RADIUS, SHOULDER_HEIGHT = 62.0, 190.0
"""The shoulder's height is that of the plane between column and upper arm."""
UPPER_HEIGHT, UPPER_RADIUS, ELBOW_RADIUS = 62.0, 60.0, 48.0
FORE_FLOOR, FORE_HEIGHT, QUILL_RADIUS = 2.0, 70.0, 40.0
"""Gap between upper arm and forearm, height of the forearm's shell, radius of its end around the quill."""
SCREW_RADIUS, SCREW_BORE = 8.0, 8.05
SCREW_BELOW, SCREW_ABOVE = 40.0, 215.0
"""Ends of the screw below and above the floor of the forearm as drawn."""
FLANGE_RADIUS, FLANGE = 17.5, 12.0
COLLAR = 9.0
"""Height of the collar at the lower end of the screw, which carries the turning flange."""

ELBOW_HEIGHT = SHOULDER_HEIGHT + UPPER_HEIGHT
TOOL_HEIGHT = ELBOW_HEIGHT + FORE_FLOOR - SCREW_BELOW - COLLAR - FLANGE
"""Of the flange's face as drawn."""


def upper_arm_place() -> Array:
    """X_WU: the origin on the shoulder's axis at the foot of the upper arm, x along it."""
    return pose((0, 0, SHOULDER_HEIGHT), turn("z", SHOULDER_DRAWN))


def forearm_place() -> Array:
    """X_WF: the origin on the elbow's axis on top of the upper arm, x along the forearm."""
    return upper_arm_place() @ pose((UPPER, 0, UPPER_HEIGHT), turn("z", ELBOW_DRAWN))


def quill_place() -> Array:
    """X_WQ: the origin on the quill's axis in the floor of the forearm, z down, in the direction of its advance."""
    return forearm_place() @ pose((FORE, 0, FORE_FLOOR), turn("x", pi))


def flange_place() -> Array:
    """X_WT: the middle of the flange's face, z down."""
    return quill_place() @ pose((0, 0, SCREW_BELOW + COLLAR + FLANGE))
