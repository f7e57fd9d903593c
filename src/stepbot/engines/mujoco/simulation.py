"""A robot's MJCF driven in MuJoCo, in the scene of a test."""

from collections.abc import Iterator, Mapping
from functools import cached_property
from math import copysign, isfinite
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.model import Base
from stepbot.runtime.file import is_file

from ..observation import EngineRefused
from ..simulation import DOWN, FRICTION, GRAVITY, HEIGHT, Mechanism, Setup
from .compiled import Compiled
from .devices import motor_damping
from .shapes import geom_bounds

FORMAT = "mjcf"
"""The format that is driven."""
SCENE = ".scene.xml"
"""Suffix of the scene beside the robot's file, whose floor is used if it is there."""
_CUBE = "stepbot/cube"
_CORRECTIONS = 12
"""Maximum number of times that efforts are corrected in a step, ..."""
_NEAR = 0.01
"""... and error of the speed, relative to its limit, at which they are not corrected again."""
_FIXED = "stepbot/cube on "
"""Start of the name of the weld that fixes the cube to a link."""


def _ignore(_warning: str) -> None:
    """Do nothing with a warning."""


class MujocoSimulation:
    """:class:`~stepbot.engines.simulation.Simulation` in MuJoCo."""

    def __init__(self, file: str, mechanism: Mechanism, setup: Setup) -> None:
        """Compile the file with the scene of a test around it.

        Raises:
            EngineRefused: MuJoCo does not compile it.
        """
        import mujoco as engine

        self._engine, self._mechanism, self._setup = engine, mechanism, setup
        # Its own handler writes a log file into the working directory; numbers show what it warns of.
        engine.set_mju_user_warning(_ignore)
        try:
            self.model: Any = _spec(engine, file, mechanism, setup).compile()
        except ValueError as error:
            raise EngineRefused(str(error).replace(f"{Path(file).parent.as_posix()}/", "").strip()) from error
        self.data: Any = engine.MjData(self.model)
        self.timestep = float(self.model.opt.timestep)
        self.seconds, self.steps = 0.0, 0
        self._compiled = Compiled(engine, self.model, mechanism.balls)
        self._coordinates = self._compiled.coordinates
        self._root = self._id("BODY", mechanism.robot.root.name)
        self._flags = int(self.model.opt.disableflags)
        self._motor_damping = [motor_damping(self._compiled, a) for a in range(self.model.nu)]
        self._actuator = {motor.name: self._id("ACTUATOR", motor.name) for motor in mechanism.motors}
        moving = [self._id("JOINT", name) for name in self._coordinates.names]
        self._joints = {name: joint for name, joint in zip(self._coordinates.names, moving, strict=True) if joint >= 0}
        self._qpos = [int(self.model.jnt_qposadr[joint]) for joint in self._joints.values()]
        self._dofs = [int(self.model.jnt_dofadr[joint]) for joint in self._joints.values()]
        self._solid = [g for g in range(self.model.ngeom) if self._is_solid(g)]
        self._own = frozenset(self._solid)

    @cached_property
    def _probe(self) -> int:
        """The geom of the cube."""
        return int(self.model.body_geomadr[self._id("BODY", _CUBE)])

    def _id(self, kind: str, name: str) -> int:
        return int(self._engine.mj_name2id(self.model, getattr(self._engine.mjtObj, f"mjOBJ_{kind}"), name))

    def _is_solid(self, geom: int) -> bool:
        """Whether a geom is a collision shape of the robot."""
        body = int(self.model.geom_bodyid[geom])
        touches = self.model.geom_contype[geom] or self.model.geom_conaffinity[geom]
        return bool(touches) and int(self.model.body_rootid[body]) == self._root

    def reset(self, q: Mapping[str, float], X_WR: Pose | None = None) -> None:  # noqa: D102
        self._engine.mj_resetData(self.model, self.data)
        self._coordinates.place(self.data.qpos, q)
        if X_WR is not None and self._mechanism.robot.base is Base.FLOATING:
            start = int(self.model.jnt_qposadr[self.model.body_jntadr[self._root]])
            self.data.qpos[start : start + 7] = [*X_WR.position, *X_WR.quaternion]
        self.release()
        if self._setup.cube is not None:
            self.place_cube(Pose.of(position=(0.0, 0.0, -HEIGHT)))
        self._engine.mj_forward(self.model, self.data)

    def command(self, targets: Mapping[str, float]) -> None:  # noqa: D102
        self.model.opt.disableflags = self._flags
        for motor in self._mechanism.motors:
            if motor.name in targets:
                self.data.ctrl[self._actuator[motor.name]] = motor.gear * targets[motor.name]

    def release(self) -> None:  # noqa: D102
        self.model.opt.disableflags = self._flags | int(self._engine.mjtDisableBit.mjDSBL_ACTUATION)
        self.data.qfrc_applied[:] = 0.0
        self.data.xfrc_applied[:] = 0.0

    def apply(self, efforts: Mapping[str, float]) -> None:  # noqa: D102
        # One step of full effort accelerates a light joint far beyond its limit of speed. Each motor gives the share of
        # its effort, or of the same against it, that ends the step at the limit: the secant method, joint by joint.
        dofs = {name: int(self.model.jnt_dofadr[self._joints[name]]) for name in efforts}
        limits = {motor.joint: motor.limit.velocity for motor in self._mechanism.motors}
        limited = [name for name in efforts if isfinite(limits[name]) and efforts[name]]
        slopes = {name: self.timestep * self._mobility(dofs[name]) * abs(efforts[name]) for name in limited}
        shares, excess = dict.fromkeys(efforts, 1.0), dict.fromkeys(limited, 0.0)
        changes = dict.fromkeys(limited, 0.0)
        engine, state = self._engine, self._engine.mjtState
        whole = int(state.mjSTATE_FULLPHYSICS) | int(state.mjSTATE_WARMSTART)
        start = np.zeros(engine.mj_stateSize(self.model, whole))
        engine.mj_getState(self.model, self.data, start, whole)
        for _ in range(_CORRECTIONS):
            for name, dof in dofs.items():
                self.data.qfrc_applied[dof] = shares[name] * efforts[name]
            engine.mj_step(self.model, self.data)  # its integrator accelerates braked joints less than qacc
            near = True
            for name in limited:
                speed = float(self.data.qvel[dofs[name]])
                before, excess[name] = excess[name], copysign(1.0, efforts[name]) * speed - limits[name]
                if (excess[name] - before) * changes[name] > 0.0:
                    slopes[name] = (excess[name] - before) / changes[name]
                share = min(max(shares[name] - excess[name] / slopes[name], -1.0), 1.0)
                changes[name], shares[name] = share - shares[name], share
                near = near and abs(changes[name] * slopes[name]) < _NEAR * limits[name]
            engine.mj_setState(self.model, self.data, start, whole)
            if near:
                break

    def _mobility(self, dof: int) -> float:
        """Acceleration [rad/s^2] or [m/s^2] that an effort of 1 gives a coordinate while the others move freely."""
        unit, moved = np.zeros((1, self.model.nv)), np.zeros((1, self.model.nv))
        unit[0, dof] = 1.0
        self._engine.mj_solveM(self.model, self.data, moved, unit)
        return float(moved[0, dof])

    def push(self, force_W: Array) -> None:  # noqa: D102
        self.data.xfrc_applied[self._root, :3] = force_W

    def step(self) -> None:  # noqa: D102
        start = perf_counter()
        self._engine.mj_step(self.model, self.data)
        self.seconds += perf_counter() - start
        self.steps += 1

    def positions(self) -> dict[str, float]:  # noqa: D102
        return dict(zip(self._joints, self.data.qpos[self._qpos].tolist(), strict=True))

    def speeds(self) -> dict[str, float]:  # noqa: D102
        return dict(zip(self._joints, self.data.qvel[self._dofs].tolist(), strict=True))

    def effort(self, joint: str) -> float:  # noqa: D102
        # With the part of its damping that its range of force does not cut off.
        index = self._joints[joint]
        dof, actuator = int(self.model.jnt_dofadr[index]), int(self.model.jnt_actuatorid[index])
        damping = self._motor_damping[actuator] if actuator >= 0 else 0.0
        return float(self.data.qfrc_actuator[dof] + self.data.qfrc_applied[dof]) - damping * float(self.data.qvel[dof])

    def pose(self, link: str) -> Pose:  # noqa: D102
        return self._body_pose(self._id("BODY", link))

    def _body_pose(self, body: int) -> Pose:
        # Step leaves xpos at the start of the step; positions are compared with qpos, so both are of the same instant.
        return Pose.of(self.data.xmat[body].reshape(3, 3), self.data.xpos[body])

    def lowest(self) -> float:  # noqa: D102
        data = self.data
        poses = {g: Pose.of(data.geom_xmat[g].reshape(3, 3), data.geom_xpos[g]) for g in self._solid}
        return min((geom_bounds(self._compiled, g, X_WG)[0][2] for g, X_WG in poses.items()), default=0.0)

    def shape_points(self, geom: int) -> Array:
        """Corners (n, 3) of a mesh or box in the world; of a round shape, of a box around it."""
        model, data = self.model, self.data
        mesh = int(model.geom_dataid[geom])
        if mesh >= 0:
            points = np.array(self._compiled.vertices(mesh), dtype=np.float64)
        else:
            half = np.array(model.geom_aabb[geom][3:])
            signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T
            points = signs * half
        return np.array(points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])

    def solids(self, links: "frozenset[str] | set[str]") -> list[int]:
        """The collision geoms of some links."""
        bodies = {self._id("BODY", link) for link in links}
        return [geom for geom in self._solid if int(self.model.geom_bodyid[geom]) in bodies]

    def distance(self, one: int, other: int, most: float) -> tuple[float, Array]:
        """Distance [m] of two geoms up to ``most``, and the nearest points (2, 3)."""
        ends = np.zeros(6)
        distance = self._engine.mj_geomDistance(self.model, self.data, one, other, most, ends)
        return float(distance), ends.reshape(2, 3)

    def nearest(self, point: Array, geoms: list[int], most: float) -> tuple[float, Array]:
        """Distance [m] of a point (3,) to the nearest of some geoms, up to ``most``, and the nearest point (3,).

        The cube is moved there as a probe, and is a point from then on.
        """
        probe = self._probe
        self.model.geom_size[probe] = 0.0
        self.data.geom_xpos[probe] = point
        least, near = most, point
        ends = np.zeros(6)
        for geom in geoms:
            distance = float(self._engine.mj_geomDistance(self.model, self.data, probe, geom, least, ends))
            if distance < least:
                least, near = distance, ends[3:].copy()
        return least, near

    def energy(self) -> tuple[float, float]:  # noqa: D102
        # A step leaves the poses of its start: potential and kinetic energy are to be of the same instant.
        self._engine.mj_kinematics(self.model, self.data)
        self._engine.mj_comPos(self.model, self.data)
        self._engine.mj_energyPos(self.model, self.data)
        self._engine.mj_energyVel(self.model, self.data)
        return float(self.data.energy[0]), float(self.data.energy[1])

    def _depths(self) -> Iterator[float]:
        for contact in range(self.data.ncon):
            one = self.data.contact[contact]
            if int(one.geom1) in self._own or int(one.geom2) in self._own:
                yield -float(one.dist)

    def penetration(self) -> float:  # noqa: D102
        return max(0.0, *self._depths(), 0.0)

    def overlaps(self, least: float) -> dict[tuple[str, str], float]:
        """How deep [m] links of the robot are in each other, where that is more than ``least``."""
        depths: dict[tuple[str, str], float] = {}
        for one in self.data.contact[: self.data.ncon]:
            if -one.dist > least and {int(one.geom1), int(one.geom2)} <= self._own:
                first, second = sorted(self._compiled.name("BODY", int(b)) for b in self.model.geom_bodyid[one.geom])
                depths[first, second] = max(depths.get((first, second), 0.0), -float(one.dist))
        return depths

    def standing(self) -> Mapping[str, Array]:  # noqa: D102
        places: dict[str, list[Array]] = {}
        for one in self.data.contact[: self.data.ncon]:
            a, b = int(one.geom1), int(one.geom2)
            if (a in self._own) != (b in self._own):
                body = self.model.geom_bodyid[a if a in self._own else b]
                places.setdefault(self.model.body(int(body)).name, []).append(np.array(one.pos))
        return {link: np.mean(points, axis=0) for link, points in places.items()}

    def place_cube(self, X_WC: Pose) -> None:  # noqa: D102
        body = self._id("BODY", _CUBE)
        start = int(self.model.jnt_qposadr[self.model.body_jntadr[body]])
        self.data.qpos[start : start + 7] = [*X_WC.position, *X_WC.quaternion]
        dof = int(self.model.jnt_dofadr[self.model.body_jntadr[body]])
        self.data.qvel[dof : dof + 6] = 0.0
        self.model.body_gravcomp[body] = 1.0
        self.data.xfrc_applied[body] = 0.0
        self._engine.mj_forward(self.model, self.data)

    def fix_cube(self, link: str) -> None:  # noqa: D102
        weld = self._id("EQUALITY", _FIXED + link)
        X_LC = self.pose(link).inverse() @ self.cube()
        self.model.eq_data[weld, :10] = [0.0, 0.0, 0.0, *X_LC.position, *X_LC.quaternion]
        self.data.eq_active[weld] = 1

    def free_cube(self) -> None:  # noqa: D102
        for link in self._mechanism.robot.links:
            weld = self._id("EQUALITY", _FIXED + link.name)
            self.data.eq_active[weld] = 0

    def let_go(self, down: Array) -> None:  # noqa: D102
        cube = self._id("BODY", _CUBE)
        self.model.body_gravcomp[cube] = 0.0
        self.data.xfrc_applied[cube, :3] = GRAVITY * self.model.body_mass[cube] * (down - DOWN)

    def cube(self) -> Pose:  # noqa: D102
        return self._body_pose(self._id("BODY", _CUBE))

    def finite(self) -> bool:  # noqa: D102
        bad = any(warning.number for warning in self.data.warning)
        return bool(np.isfinite(self.data.qpos).all() and np.isfinite(self.data.qvel).all() and not bad)

    def close(self) -> None:  # noqa: D102
        pass


