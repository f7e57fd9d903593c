"""Stops found by `init` by collision, against the drawing of a robot."""

from math import degrees, radians
from pathlib import Path

import pytest

from stepbot.draft.text.sidecar_text import sidecar_text
from stepbot.pipeline.drafting import draft_step
from stepbot.pipeline.stages import Options
from tests.library.conftest import LIBRARY


@pytest.mark.slow
def test_jaw_stops_where_its_pads_meet(tmp_path: Path) -> None:
    """The jaw, drawn open by 32 degrees, closes until the pads meet, within 1 degree, and opens against the palm.

    Stops are comments, and `limits: todo` remains.
    """
    draft = draft_step(LIBRARY / "stepbot_desk_arm" / "desk_arm.step", Options(tmp_path)).draft
    assert draft is not None
    (jaw,) = (joint for joint in draft.joints if joint.child == "jaw")
    closed, opened = sorted(jaw.stops, key=lambda stop: abs(stop.position))
    assert abs(closed.position) == pytest.approx(radians(32), abs=radians(1))
    assert closed.parts == ("gripper_body/pad", "jaw/pad")
    assert opened.position * closed.position < 0.0
    text = sidecar_text(draft, "desk_arm.step")
    assert f"# stop found by collision at {degrees(closed.position):.2f} deg: 'gripper_body/pad' and 'jaw/pad'" in text
    assert text.count("    limits: todo\n") == len(draft.joints)
