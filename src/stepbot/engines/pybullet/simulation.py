"""A robot's URDF driven in PyBullet, in the scene of a test.

URDF has no gains, so a position motor is PyBullet's own: it reaches its target with the time constant kv / kp of the
actuator, within the joint's effort and velocity. Mimics are gears and loops point-to-point constraints, as in
``stepbot.close_loops``: PyBullet reads neither from a file. Armature is not in URDF either: damping that PyBullet would
diverge by without it acts as a motor, whose effort at a speed is the damping times that speed. Links do not collide
with each other, PyBullet's default, since URDF cannot exclude pairs.
"""

from collections.abc import Mapping
from math import copysign, inf, isfinite
from pathlib import Path
from time import perf_counter

import numpy as np

from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.model import ActuatorKind, Base
from stepbot.robot.pybullet_closures import add_constraints

from ..captured_output import printed
from ..observation import EngineRefused
from ..simulation import DOWN, FRICTION, GRAVITY, HEIGHT, Mechanism, Motor, Setup
from ..xml import xml_root
from .body import Body, body_of, pose
from .motion import gears, release

FORMAT = "urdf"
"""The format that is driven."""
_STEP = 2e-3
"""Step [s] of robots without loops."""
_LOOP_STEP = 1e-3
"""Step [s] of robots with loops."""
_FINE_STEP = 5e-4
"""Step [s] where energy is measured. PyBullet integrates to first order: a limp Sawyer gains 7.1, 3.5 and 1.7 % of its
energy in a second with steps of 2, 1 and 0.5 ms."""
_ITERATIONS = 200
"""Maximum solver iterations per step: coupled constraints, contacts and motors converge one by one. With 50, rollers of
mecanum wheels lose a tenth of the way, a cube turns out of the grip of a jaw and its hand, and efforts of an arm's
shoulder throw its wrist."""
_GRIPPING_ITERATIONS = 1000
"""The same for loops that press on a cube: with 200 the pins of the 2F-85 open by 1.3 mm."""
_CLAMPED = 100.0
"""Speed [rad/s], [m/s] beyond which PyBullet clamps a joint, whatever the file states."""
_UNLIMITED = 1e4
"""Force [N], [N m] of motors without an effort limit."""
_GEAR_FORCE = 1e4
"""Maximum force [N], [N m] of the gear of a mimic."""