def _spec(engine: Any, file: str, mechanism: Mechanism, setup: Setup) -> Any:
    """The robot's file, or the scene that includes it, with what a test adds."""
    scene = Path(file).with_suffix(SCENE)
    spec = engine.MjSpec.from_file(str(scene) if setup.floor and is_file(scene) else file)
    for key in list(spec.keys):  # a keyframe does not fit a model with a cube
        spec.delete(key)
    if setup.floor and not any(geom.type == engine.mjtGeom.mjGEOM_PLANE for geom in spec.worldbody.geoms):
        spec.worldbody.add_geom(
            name="stepbot/floor", type=engine.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], friction=[FRICTION, 0.005, 0.0001]
        )
    if setup.held and mechanism.robot.base is Base.FLOATING:
        _weld(engine, spec, "stepbot/stand", mechanism.robot.root.name, "world")
    if setup.cube is not None:
        body = spec.worldbody.add_body(name=_CUBE, pos=[0.0, 0.0, -HEIGHT], gravcomp=1.0)
        body.add_freejoint()
        half = 0.5 * setup.cube.edge
        shape = "BOX" if setup.cube.shape == "cube" else setup.cube.shape.upper()
        body.add_geom(
            type=getattr(engine.mjtGeom, f"mjGEOM_{shape}"),
            size=[half] * 3,
            mass=setup.cube.mass,
            friction=[FRICTION, 0.005, 0.0001],
        )
        for link in mechanism.robot.links:
            weld = _weld(engine, spec, _FIXED + link.name, link.name, _CUBE)
            weld.active = False
    return spec


def _weld(engine: Any, spec: Any, name: str, one: str, other: str) -> Any:
    """An equality that holds one body on another."""
    return spec.add_equality(
        name=name,
        type=engine.mjtEq.mjEQ_WELD,
        objtype=engine.mjtObj.mjOBJ_BODY,
        name1=one,
        name2=other,
        solref=[2.0 * float(spec.option.timestep), 1.0],
        solimp=[0.99, 0.999, 0.0001, 0.5, 2.0],
    )


SIMULATION = MujocoSimulation
