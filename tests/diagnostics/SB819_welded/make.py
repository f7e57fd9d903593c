"""A crank-rocker linkage closed by a weld in place of a pin."""

import pytest

from tests.diagnostics.transcripts import copy_library_robot


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    copy_library_robot(
        "stepbot_four_bar",
        "four_bar",
        ("rocker_pin: {type: revolute", "rocker_pin: {type: fixed"),
        ("auto, axis: -z}", "auto}"),
        ("gains: auto", "kp: 5, kv: 0.05"),  # nothing moves that gains could be computed from
    )
