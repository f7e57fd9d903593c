"""Answers about links that overlap."""

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.scenes import ShownScene
from stepbot.robot.model import Sphere
from stepbot.serving.axis_questions import Contacts
from stepbot.serving.local_server import Refused
from tests.unit.verification.test_self_collision import robot

APART, NEAR = (ShownScene(Diagnostics(), robot=robot(Sphere(0.5), Sphere(0.5), x)) for x in (1.5, 0.9))


def test_the_robot_that_is_shown_is_compared() -> None:
    """Another robot gets another process; without a robot nothing overlaps; after the end there is no process."""
    contacts, q = Contacts(None), {"q": {"one": 0.0, "two": 0.0}}
    try:
        assert contacts.answer(None, q) == {"pairs": []}
        assert contacts.answer(APART, q) == {"pairs": []}
        (pair,) = contacts.answer(NEAR, q)["pairs"]
        assert (pair["link_a"], pair["link_b"]) == ("a", "b")
    finally:
        contacts.close()
    with pytest.raises(Refused, match="ended"):
        contacts.answer(NEAR, q)


@pytest.mark.parametrize("q", [None, [], {}, {"one": 0.0}, {"one": 0.0, "two": "0"}, {"one": 0.0, "two": float("nan")}])
def test_positions_are_checked(q: object) -> None:
    """A page that leaves out a position, or sends something else, is refused."""
    contacts = Contacts(None)
    with pytest.raises(Refused, match="positions"):
        contacts.answer(NEAR, {"q": q})
    contacts.close()
