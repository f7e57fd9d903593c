"""Loops of every closed robot of the library stay closed under random control at the effort limits."""

import mujoco
import pytest

from tests.library.conftest import ROBOTS, SHORT, Converted, sidecar_of
from tests.stiffness import largest_gap, largest_gap_of_motors

CLOSED = tuple(robot for robot in ROBOTS if "\nclosures:\n" in sidecar_of(robot).read_text("utf-8"))
COUPLED = tuple(robot for robot in ROBOTS if "mimic:" in sidecar_of(robot).read_text("utf-8"))
WIDEST = 5e-4
"""[m], [rad]"""


@pytest.mark.parametrize(
    "robot", [pytest.param(robot, marks=() if robot in SHORT else pytest.mark.long) for robot in CLOSED]
)
def test_loops_stay_closed_under_random_control(robot: str, converted: Converted) -> None:
    """No closure or mimic opens by 0.5 mm or mrad, with its contacts and time step as written."""
    assert largest_gap(mujoco.MjModel.from_xml_path(str(converted(robot).file(".xml")))) < WIDEST


@pytest.mark.parametrize(
    "robot", [pytest.param(robot, marks=() if robot in SHORT else pytest.mark.long) for robot in COUPLED]
)
def test_mimics_stay_closed_while_their_motors_step(robot: str, converted: Converted) -> None:
    """Motors that move hands alone, from end to end of their ranges, open no mimic by 0.2 mm or mrad.

    An arm that swings at its limits throws the fingers against it.
    """
    model = mujoco.MjModel.from_xml_path(str(converted(robot).file(".xml")))
    joints = model.eq_obj2id[model.eq_type == mujoco.mjtEq.mjEQ_JOINT]
    still = [a for a in range(model.nu) if model.actuator_trnid[a][0] not in joints]
    model.actuator_ctrlrange[still], model.actuator_ctrllimited[still] = model.key_ctrl[0][still, None], True
    assert largest_gap_of_motors(model) < 2e-4


def test_all_closed_robots_are_tested() -> None:
    """The closed robots are those whose pages name loops."""
    pages = {robot: sidecar_of(robot).with_name("README.md").read_text("utf-8") for robot in ROBOTS}
    assert {robot for robot, page in pages.items() if "closes a loop" in page} == set(CLOSED)
