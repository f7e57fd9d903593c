"""Outputs of motors: the axis of a horn, and unnamed parts that turn on a case."""

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.evidence.motor_outputs import OutputAxes, hidden_outputs
from stepbot.draft.evidence.motors import Motor
from tests.assembled import Node, assembled, part
from tests.solids import box, cylinder

LID, FRONT = box(40, 20, 4), box(40, 20, 20)
"""Front half and lid of a case."""


def survey(*more: Node) -> Survey:
    """A case of two halves, its front above z = 0 [mm], its lid below, and other parts; the case is part 1."""
    return Survey(assembled(part("front", FRONT, z=10), part("lid", LID, z=-2), *more), ALL_SOURCES)


def test_discs_on_either_half_are_outputs() -> None:
    """A disc on the front and one on the lid, each with an arm on it, are horn and idler."""
    arms = part("arm", box(80, 10, 3), 40, 0, 24.5), part("arm", box(80, 10, 3), 40, 0, -8.5)
    found = survey(part("disc", cylinder(8, 3), 10, 0, 20), part("disc 2", cylinder(7, 3), 10, 0, -7), *arms)
    assert hidden_outputs(found, Motor("servo", (1, 2, 3, 4), 1)) == [3, 4]


def test_plates_and_covers_are_no_outputs() -> None:
    """A square plate on the case is not turned, and a tiny disc that carries nothing is a cover of a screw."""
    found = survey(part("plate", box(12, 12, 3), 10, 0, 21.5), part("cover", cylinder(1, 0.5), -10, 0, 20))
    assert hidden_outputs(found, Motor("servo", (1, 2, 3, 4), 1)) == []


def test_axis_is_that_of_the_horn() -> None:
    """The output axis goes through the horn, and reaches as far as its contact."""
    found = survey(part("disc", cylinder(8, 3), 10, 0, 20))
    motor = Motor("servo", (1, 2, 3), 1, outputs=(3,))
    output = OutputAxes(found, [motor]).of(motor, motor.outputs)
    assert output is not None
    assert output.axis.distance(found.parts[3].com) < 1e-9
    assert abs(output.reach - 8e-3) < 1e-9
