"""What MuJoCo says through its global handlers."""

import mujoco
import pytest

from stepbot.engines.mujoco.model import collected_warnings
from stepbot.engines.observation import EngineRefused


def test_a_fatal_error_of_mujoco_is_its_refusal() -> None:
    """A chain of hundreds of bodies exceeds MuJoCo's stack; that is no internal error of stepbot."""
    chain = (
        "".join(f'<body name="b{n}" pos="0 0 0.1"><joint/><geom size="0.05"/>' for n in range(400)) + "</body>" * 400
    )
    model = mujoco.MjModel.from_xml_string(f"<mujoco><size memory='64K'/><worldbody>{chain}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    with pytest.raises(EngineRefused, match="stack"), collected_warnings():
        mujoco.mj_step(model, data, 10)
