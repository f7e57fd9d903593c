"""Engines without stepbot's observers, as a user calls them; each function runs in a separate process."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stepbot.robot.pybullet_closures import add_constraints

Json = Sequence[Mapping[str, Any]]

ASLANT = (3.0, 4.0, -8.0)
"""A gravity [m/s^2] that moves joints that a vertical one would not."""


def _model(file: str) -> Any:
    """A compiled URDF or MJCF file; each warning of the compiler is an error."""
    import mujoco

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        spec = mujoco.MjSpec.from_file(file)
        if Path(file).suffix == ".urdf":
            # By default MuJoCo fuses fixed links of a URDF and strips folders from mesh names.
            spec.compiler.fusestatic = False
            spec.compiler.discardvisual = False
            spec.strippath = False
        return spec.compile()


def mujoco_bodies(file: str, configurations: Sequence[Mapping[str, float]]) -> list[dict[str, Any]]:
    """Mass [kg], com [m] and inertia [kg m^2] about the com of every body, along the world's axes, at each q."""
    import mujoco

    model = _model(file)
    data = mujoco.MjData(model)
    found = []
    for q in configurations:
        data.qpos[:] = model.qpos0
        for name, value in q.items():
            data.joint(name).qpos[0] = value
        mujoco.mj_forward(model, data)
        bodies = {}
        for i in range(1, model.nbody):
            R = data.ximat[i].reshape(3, 3)
            inertia = R @ np.diag(model.body_inertia[i]) @ R.T
            bodies[model.body(i).name] = (float(model.body_mass[i]), data.xipos[i].tolist(), inertia.tolist())
        found.append(bodies)
    return found


def mujoco_links(file: str) -> dict[str, Any]:
    """Mass [kg], com [m] and inertia [kg m^2] about the com of every body, in its own frame."""
    import mujoco

    model = _model(file)
    found = {}
    for i in range(1, model.nbody):
        R = np.zeros(9)
        mujoco.mju_quat2Mat(R, model.body_iquat[i])
        R = R.reshape(3, 3)
        inertia = R @ np.diag(model.body_inertia[i]) @ R.T
        found[model.body(i).name] = (float(model.body_mass[i]), model.body_ipos[i].tolist(), inertia.tolist())
    return found


def mujoco_at_home(file: str) -> dict[str, dict[str, Any]]:
    """An MJCF file in its drawn pose: ``bodies`` by name as poses (4, 4) by row [m], ``axes`` of joints by name."""
    import mujoco

    model = _model(file)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    bodies = {model.body(i).name: _pose_of(data.body(i)) for i in range(1, model.nbody)}
    return {"bodies": bodies, "axes": {model.joint(i).name: data.xaxis[i].tolist() for i in range(model.njnt)}}


def _pose_of(body: Any) -> list[list[float]]:
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = body.xmat.reshape(3, 3), body.xpos
    return X.tolist()


def mujoco_axes(file: str) -> dict[str, tuple[list[float], list[float]]]:
    """A point [m] on the axis of every joint and its direction, in the world, at q = 0."""
    import mujoco

    model = _model(file)
    data = mujoco.MjData(model)
    data.qpos[:] = 0.0
    mujoco.mj_forward(model, data)
    return {model.joint(i).name: (data.xanchor[i].tolist(), data.xaxis[i].tolist()) for i in range(model.njnt)}


def closed_by_newton(file: str, driven: str, angles: Sequence[float]) -> tuple[list[dict[str, float]], int]:
    """Follow a joint through ``angles`` [rad], solving the loop's equations for the others.

    Only rows of equality constraints are solved: rows of limits, friction or contacts would change the solution.

    Returns:
        All joint positions at each angle, and the remaining degrees of freedom.
    """
    import mujoco

    model = _model(file)
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    leader = model.joint(driven).dofadr[0]
    others = [i for i in range(model.nv) if i != leader]
    found, freedom = [], model.nv
    for angle in angles:
        data.joint(driven).qpos[0] = angle
        for _ in range(30):
            mujoco.mj_fwdPosition(model, data)
            rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
            assert rows.any(), "there is no loop in the file"
            J = data.efc_J.reshape(-1, model.nv)[rows]
            step = np.linalg.lstsq(J[:, others], -data.efc_pos[rows], rcond=1e-9)[0]
            data.qpos[others] += step
            if float(np.max(np.abs(step))) < 1e-14:
                break
        gap = float(np.max(np.abs(data.efc_pos[rows])))
        assert gap < 1e-9, f"the loop stays open by {gap} m at {angle} rad"
        freedom = min(freedom, model.nv - int(np.linalg.matrix_rank(J, tol=1e-9)))
        found.append({model.joint(i).name: float(data.joint(i).qpos[0]) for i in range(model.njnt)})
    return found, freedom


