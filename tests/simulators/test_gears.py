"""A gear transmits motion in both directions, in the engines that support gears."""

from pathlib import Path

import pytest

from tests.mechanisms import gear
from tests.simulators.conftest import skip_without, write


@pytest.mark.mujoco
@pytest.mark.parametrize("turned", ["drive", "driven", "pointer"])
def test_either_end_turns_the_other(turned: str, tmp_path: Path) -> None:
    """Whichever of leader, follower and its follower is pushed, all keep their ratios."""
    skip_without("mujoco")
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(write(gear(), tmp_path).written["mjcf"].path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    for _ in range(200):
        data.qfrc_applied[:] = 0.0
        data.joint(turned).qfrc_applied[0] = 0.002
        mujoco.mj_step(model, data)
    drive, driven, pointer = (float(data.joint(name).qpos[0]) for name in ("drive", "driven", "pointer"))
    assert abs(drive) > 0.05
    # MuJoCo's equalities are soft: they yield by about 2 % under a constant push.
    assert driven - 0.1 == pytest.approx(-drive / 3, rel=0.03)
    assert pointer + 0.1 == pytest.approx(2 * (driven - 0.1), rel=0.03)
    assert (drive > 0.0) is (turned == "drive")
