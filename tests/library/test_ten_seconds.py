"""Every robot of the library runs for ten seconds at 1 ms steps under random control without a warning or a NaN."""

import pytest

from tests.library.conftest import Converted, every_robot
from tests.processes import call_isolated

SECONDS = 10.0
LONGEST = 900.0
"""Time limit [s] of a simulation while others run."""
GAP_IN_MUJOCO, GAP_IN_PYBULLET = 3e-2, 2e-3
"""Maximum gap [m] of loops while targets of actuators jump: MuJoCo's constraints are soft, and strong actuators stretch
them; PyBullet's are stiff."""

pytestmark = pytest.mark.long


@pytest.mark.mujoco
@every_robot
def test_ten_seconds_in_mujoco(robot: str, converted: Converted) -> None:
    """All actuators get new random targets within their ranges every 50 ms."""
    file = str(converted(robot).file(".xml"))
    seen = call_isolated("tests.engines:run_in_mujoco", file, SECONDS, True, 1e-3, timeout=LONGEST)
    assert not any(seen["warnings"])
    assert seen["finite"]
    assert seen["actuators"] > 0
    assert seen["speed"] > 1e-2
    assert seen["gap"] < GAP_IN_MUJOCO


@pytest.mark.pybullet
@every_robot
def test_ten_seconds_in_pybullet(robot: str, converted: Converted) -> None:
    """PyBullet's motors drive the same joints; the snippet of report.json closes the loops."""
    pytest.importorskip("pybullet")
    conversion = converted(robot)
    reported = conversion.report["robot"]
    file = str(conversion.file(".urdf"))
    seen = call_isolated("tests.engines:driven_at_random_in_pybullet", file, SECONDS, reported, timeout=LONGEST)
    assert seen["printed"] == []
    assert seen["finite"]
    assert seen["driven"] > 0
    assert seen["speed"] > 1e-2
    assert seen["gap"] < GAP_IN_PYBULLET