def driven_in_mujoco(file: str, actuator: str, speed: float) -> tuple[list[dict[str, float]], float, list[int]]:
    """Turn an actuator's target by a full turn at ``speed`` [rad/s].

    Returns:
        Joint positions every 10 ms, the largest gap [m] between the sites of a connect, and MuJoCo's warning counts.
    """
    import mujoco

    model = _model(file)
    data = mujoco.MjData(model)
    found, widest = [], 0.0
    sites = [(model.eq_obj1id[i], model.eq_obj2id[i]) for i in range(model.neq)]
    for number in range(round(2 * np.pi / speed / model.opt.timestep)):
        data.actuator(actuator).ctrl[0] = speed * data.time
        mujoco.mj_step(model, data)
        mujoco.mj_kinematics(model, data)
        widest = max([widest, *(float(np.linalg.norm(data.site_xpos[a] - data.site_xpos[b])) for a, b in sites)])
        if number % 5 == 4:
            found.append({model.joint(i).name: float(data.joint(i).qpos[0]) for i in range(model.njnt)})
    return found, widest, [int(warning.number) for warning in data.warning]


def run_in_mujoco(file: str, seconds: float, noise: bool, step: float | None = None) -> dict[str, Any]:
    """Simulate from the keyframe, with the keyframe's targets or with new random ones for all actuators every 50 steps.

    A floating robot is on a floor.

    Args:
        file: An MJCF file.
        seconds: Duration [s].
        noise: Whether targets are random, the same ones in every run.
        step: Time step [s]; by default that of the file.

    Returns:
        MuJoCo's warning counts, whether the state is finite, the largest speed, the deepest contact [m] of two links,
        the largest gap of a loop [m], and the number of actuators.
    """
    import mujoco

    model = _model(file)
    floating = bool((model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE)).any())
    model, data = _on_a_floor(file) if floating else (model, _at_home(model))
    model.opt.timestep = step or model.opt.timestep
    low, high = model.actuator_ctrlrange.T
    limited = model.actuator_ctrllimited.astype(bool)
    low, high = np.where(limited, low, -1.0), np.where(limited, high, 1.0)
    generator = np.random.default_rng(0)
    held = model.eq_objtype == int(mujoco.mjtObj.mjOBJ_SITE)
    speed, depth, gap = 0.0, 0.0, 0.0
    for number in range(round(seconds / model.opt.timestep)):
        if noise and number % 50 == 0:
            data.ctrl[:] = generator.uniform(low, high)
        mujoco.mj_step(model, data)
        ends = data.site_xpos[model.eq_obj1id[held]] - data.site_xpos[model.eq_obj2id[held]]
        gap = max([gap, *np.linalg.norm(ends, axis=1).tolist()])
        speed = max([speed, *np.abs(data.qvel).tolist()])
        of_links = (model.geom_type[data.contact.geom] != int(mujoco.mjtGeom.mjGEOM_PLANE)).all(axis=1)
        depth = min([depth, *data.contact.dist[of_links].tolist()])
    finite = bool(np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all())
    seen = {"warnings": [int(w.number) for w in data.warning], "finite": finite, "speed": speed, "depth": depth}
    return {**seen, "gap": gap, "actuators": int(model.nu)}


def _at_home(model: Any) -> Any:
    """Data of a model, in its keyframe if it has one."""
    import mujoco

    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    return data


