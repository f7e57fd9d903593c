"""Draw the SCARA: ``python -m robot_library.stepbot_scara.build`` in the root of the checkout.

Writes scara.step and expected.json beside this file; every run gives the same bytes.
"""

import build123d as bd

from .. import shapes
from ..machine import CAST, METAL, PLASTIC, STEEL, JointFrame, Link, Machine, draw, part, placed
from ..machine_parts import corners, drilled, pin, plate
from ..moments import inverse, pose
from ..shapes import at, cylinder, housing, hull_plate, on_circle, tube
from . import closed_form
from . import dimensions as d


def draw_foot() -> bd.Part:
    """The plate that is bolted to the table."""
    x, y, z = d.FOOT
    return drilled(plate(x, y, z, edge=14, rim=2), 5.5, z, corners(x - 30, y - 30))


def draw_column() -> bd.Part:
    """A round column with a plinth, a panel of connectors behind, and a ring around the shoulder."""
    height = d.SHOULDER_HEIGHT - d.FOOT[2]
    body = cylinder(d.COLUMN_RADIUS, height - 2) + pin(d.COLUMN_RADIUS + 8, 22, rim=6)
    body += at(tube(d.COLUMN_RADIUS - 2, 40, 2), (0, 0, height - 2))
    panel = at(plate(20, 70, 60, edge=4), (-d.COLUMN_RADIUS, 0, 40))
    sockets = [at(cylinder(9, 6), (-d.COLUMN_RADIUS - 10, y, 70), (0, 90, 0)) for y in (-20, 8)]
    return body + panel - sockets


def draw_upper_arm() -> bd.Part:
    """A cast bar from shoulder to elbow, thinner towards the elbow, with a waist."""
    body = hull_plate([((0, 0), d.UPPER_RADIUS), ((d.UPPER, 0), d.ELBOW_RADIUS)], d.UPPER_HEIGHT)
    body = bd.fillet(body.faces().sort_by(bd.Axis.Z)[-1].edges(), 8)
    body = bd.fillet(body.faces().sort_by(bd.Axis.Z)[0].edges(), 5)
    groove = hull_plate([((70, 0), 22), ((d.UPPER - 62, 0), 18)], 12)
    return body - at(groove, (0, 0, d.UPPER_HEIGHT - 5))


def draw_cap() -> bd.Part:
    """The cover over the shoulder's drive."""
    return housing(44, 10, 4, 0)


def draw_forearm() -> bd.Part:
    """The shell from elbow to quill, higher over the drives, with the bore of the quill and an opening for its nut."""
    floor = hull_plate([((0, 0), d.ELBOW_RADIUS), ((d.FORE, 0), d.QUILL_RADIUS)], d.FORE_HEIGHT)
    floor = bd.fillet(floor.faces().sort_by(bd.Axis.Z)[-1].edges(), 10)
    hood = hull_plate([((6, 0), 40), ((d.FORE - 52, 0), 30)], d.FORE_HEIGHT + 62)
    hood = bd.fillet(hood.faces().sort_by(bd.Axis.Z)[-1].edges(), 14)
    return floor + hood - at(cylinder(d.SCREW_BORE, 200), (d.FORE, 0, 0))


def draw_guide() -> bd.Part:
    """The sleeve above the forearm that the quill runs in."""
    return at(tube(18, d.SCREW_BORE, 34), (0, 0, d.FORE_HEIGHT)) + at(
        tube(21.5, d.SCREW_BORE, 8), (0, 0, d.FORE_HEIGHT + 34)
    )


def draw_screw() -> bd.Part:
    """The screw, z down: grooves represent the thread; a stop at its upper end, a collar below."""
    length = d.SCREW_BELOW + d.SCREW_ABOVE
    body = at(cylinder(d.SCREW_RADIUS, length), (0, 0, -d.SCREW_ABOVE))
    rings = [
        at(tube(d.SCREW_RADIUS + 1, d.SCREW_RADIUS - 1, 2), (0, 0, -d.SCREW_ABOVE + 14 + 10 * i)) for i in range(8)
    ]
    body += at(pin(13, 10, rim=1.5, foot=1.5), (0, 0, -d.SCREW_ABOVE))
    return body - rings + at(cylinder(14, d.COLLAR - 1), (0, 0, d.SCREW_BELOW))


def draw_flange() -> bd.Part:
    """The tool flange, similar to ISO 9409-1: four threads and a pin hole on 25 mm."""
    body = pin(d.FLANGE_RADIUS, d.FLANGE, rim=1) + at(cylinder(8, 1), (0, 0, -1))
    return drilled(body, 2.1, d.FLANGE, on_circle(4, 25, 45)) - at(cylinder(6, 6), (0, 0, d.FLANGE - 6))


def machine() -> Machine:
    """Column, upper arm, forearm, quill and flange."""
    foot = part("foot", draw_foot(), CAST)
    column = part("column", draw_column(), CAST, shapes.WHITE)
    upper_arm = part("upper arm casting", draw_upper_arm(), METAL, shapes.ORANGE)
    cap = part("shoulder cap", draw_cap(), PLASTIC, shapes.DARK)
    shell = part("forearm shell", draw_forearm(), PLASTIC, shapes.WHITE)
    guide = part("guide", draw_guide(), METAL, shapes.DARK)
    screw = part("screw", draw_screw(), STEEL, shapes.LIGHT)
    flange = part("tool flange", draw_flange(), STEEL, shapes.DARK)

    X_WU, X_WF, X_WQ, X_WT = d.upper_arm_place(), d.forearm_place(), d.quill_place(), d.flange_place()
    X_WE = X_WU @ pose((d.UPPER, 0, d.UPPER_HEIGHT))
    bearing = part("elbow bearing", cylinder(34, d.FORE_FLOOR), STEEL)
    return Machine(
        "scara",
        (
            Link("base", pose(), [*placed(foot), *placed(column, pose((0, 0, d.FOOT[2])))]),
            Link(
                "upper_arm",
                X_WU,
                [
                    *placed(upper_arm),
                    *placed(cap, pose((0, 0, d.UPPER_HEIGHT))),
                    *placed(bearing, inverse(X_WU) @ X_WE),
                ],
            ),
            Link(
                "forearm",
                X_WF,
                [*placed(shell, pose((0, 0, d.FORE_FLOOR))), *placed(guide, pose((d.FORE, 0, d.FORE_FLOOR)))],
            ),
            Link("spindle", X_WQ, placed(screw)),
            Link("flange", X_WT, placed(flange, pose((0, 0, -d.FLANGE)))),
        ),
        {"shoulder": JointFrame(X_WU), "elbow": JointFrame(X_WF), "quill": JointFrame(X_WQ), "wrist": JointFrame(X_WT)},
        closed_form.known(),
    )


if __name__ == "__main__":
    draw(__file__, machine)