class PybulletSimulation:
    """:class:`~stepbot.engines.simulation.Simulation` in PyBullet."""

    def __init__(self, file: str, mechanism: Mechanism, setup: Setup) -> None:
        """Load the file into a world of its own.

        Raises:
            EngineRefused: PyBullet does not load it.
            EngineCannotRead: It has too many joints.
        """
        import pybullet as engine

        self._engine, self._mechanism, self._setup = engine, mechanism, setup
        self.timestep = _FINE_STEP if setup.fine else _LOOP_STEP if mechanism.constraints else _STEP
        self.seconds, self.steps = 0.0, 0
        self._client = engine.connect(engine.DIRECT)
        engine.setGravity(0.0, 0.0, -GRAVITY)
        engine.setPhysicsEngineParameter(
            fixedTimeStep=self.timestep,
            numSolverIterations=_GRIPPING_ITERATIONS if mechanism.constraints and setup.cube else _ITERATIONS,
            deterministicOverlappingPairs=1,
        )
        floating = mechanism.robot.base is Base.FLOATING
        self._free = floating and not setup.held
        height = HEIGHT if floating else 0.0
        flags = engine.URDF_USE_INERTIA_FROM_FILE | engine.URDF_USE_IMPLICIT_CYLINDER
        try:
            with printed():
                number = engine.loadURDF(file, [0.0, 0.0, height], useFixedBase=not self._free, flags=flags)
        except engine.error as error:
            engine.disconnect(self._client)
            raise EngineRefused(str(error)) from error
        self._body: Body = body_of(engine, number)
        self._index = {link: index for index, link in enumerate(self._body.links, start=-1)}
        self._joints = self._body.coordinates
        self._turning = [info[0] for info in self._body.joints if info[2] == engine.JOINT_SPHERICAL]
        for index in self._index.values():  # damping of PyBullet's own, which no file asks for
            engine.changeDynamics(number, index, linearDamping=0.0, angularDamping=0.0)
        self._masses = self._mass_properties()
        self._motors = {motor.name: motor for motor in mechanism.motors if motor.joint in self._joints}
        self._damping = {name: self._taken_damping(name) for name in sorted(mechanism.stiff & self._joints.keys())}
        self._fastest = {motor.joint: motor.limit.velocity for motor in self._motors.values()}
        self._allow_speeds()
        self._push: Array | None = None
        self._efforts: dict[str, float] = {}
        self._targets: dict[Motor, float] = {}
        self._floor = self._cube = self._fixed = -1
        self._lift = np.zeros(3)
        """Force (3,) [N] on the cube: against its weight, or to turn its weight into another direction."""
        self._add_scene(file)
        self.reset(mechanism.home)
        self._join()

    def _taken_damping(self, joint: str) -> float:
        """The damping [N m s/rad], [N s/m] of a joint, which PyBullet no longer applies."""
        index = self._joints[joint]
        damping = float(self._body.joints[index][6])
        self._engine.changeDynamics(self._body.id, index, jointDamping=0.0)
        return damping

    def _allow_speeds(self) -> None:
        """Raise the speed at which PyBullet clamps all joints of a body, to twice the fastest limit of a motor."""
        fastest = 2.0 * max(filter(isfinite, self._fastest.values()), default=0.0)
        if fastest > _CLAMPED:
            self._engine.changeDynamics(self._body.id, -1, maxJointVelocity=fastest)

    def _add_scene(self, file: str) -> None:
        engine, setup, friction = self._engine, self._setup, FRICTION
        # Of two bodies PyBullet takes the product.
        stated = {one.getparent().getparent().get("name") for one in xml_root(Path(file)).iter("lateral_friction")}
        for index, link in enumerate(self._body.links, start=-1):
            if link not in stated:
                engine.changeDynamics(self._body.id, index, lateralFriction=FRICTION)
        if setup.floor:
            plane = engine.createCollisionShape(engine.GEOM_PLANE, planeNormal=[0, 0, 1])
            self._floor = engine.createMultiBody(0.0, plane)
            engine.changeDynamics(self._floor, -1, lateralFriction=friction)
        if setup.cube is not None:
            half = 0.5 * setup.cube.edge
            if setup.cube.shape == "cube":
                shape = engine.createCollisionShape(engine.GEOM_BOX, halfExtents=[half] * 3)
            elif setup.cube.shape == "cylinder":
                shape = engine.createCollisionShape(engine.GEOM_CYLINDER, radius=half, height=2.0 * half)
            else:
                shape = engine.createCollisionShape(engine.GEOM_SPHERE, radius=half)
            self._cube = engine.createMultiBody(setup.cube.mass, shape, basePosition=[0, 0, -HEIGHT])
            engine.changeDynamics(
                self._cube, -1, lateralFriction=friction, linearDamping=0.0, angularDamping=0.0, activationState=4
            )

    def _join(self) -> None:
        """Close the loops and add the gears of mimics."""
        body = self._body
        add_constraints(body.id, self._mechanism.constraints)
        joined = {
            name: mimic for name, mimic in self._mechanism.mimics.items() if {name, mimic.joint} <= self._joints.keys()
        }
        gears(body, joined, _GEAR_FORCE)

    def reset(self, q: Mapping[str, float], X_WR: Pose | None = None) -> None:  # noqa: D102
        engine, body = self._engine, self._body
        if X_WR is None:
            height = HEIGHT if self._mechanism.robot.base is Base.FLOATING else 0.0
            X_WR = Pose.of(position=(0.0, 0.0, height))
        X_WI = X_WR @ body.X_LI[0]
        engine.resetBasePositionAndOrientation(body.id, X_WI.position, _xyzw(X_WI))
        engine.resetBaseVelocity(body.id, [0, 0, 0], [0, 0, 0])
        body.set(q)
        self.release()
        if self._cube >= 0:
            self.place_cube(Pose.of(position=(0.0, 0.0, -HEIGHT)))

    def command(self, targets: Mapping[str, float]) -> None:  # noqa: D102
        self._efforts, self._targets = {}, {}
        for name, target in targets.items():
            if name not in self._motors:
                continue
            self._targets[self._motors[name]] = target

    def _turn(self, joint: str, speed: float, effort: float) -> None:
        """Drive a joint at a speed, with an effort of a limit."""
        self._engine.setJointMotorControl2(
            self._body.id,
            self._joints[joint],
            self._engine.VELOCITY_CONTROL,
            targetVelocity=speed,
            force=effort if isfinite(effort) else _UNLIMITED,
        )

    def _approach(self, motor: Motor, target: float) -> None:
        """Drive a joint towards a position or at a speed for one step, with the effort that is left at its speed.

        Along the torque-speed line of a position motor, that is less than the effort limit in the direction of motion
        and more against it, as in MJCF, where this part of kv is outside of the range of force. So is damping.
        """
        damping, limit = self._damping.get(motor.joint, 0.0), motor.limit
        if motor.kind is ActuatorKind.VELOCITY and not damping:
            self._turn(motor.joint, target, limit.effort)
            return
        q, v = self._engine.getJointState(self._body.id, self._joints[motor.joint])[:2]
        speed = target
        if motor.kind is not ActuatorKind.VELOCITY:
            delay = max(self.timestep, motor.kv / motor.kp)
            speed = min(max((target - q) / delay, -limit.velocity), limit.velocity)
            damping += min(motor.kv, limit.effort / limit.velocity)
        self._turn(motor.joint, speed, max(0.0, limit.effort - copysign(damping, speed - v) * v))

    def _brake(self, joint: str, effort: float, fastest: float) -> None:
        """Apply an effort and the damping of a joint for one step: a motor towards the speed where they are equal."""
        v, damping = self._engine.getJointState(self._body.id, self._joints[joint])[1], self._damping[joint]
        self._turn(joint, min(max(effort / damping, -fastest), fastest), abs(effort - damping * v))

    def release(self) -> None:  # noqa: D102
        engine, body = self._engine, self._body
        self._efforts, self._targets, self._push = {}, {}, None
        release(body)
        for index in self._turning:
            engine.setJointMotorControlMultiDof(
                body.id, index, engine.POSITION_CONTROL, [0, 0, 0, 1], force=[0, 0, 0], positionGain=0.0
            )

    def apply(self, efforts: Mapping[str, float]) -> None:  # noqa: D102
        # URDF has no armature: one step of full effort would accelerate a light joint far beyond its limit of speed. A
        # velocity motor with that effort stops at the limit.
        self._efforts, self._targets = {}, {}
        for name, effort in efforts.items():
            fastest = self._fastest.get(name, inf)
            if name not in self._joints:
                continue
            if name in self._damping or not isfinite(fastest):
                self._efforts[name] = effort
            else:
                self._turn(name, copysign(fastest, effort), abs(effort))

    def push(self, force_W: Array) -> None:  # noqa: D102
        self._push = force_W if np.any(force_W) else None

    def step(self) -> None:  # noqa: D102
        engine, body = self._engine, self._body
        start = perf_counter()
        for motor, target in self._targets.items():
            self._approach(motor, target)
        for name in self._damping:
            if all(motor.joint != name for motor in self._targets):
                self._brake(name, self._efforts.get(name, 0.0), self._fastest.get(name, inf))
        for name, effort in self._efforts.items():
            if name not in self._damping:
                engine.setJointMotorControl2(body.id, self._joints[name], engine.TORQUE_CONTROL, force=effort)
        if self._push is not None:
            place = body.X_WI(-1).position
            engine.applyExternalForce(body.id, -1, self._push.tolist(), place, engine.WORLD_FRAME)
        if np.any(self._lift):
            place = engine.getBasePositionAndOrientation(self._cube)[0]
            engine.applyExternalForce(self._cube, -1, self._lift.tolist(), place, engine.WORLD_FRAME)
        engine.stepSimulation()
        self.seconds += perf_counter() - start
        self.steps += 1

    def _states(self) -> list[tuple[float, float]]:
        states = self._engine.getJointStates(self._body.id, list(self._joints.values())) if self._joints else ()
        return [(float(state[0]), float(state[1])) for state in states]

    def positions(self) -> dict[str, float]:  # noqa: D102
        return {name: state[0] for name, state in zip(self._joints, self._states(), strict=True)}

    def speeds(self) -> dict[str, float]:  # noqa: D102
        return {name: state[1] for name, state in zip(self._joints, self._states(), strict=True)}

    def effort(self, joint: str) -> float:  # noqa: D102
        return float(self._engine.getJointState(self._body.id, self._joints[joint])[3])

    def pose(self, link: str) -> Pose:  # noqa: D102
        return self._body.X_WL(self._index[link])

    def lowest(self) -> float:  # noqa: D102
        self._engine.performCollisionDetection()
        near = self._engine.getClosestPoints(self._body.id, self._floor, 10.0)
        return min((float(point[8]) for point in near), default=0.0)

    def _mass_properties(self) -> list[tuple[int, float, Array]]:
        """Index, mass and principal inertia (3,) of each link with mass."""
        properties = []
        for index in range(-1, len(self._body.joints)):
            info = self._engine.getDynamicsInfo(self._body.id, index)
            if info[0] > 0.0:
                properties.append((index, float(info[0]), np.array(info[2], dtype=np.float64)))
        return properties

    def energy(self) -> tuple[float, float]:  # noqa: D102
        potential = kinetic = 0.0
        for index, mass, inertia in self._masses:
            if index < 0:
                v, w = self._engine.getBaseVelocity(self._body.id)
            else:
                v, w = self._engine.getLinkState(self._body.id, index, computeLinkVelocity=1)[6:8]
            X_WI = self._body.X_WI(index)
            w_I = X_WI.R.T @ np.array(w)
            potential += mass * GRAVITY * X_WI.position[2]
            kinetic += 0.5 * mass * float(np.dot(v, v)) + 0.5 * float(w_I @ (inertia * w_I))
        return potential, kinetic

    def _depths(self) -> list[float]:
        return [-float(contact[8]) for contact in self._engine.getContactPoints(self._body.id)]

    def penetration(self) -> float:  # noqa: D102
        return max(0.0, *self._depths(), 0.0)

    def standing(self) -> Mapping[str, Array]:  # noqa: D102
        places: dict[str, list[Array]] = {}
        for contact in self._engine.getContactPoints(self._body.id, self._floor):
            places.setdefault(self._body.links[int(contact[3]) + 1], []).append(np.array(contact[5]))
        return {link: np.mean(points, axis=0) for link, points in places.items()}

    def place_cube(self, X_WC: Pose) -> None:  # noqa: D102
        self._engine.resetBasePositionAndOrientation(self._cube, X_WC.position, _xyzw(X_WC))
        self._engine.resetBaseVelocity(self._cube, [0, 0, 0], [0, 0, 0])
        self._turn_weight(np.zeros(3))

    def fix_cube(self, link: str) -> None:  # noqa: D102
        index = self._index[link]
        X_IC = self._body.X_WI(index).inverse() @ self.cube()
        self._fixed = self._engine.createConstraint(
            self._body.id,
            index,
            self._cube,
            -1,
            self._engine.JOINT_FIXED,
            [0, 0, 0],
            X_IC.position,
            [0, 0, 0],
            _xyzw(X_IC),
        )

    def free_cube(self) -> None:  # noqa: D102
        if self._fixed >= 0:
            self._engine.removeConstraint(self._fixed)
            self._fixed = -1

    def let_go(self, down: Array) -> None:  # noqa: D102
        self._turn_weight(down)

    def _turn_weight(self, down: Array) -> None:
        """Let the cube's weight act in a direction (3,); nowhere for zeros."""
        if self._setup.cube is not None:
            self._lift = GRAVITY * self._setup.cube.mass * (down - DOWN)

    def cube(self) -> Pose:  # noqa: D102
        return pose(*self._engine.getBasePositionAndOrientation(self._cube))

    def finite(self) -> bool:  # noqa: D102
        base = self._engine.getBasePositionAndOrientation(self._body.id)
        values = [value for state in (*self._states(), *base) for value in state]
        return all(isfinite(value) for value in values)

    def close(self) -> None:  # noqa: D102
        self._engine.disconnect(self._client)


def _xyzw(X: Pose) -> tuple[float, float, float, float]:
    w, x, y, z = X.quaternion
    return x, y, z, w


SIMULATION = PybulletSimulation