def run_in_pybullet(file: str, seconds: float, robot: Mapping[str, Any], step: float = 1e-3) -> dict[str, Any]:
    """Simulate a URDF without motors, hanging from its fixed base or falling on a floor.

    For a fixed base gravity is oblique, so that it moves joints with a vertical axis, too.

    Args:
        file: The URDF.
        seconds: Duration [s].
        robot: The robot in report.json.
        step: Time step [s].

    Returns:
        Whether the state stays finite, the largest speed, the number of links, and the largest surplus of kinetic
        energy over the work of gravity so far, relative to the largest work.
    """
    import pybullet

    from tests.energies import Energies

    floating = robot["base"] == "floating"
    body = _in_pybullet(file, floating, robot["pybullet"], robot["joints"])
    if not floating:
        pybullet.setGravity(*ASLANT)
    pybullet.setTimeStep(step)
    joints = _let_go(body)
    energies = Energies(body, robot["links"], (0.0, 0.0, -9.81) if floating else ASLANT)
    speed, surplus, most, finite = 0.0, 0.0, 0.0, True
    for _ in range(round(seconds / step)):
        pybullet.stepSimulation()
        states = [pybullet.getJointState(body, i)[:2] for i in joints]
        finite = finite and bool(np.isfinite(states).all())
        speed = max([speed, *(abs(state[1]) for state in states)])
        given = energies.given()
        surplus, most = max(surplus, energies.kinetic() - given), max(most, given)
    return {
        "finite": finite,
        "speed": speed,
        "links": 1 + pybullet.getNumJoints(body),
        "surplus": surplus / most if most > 0 else np.inf,
    }


def energy_kept_in_pybullet(
    file: str, steps: int, robot: Mapping[str, Any], gravity: Sequence[float] = ASLANT
) -> float:
    """Simulate a URDF from rest without motors and damping, and compare its energies after some steps of 1 ms.

    PyBullet's semi-implicit Euler method converts n / (n + 1) of the work of a constant force to kinetic energy in n
    steps from rest: a body falls by n (n + 1) / 2 g dt^2 while it reaches the speed n g dt.

    Args:
        file: The URDF.
        steps: Number of steps; so few that forces are nearly constant and no joint reaches its limit.
        robot: The robot in report.json, whose mass properties are used.
        gravity: Acceleration of gravity [m/s^2].

    Returns:
        Kinetic energy relative to that expected of the method; 1 if all masses and inertias are right.
    """
    import pybullet

    from tests.energies import Energies

    body = _in_pybullet(file, False, robot["pybullet"], robot["joints"])
    pybullet.setGravity(*gravity)
    pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
    for joint in _let_go(body):
        pybullet.changeDynamics(body, joint, jointDamping=0)
    energies = Energies(body, robot["links"], gravity)
    for _ in range(steps):
        pybullet.stepSimulation()
    return energies.kinetic() / energies.given() * (steps + 1) / steps


def _let_go(body: int) -> list[int]:
    """Switch off PyBullet's default joint motors; indices of the movable joints."""
    import pybullet

    joints = [i for i in range(pybullet.getNumJoints(body)) if pybullet.getJointInfo(body, i)[3] >= 0]
    for i in joints:
        pybullet.setJointMotorControl2(body, i, pybullet.VELOCITY_CONTROL, force=0)
    return joints


