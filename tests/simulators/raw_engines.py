"""Engines without stepbot's precautions, for tests to call in workers."""

from importlib import import_module

from stepbot.engines.observation import Observation, Request


def load_sdf(path: str) -> None:
    """Load an SDFormat file in PyBullet without preparation."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    pybullet.loadSDF(path)


def observe_both(engine: str, first: Request, second: Request) -> tuple[Observation, Observation]:
    """Two files, observed one after the other in one process."""
    observe = import_module(engine).observe
    return observe(first), observe(second)


def principal_moments(path: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Moments [kg m^2] of the last moving link of a URDF, without and with PyBullet's flag."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    found = []
    for flags in (0, pybullet.URDF_USE_INERTIA_FROM_FILE):
        body = pybullet.loadURDF(path, flags=flags)
        moving = [i for i in range(pybullet.getNumJoints(body)) if pybullet.getJointInfo(body, i)[2] != 4]
        found.append(pybullet.getDynamicsInfo(body, moving[-1])[2])
    return found[0], found[1]


def axis(path: str, joint: str) -> tuple[float, ...]:
    """Axis of a joint as reported by PyBullet."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    body = pybullet.loadURDF(path, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
    infos = [pybullet.getJointInfo(body, i) for i in range(pybullet.getNumJoints(body))]
    return next(tuple(info[13]) for info in infos if info[1].decode() == joint)


def pushed(path: str, joint: str) -> list[float]:
    """Speeds [rad/s] of a joint in 50 steps of 1 ms after a push, without gravity and motors."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    body = pybullet.loadURDF(path, useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
    pybullet.setTimeStep(1e-3)
    index = {}
    for i in range(pybullet.getNumJoints(body)):
        index[pybullet.getJointInfo(body, i)[1].decode()] = i
        pybullet.setJointMotorControl2(body, i, pybullet.VELOCITY_CONTROL, force=0)
    pybullet.resetJointState(body, index[joint], 0.5, 1e-3)
    speeds = []
    for _ in range(50):
        pybullet.stepSimulation()
        speeds.append(abs(pybullet.getJointState(body, index[joint])[1]))
    return speeds


def geared(path: str, leader: str, follower: str, multiplier: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Positions of leader and follower after a push of the leader, without and with PyBullet's gear."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    found = []
    for gear in (False, True):
        pybullet.resetSimulation()
        body = pybullet.loadURDF(path, useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        infos = [pybullet.getJointInfo(body, i) for i in range(pybullet.getNumJoints(body))]
        index = {info[1].decode(): info[0] for info in infos}
        for joint in range(len(infos)):
            pybullet.setJointMotorControl2(body, joint, pybullet.VELOCITY_CONTROL, force=0)
        pybullet.setJointMotorControl2(body, index[leader], pybullet.POSITION_CONTROL, targetPosition=0.008, force=50)
        if gear:
            turning = (body, index[leader], body, index[follower], pybullet.JOINT_GEAR, infos[index[leader]][13])
            held = pybullet.createConstraint(*turning, (0, 0, 0), (0, 0, 0))
            pybullet.changeConstraint(held, gearRatio=-1.0 / multiplier, maxForce=1e4)
        for _ in range(240):
            pybullet.stepSimulation()
        leads, follows = (float(pybullet.getJointState(body, index[name])[0]) for name in (leader, follower))
        found.append((leads, follows))
    return found[0], found[1]
