"""The evidence of joints on the page."""

import pytest

from stepbot.robot.joint_table import Basis, Evidence, JointRow
from stepbot.viewing.connections import evidence_of_rows

DOUBT = "two shafts meet, and no shaft is in a bore"


@pytest.mark.parametrize(
    ("reviews", "shown"),
    [({}, DOUBT), ({"j": ""}, DOUBT), ({"j": "could also be prismatic"}, "could also be prismatic")],
    ids=["not drafted", "drafted", "drafted, to be reviewed"],
)
def test_doubt_is_that_of_the_terminal(reviews: dict[str, str], shown: str) -> None:
    """A joint that `check` doubts has its mark on the page, too, whether or not its draft asks for a review."""
    row = JointRow("j", "revolute", "base", "arm", None, None, evidence=Evidence(Basis.AXIS, doubt=DOUBT))
    assert evidence_of_rows([row], reviews)["j"]["doubt"] == shown