def _in_pybullet(file: str, floating: bool, constraints: Json, joints: Json) -> int:
    """A URDF in its drawn pose, with gravity and steps of 1 ms, its base fixed or on a floor, its loops closed."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    pybullet.setPhysicsEngineParameter(enableFileCaching=0)
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    body = pybullet.loadURDF(file, useFixedBase=not floating, flags=flags)
    drawn = {joint["name"]: joint["drawn_position"] for joint in joints}
    for i in range(pybullet.getNumJoints(body)):
        name = pybullet.getJointInfo(body, i)[1].decode()
        pybullet.resetJointState(body, i, drawn.get(name, 0.0))
    if floating:
        lowest = min(pybullet.getAABB(body, i)[0][2] for i in range(-1, pybullet.getNumJoints(body)))
        plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE)
        pybullet.createMultiBody(0, plane, basePosition=(0, 0, lowest))
    add_constraints(body, constraints)
    pybullet.setGravity(0, 0, -9.81)
    pybullet.setTimeStep(1e-3)
    return body


def driven_at_random_in_pybullet(file: str, seconds: float, robot: Mapping[str, Any]) -> dict[str, Any]:
    """Give every actuator of a robot new random targets every 50 ms, at 1 ms steps; joints that mimic follow.

    Motors are PyBullet's own, with the joints' efforts. A floating robot is on a floor.

    Args:
        file: The URDF.
        seconds: Duration [s].
        robot: The robot in report.json: base, joints, actuators, closures and their constraints.

    Returns:
        PyBullet's output, whether the state stays finite, the largest speed, the largest gap of a loop [m], and the
        number of driven joints.
    """
    import pybullet

    from stepbot.engines.captured_output import printed

    with printed() as lines:
        body = _in_pybullet(file, robot["base"] == "floating", robot["pybullet"], robot["joints"])
        infos = [pybullet.getJointInfo(body, i) for i in range(pybullet.getNumJoints(body))]
        moving = {info[1].decode(): info[0] for info in infos if info[3] >= 0}
        links = {pybullet.getBodyInfo(body)[0].decode(): -1, **{info[12].decode(): info[0] for info in infos}}
        for index in moving.values():
            pybullet.setJointMotorControl2(body, index, pybullet.VELOCITY_CONTROL, force=0)
        generator = np.random.default_rng(0)
        drives = _drives(robot, moving)
        speed, gap, finite = 0.0, 0.0, True
        for number in range(round(seconds * 1000)):
            if number % 50 == 0:
                for joint, kind in drives:
                    _aim(body, moving, joint, kind, generator.uniform(-1.0, 1.0), robot["joints"])
            pybullet.stepSimulation()
            states = [pybullet.getJointState(body, i)[:2] for i in moving.values()]
            finite = finite and bool(np.isfinite(states).all())
            speed = max([speed, *(abs(state[1]) for state in states)])
            for closure in robot["closures"]:
                ends = [_in_world(body, links[closure[f"link_{s}"]], closure[f"pose_{s}"]["xyz"]) for s in "ab"]
                gap = max(gap, float(np.linalg.norm(ends[0] - ends[1])))
    return {"printed": lines, "finite": finite, "speed": speed, "gap": gap, "driven": len(drives)}


def _drives(robot: Mapping[str, Any], moving: Mapping[str, int]) -> list[tuple[Mapping[str, Any], str]]:
    """Joints with actuators and their control modes; of joints that URDF splits, only those that keep the name."""
    by_name = {joint["name"]: joint for joint in robot["joints"]}
    return [(by_name[a["joint"]], a["kind"]) for a in robot["actuators"] if a["joint"] in moving]


def _aim(
    body: int,
    moving: Mapping[str, int],
    joint: Mapping[str, Any],
    kind: str,
    share: float,
    joints: Sequence[Mapping[str, Any]],
) -> None:
    """Set the motor of a joint, and of its mimics, to a share from -1 to 1 of its range."""
    import pybullet

    limits = joint["limits"]
    force = 100.0 if limits["effort"] is None else limits["effort"]
    if kind == "motor":
        pybullet.setJointMotorControl2(body, moving[joint["name"]], pybullet.TORQUE_CONTROL, force=share * force)
        return
    fastest = 1.0 if limits["velocity"] is None else limits["velocity"]
    if kind == "velocity":
        pybullet.setJointMotorControl2(
            body, moving[joint["name"]], pybullet.VELOCITY_CONTROL, targetVelocity=share * fastest, force=force
        )
        return
    low = -np.pi if limits["lower"] is None else limits["lower"]
    high = np.pi if limits["upper"] is None else limits["upper"]
    target = low + (high - low) * (share + 1) / 2
    followers = [j for j in joints if j["mimic"] is not None and j["mimic"]["joint"] == joint["name"]]
    aims = [(joint["name"], target)]
    aims += [(j["name"], j["mimic"]["multiplier"] * target + j["mimic"]["offset"]) for j in followers]
    for name, position in aims:
        pybullet.setJointMotorControl2(
            body, moving[name], pybullet.POSITION_CONTROL, targetPosition=position, force=force, maxVelocity=fastest
        )


def _in_world(body: int, link: int, p_L: Sequence[float]) -> np.ndarray:
    """A point of a link, or with -1 of the base, in the world."""
    import pybullet

    com = pybullet.getBasePositionAndOrientation(body) if link < 0 else pybullet.getLinkState(body, link)[:2]
    return np.asarray(pybullet.multiplyTransforms(*com, _from_com(body, link, p_L), (0, 0, 0, 1))[0])


def closed_in_pybullet(file: str, closure: Mapping[str, Any], driven: str, speed: float) -> dict[str, Any]:
    """Close a loop of a URDF by a point-to-point constraint and turn a joint by a full turn at 1 ms steps.

    Args:
        file: The spanning tree.
        closure: ``link_a``, ``p_A`` [m], ``link_b``, ``p_B`` [m].
        driven: The joint with the motor.
        speed: Speed [rad/s].

    Returns:
        The largest gap [m] with and, as a control, without the constraint, and joint positions every 10 ms.
    """
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    pybullet.setPhysicsEngineParameter(enableFileCaching=0)
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    gaps, found = {}, []
    for closed in (True, False):
        pybullet.resetSimulation()
        pybullet.setGravity(0, 0, -9.81)
        pybullet.setTimeStep(1e-3)
        body = pybullet.loadURDF(file, useFixedBase=True, flags=flags)
        infos = [pybullet.getJointInfo(body, i) for i in range(pybullet.getNumJoints(body))]
        joints = {info[1].decode(): info[0] for info in infos if info[3] >= 0}
        links = {info[12].decode(): info[0] for info in infos}
        a, b = links[closure["link_a"]], links[closure["link_b"]]
        for index in joints.values():
            pybullet.setJointMotorControl2(body, index, pybullet.VELOCITY_CONTROL, force=0)
        if closed:
            pivots = (_from_com(body, a, closure["p_A"]), _from_com(body, b, closure["p_B"]))
            pin = pybullet.createConstraint(body, a, body, b, pybullet.JOINT_POINT2POINT, (0, 0, 0), *pivots)
            pybullet.changeConstraint(pin, maxForce=1e4)
        pybullet.setJointMotorControl2(
            body, joints[driven], pybullet.VELOCITY_CONTROL, targetVelocity=speed, force=100.0
        )
        widest = 0.0
        steps = round(2.02 * np.pi / speed * 1000)  # the motor has a small lag
        for number in range(steps):
            pybullet.stepSimulation()
            ends = (_point(body, a, closure["p_A"]), _point(body, b, closure["p_B"]))
            widest = max(widest, float(np.linalg.norm(ends[0] - ends[1])))
            if closed and number % 10 == 9:
                found.append({name: pybullet.getJointState(body, index)[0] for name, index in joints.items()})
        gaps["closed" if closed else "open"] = widest
    return {"gaps": gaps, "positions": found}


def _from_com(body: int, link: int, p_L: Sequence[float]) -> Sequence[float]:
    """A point of a link in the frame of its inertia, in which constraints are given."""
    import pybullet

    position, turn = pybullet.getDynamicsInfo(body, link)[3:5]
    inverse = pybullet.invertTransform(position, turn)
    p: Sequence[float] = pybullet.multiplyTransforms(*inverse, p_L, (0, 0, 0, 1))[0]
    return p


def _point(body: int, link: int, p_L: Sequence[float]) -> np.ndarray:
    """A point of a link in the world."""
    import pybullet

    state = pybullet.getLinkState(body, link, computeForwardKinematics=True)
    R = np.reshape(pybullet.getMatrixFromQuaternion(state[5]), (3, 3))
    return np.asarray(state[4]) + R @ np.asarray(p_L)


def driven_on_a_floor(file: str, base: str, speeds: Mapping[str, float], seconds: float) -> dict[str, Any]:
    """Put a robot on a floor, let it settle, and drive it at constant targets of its actuators.

    Returns:
        ``place``: x, y [m] and heading [rad] of its base after ``seconds`` at speed, relative to the pose at which it
        reached its speed; ``speeds``: the mean speeds [rad/s] of its actuators in that time.
    """
    import mujoco

    model, data = _on_a_floor(file)
    for _ in range(round(0.5 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    for name, speed in speeds.items():
        data.actuator(name).ctrl[0] = speed
    # Actuators need some time to reach their speed; the measurement starts after that.
    for _ in range(round(0.5 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    X_WS, start = np.array(_pose_of(data.body(base))), data.actuator_length.copy()
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
    reached = {name: float((data.actuator_length - start)[model.actuator(name).id]) / seconds for name in speeds}
    X_SE = np.linalg.inv(X_WS) @ np.array(_pose_of(data.body(base)))
    place = (float(X_SE[0, 3]), float(X_SE[1, 3]), float(np.arctan2(X_SE[1, 0], X_SE[0, 0])))
    return {"place": place, "speeds": reached}


def _on_a_floor(file: str) -> tuple[Any, Any]:
    """Model and data of an MJCF file, in its keyframe on a plane at the lowest point of collision geometry."""
    import mujoco

    model = _model(file)
    data = _at_home(model)
    mujoco.mj_forward(model, data)
    lowest = min(_lowest(model, data, i) for i in range(model.ngeom) if model.geom_contype[i])
    spec = mujoco.MjSpec.from_file(file)
    spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=[0, 0, lowest])
    model = spec.compile()
    return model, _at_home(model)


def _lowest(model: Any, data: Any, geom: int) -> float:
    """Height [m] of the lowest point of a mesh or a sphere; for other shapes, of their box."""
    import mujoco

    down = data.geom_xmat[geom].reshape(3, 3)[2]
    if model.geom_type[geom] == int(mujoco.mjtGeom.mjGEOM_MESH):
        mesh = model.geom_dataid[geom]
        first = model.mesh_vertadr[mesh]
        vertices = model.mesh_vert[first : first + model.mesh_vertnum[mesh]]
        return float(data.geom_xpos[geom][2] + np.min(vertices @ down))
    if model.geom_type[geom] == int(mujoco.mjtGeom.mjGEOM_SPHERE):
        return float(data.geom_xpos[geom][2] - model.geom_size[geom][0])
    return float(data.geom_xpos[geom][2] - np.abs(down) @ model.geom_aabb[geom][3:])


def solved_by_newton(file: str, given: Sequence[Mapping[str, float]], bodies: Sequence[str]) -> list[dict[str, Any]]:
    """Lock some joints of a mechanism with loops at given positions, and solve for all others."""
    import mujoco

    model = _model(file)
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    axes = {int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)}
    single = [i for i in range(model.njnt) if int(model.jnt_type[i]) in axes]
    found = []
    for configuration in given:
        start = {name: float(data.joint(name).qpos[0]) for name in configuration}
        for share in np.linspace(0.1, 1.0, 10):
            _close(model, data, {name: start[name] + share * (q - start[name]) for name, q in configuration.items()})
        mujoco.mj_kinematics(model, data)
        poses = {name: _pose_of(data.body(name)) for name in bodies}
        joints = {model.joint(i).name: float(data.qpos[model.jnt_qposadr[i]]) for i in single}
        found.append({"joints": joints, "poses": poses})
    return found


def _close(model: Any, data: Any, held: Mapping[str, float]) -> None:
    """Newton's method over the rows of equality constraints, for all coordinates except the locked ones."""
    import mujoco

    for name, q in held.items():
        data.joint(name).qpos[0] = q
    fixed = {int(model.joint(name).dofadr[0]) for name in held}
    others = [i for i in range(model.nv) if i not in fixed]
    for _ in range(40):
        mujoco.mj_fwdPosition(model, data)
        rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        J, gaps = data.efc_J.reshape(-1, model.nv)[rows], data.efc_pos[rows]
        step = np.zeros(model.nv)
        step[others] = np.linalg.lstsq(J[:, others], -gaps, rcond=1e-9)[0]
        mujoco.mj_integratePos(model, data.qpos, step, 1.0)
        if float(np.max(np.abs(step))) < 1e-14:
            break
    assert float(np.max(np.abs(gaps))) < 1e-9, f"the loops stay open by {float(np.max(np.abs(gaps)))} m"
