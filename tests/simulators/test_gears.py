"""A gear transmits motion in both directions, in the engines that support gears."""

from pathlib import Path

import pytest

from stepbot.engines.pybullet.body import body_of
from stepbot.engines.pybullet.motion import STEP, gears, release
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


@pytest.mark.pybullet
def test_errors_of_gears_in_pybullet_do_not_add_up(tmp_path: Path) -> None:
    """Followers that start off their ratio return to it, with its offset, and keep it while the leader turns."""
    skip_without("pybullet")
    import pybullet as engine

    robot = gear()
    client = engine.connect(engine.DIRECT)
    try:
        engine.setTimeStep(STEP)
        body = body_of(engine, engine.loadURDF(str(write(robot, tmp_path).written["urdf"].path), useFixedBase=True))
        body.set({"drive": 0.0, "driven": 0.15, "pointer": 0.0})
        release(body)
        gears(body, {joint.name: joint.mimic for joint in robot.joints if joint.mimic is not None}, 1e4)
        turning = {"targetVelocity": 1.0, "force": 50.0}
        engine.setJointMotorControl2(body.id, body.coordinates["drive"], engine.VELOCITY_CONTROL, **turning)
        for _ in range(3000):
            engine.stepSimulation()
        q = {name: engine.getJointState(body.id, index)[0] for name, index in body.coordinates.items()}
    finally:
        engine.disconnect(client)
    assert q["drive"] > 2.9
    assert q["driven"] == pytest.approx(0.1 - q["drive"] / 3, abs=1e-3)
    assert q["pointer"] == pytest.approx(2 * q["driven"] - 0.3, abs=1e-3)
