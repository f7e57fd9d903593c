"""The data sheet of a robot: what its geometry, masses and limits allow, over postures in the range of its joints."""

from collections.abc import Iterator
from math import floor, inf, isfinite, log10, pi, sqrt

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array, rotated

from .bounding_boxes import robot_bounds, standing
from .closures import RANK_TOLERANCE, DoesNotClose, Loops, driven_joints, following
from .dh import DhTable, dh_table
from .dynamics import GRAVITY, equations_at, equations_of_motion
from .gains import actuator_limit
from .kinematics import Tree, initial_configuration, link_poses, rigid_bodies
from .model import ActuatorKind, Base, Frame, Joint, JointKind, Robot
from .multi_dof import unfolded
from .sampling import sampled, where_largest, worst_postures

POSTURES = 96
"""Number of postures, the drawn one and random ones, in which forces are computed, beside the worst ones."""
POSTURES_IN_LOOPS = 384
"""The same with closed loops, whose postures follow one another on random walks."""
_STRETCHES = 4
"""Step of the reaches that payloads are given for, relative to the longest: a quarter."""
_DIGITS = 4
"""Significant digits: more would depend on the last bits of the linear algebra."""
_ROUNDING = 1e-9
"""Inertia, relative to itself, and gravity force, relative to the weight of a robot below 1 N, that are rounding."""
_SHORTEST = 3
"""Number of joints of a chain that is an arm."""
_BANDS = 24
"""Bands of equal height of a workspace."""
_RUNS = 12
"""Starts of the search for the farthest posture of an arm."""
_REACHED = 2000
"""Number of postures that show a workspace."""


class JointFigures(Struct, frozen=True):
    """What moves a joint, and what it moves, over all postures; None without the limits or gains for it."""

    name: str
    lower: float
    upper: float
    velocity: float
    effort: float
    """[N m] or [N], of the joint and its actuators; infinite without a limit."""
    gravity: float
    """Largest effort [N m] or [N] that holds it."""
    inertia: tuple[float, float]
    """Least and largest inertia [kg m^2] or mass [kg], armature included."""
    acceleration: float | None
    """Acceleration [rad/s^2] or [m/s^2] that efforts allow it in every posture at rest, the others held."""
    jerk: float | None
    """Limit of the joint [rad/s^3] or [m/s^3], else the acceleration over the lag of a position actuator's gains."""
    frequency: tuple[float, float] | None
    """Natural frequencies [Hz] of a position actuator, with the largest and the least inertia."""


class ArmFigures(Struct, frozen=True):
    """An arm, by the end of its chain of joints."""

    tip: str
    joints: tuple[str, ...]
    reach: float
    """Largest horizontal distance [m] of the tip from the axis of the first joint, or from its origin."""
    payloads: tuple[tuple[float, float], ...]
    """Up to a distance [m] of the tip, the mass [kg] there that efforts hold in every posture; empty without limits."""
    dh: DhTable | None
    """Denavit-Hartenberg parameters; None for joints that have none."""
    workspace: tuple[tuple[float, float, float], ...]
    """Bands of equal height: the middle [m] over the root's origin, least and largest distance [m] of the tip from the
    axis of the first joint, as in :attr:`reach`, over random postures."""


class DataSheet(Struct, frozen=True):
    """The figures of a robot."""

    name: str
    mass: float
    links: tuple[tuple[str, float], ...]
    """Mass [kg] of each link."""
    materials: tuple[tuple[str, float], ...]
    """Mass [kg] of each material, density, motor, and of what is given; empty for a robot that is not from a STEP."""
    motors: tuple[tuple[str, str], ...]
    """Actuators with a motor of the catalogue, and its name."""
    size: tuple[float, float, float] | None
    """Extent [m] in the drawn pose; None without shapes."""
    standing: tuple[float, float | None] | None
    """Height [m] of the base over the floor, and how far [m] the com is inside the support; None for a fixed base."""
    joints: tuple[JointFigures, ...]
    arms: tuple[ArmFigures, ...]
    looped: tuple[str, ...] = ()
    """Moving joints of loops, and behind them: no chain of joints alone places their links."""
    backlash: tuple[tuple[str, float, str], ...] = ()
    """Joints whose motor has a published backlash, the full play that it gives them, and its unit, rad or m."""


def data_sheet(robot: Robot) -> DataSheet:
    """The data sheet of a robot; of joints in loops it has those that drive the others.

    Raises:
        DoesNotClose: The loops do not close in the drawn pose.
    """
    drawn = initial_configuration(robot)
    around = robot_bounds(robot, drawn)
    low, high = around or ((0.0,) * 3, (0.0,) * 3)
    x, y, z = (_rounded(b - a) for a, b in zip(low, high, strict=True))
    forces = _Forces(robot, POSTURES_IN_LOOPS if robot.closures else POSTURES)
    outside = _outside_loops(forces.robot)
    return DataSheet(
        robot.name,
        exact_sum(link.mass_properties.mass for link in robot.links),
        tuple((link.name, link.mass_properties.mass) for link in robot.links),
        _materials(robot),
        tuple((actuator.name, actuator.motor.name) for actuator in robot.actuators if actuator.motor is not None),
        (x, y, z) if around else None,
        standing(robot, drawn) if robot.base is Base.FLOATING else None,
        forces.joints(),
        tuple(_arm(forces, tip) for tip in _tips(outside)),
        tuple(name for name in forces.tree.joints if name not in outside.joint_by_name),
        tuple(_plays(robot)),
    )


def _plays(robot: Robot) -> Iterator[tuple[str, float, str]]:
    for actuator in robot.actuators:
        figure = None if actuator.motor is None else actuator.motor.figure("backlash")
        if figure is not None:
            yield actuator.joint, figure.value, figure.unit


def _materials(robot: Robot) -> tuple[tuple[str, float], ...]:
    """The masses of components by what they are made of, the heaviest first."""
    motors = {
        f"motor of actuator '{actuator.name}'": actuator.motor.name
        for actuator in robot.actuators
        if actuator.motor is not None
    }
    densities: dict[str, list[float]] = {}
    for one in (mass for link in robot.links for mass in link.masses):
        if one.origin in motors:
            name = f"motor {motors[one.origin]}"
        elif one.density is None:
            name = "given masses"
        else:
            name = one.material or f"{one.density:.6g} kg/m^3"
        densities.setdefault(name, []).append(one.mass or 0.0)
    return tuple(
        sorted(((name, exact_sum(masses)) for name, masses in densities.items()), key=lambda one: (-one[1], one[0]))
    )


def accelerations(robot: Robot) -> dict[str, float]:
    """For each driven joint with an effort limit, :attr:`JointFigures.acceleration`; none where loops are open."""
    if not any(isfinite(joint.limit.effort) for joint in robot.joints):
        return {}
    try:
        forces = _Forces(robot, POSTURES_IN_LOOPS if robot.closures else 24)
    except DoesNotClose:  # reported where the loops are verified
        return {}
    return {joint.name: joint.acceleration for joint in forces.joints() if joint.acceleration is not None}


def with_accelerations(robot: Robot) -> Robot:
    """The robot with :func:`accelerations` as limits of the joints that have none of their own."""
    most = accelerations(robot) | {j.name: j.limit.acceleration for j in robot.joints if j.limit.acceleration < inf}
    limits = {j.name: replace(j.limit, acceleration=most.get(j.name, inf)) for j in robot.joints}
    return replace(robot, joints=tuple(replace(joint, limit=limits[joint.name]) for joint in robot.joints))


class _Forces:
    """Mass matrices and gravity forces of the independent joints in all postures; of the driven ones with loops."""

    def __init__(self, robot: Robot, postures: int = POSTURES) -> None:
        self.robot = unfolded(robot)
        self.tree = tree = Tree(self.robot)
        joints = self.robot.joint_by_name
        armature = (
            np.diag([joints[name].dynamics.armature for name in tree.joints]) if tree.joints else np.zeros((0, 0))
        )
        self.q = sampled(robot, postures) if tree.joints else np.zeros((1, 0))
        self.names = driven_joints(robot) if robot.closures else tree.independent
        self.q, S = self._moved() if robot.closures else (self.q, tree.B[None])
        self.M, self.g = self._at(self.q, armature, S)
        own = self.M.diagonal(axis1=1, axis2=2)
        weight = -GRAVITY[2] * exact_sum(link.mass_properties.mass for link in robot.links)
        self.noise = _ROUNDING * min(1.0, weight)
        varies = (np.ptp(own, axis=0) > _ROUNDING * own.max(axis=0)) | (np.abs(self.g).max(axis=0) > self.noise)
        if varies.any() and (worst := worst_postures(robot, tree, np.flatnonzero(varies).tolist())) is not None:
            M, g = self._at(worst[0], armature, S)
            self.q, self.M, self.g = (np.concatenate(pair) for pair in ((self.q, worst[0]), (self.M, M), (self.g, g)))
        self.efforts = np.array([self._effort(name) for name in self.names])

    def _at(self, q: Array, armature: Array, S: Array) -> tuple[Array, Array]:
        """Mass matrices (m, n, n) and gravity forces (m, n) at q (m, joints of the tree); S maps the n to these."""
        equations = equations_at(self.robot, [(self.named(row), ({}, {})) for row in q], tree=self.tree)
        along = np.broadcast_to(S, (len(q), *S.shape[1:]))
        M = np.array([B.T @ (one.mass_matrix + armature) @ B for one, B in zip(equations, along, strict=True)])
        return M, np.array([one.gravity @ B for one, B in zip(equations, along, strict=True)])

    def _moved(self) -> tuple[Array, Array]:
        """The postures that are not near a singularity of the loops, and how all joints follow the driven ones."""
        loops, tree = Loops(self.robot), self.tree
        follow = following(tree, self.names)
        drives = [tree.independent.index(name) for name in self.names]
        _, J = loops.constraints(self.q[:, [tree.joints.index(name) for name in tree.independent]])
        regular = ~loops.singular_many(J, follow)
        regular[0] = True
        T = np.zeros((int(regular.sum()), len(tree.independent), len(drives)))
        T[:, drives, range(len(drives))] = 1.0
        if follow:
            T[:, follow] = -np.linalg.pinv(J[regular][..., follow], rcond=RANK_TOLERANCE) @ J[regular][..., drives]
        return self.q[regular], tree.B @ T

    def named(self, q: Array) -> dict[str, float]:
        return dict(zip(self.tree.joints, q.tolist(), strict=True))

    def _effort(self, name: str) -> float:
        """Effort that moves a joint: that of its actuators, else the limit of the joint; infinite without one."""
        joint = self.robot.joint_by_name[name]
        drives = [actuator_limit(actuator, joint).effort for actuator in self.robot.actuators if actuator.joint == name]
        return min(joint.limit.effort, exact_sum(drives) if drives else inf)

    def joints(self) -> tuple[JointFigures, ...]:
        left = np.maximum(self.efforts - np.abs(self.g), 0.0)
        figures = []
        for j, name in enumerate(self.names):
            joint, own = self.robot.joint_by_name[name], self.M[:, j, j]
            across = np.abs(self.M[:, :, j])
            with np.errstate(divide="ignore", invalid="ignore"):
                allowed = np.where(across > 1e-9 * own[:, None], left / across, inf)
            least, most = float(own.min()), float(own.max())
            servos = [a for a in self.robot.actuators if a.joint == name and a.kind is ActuatorKind.POSITION and a.kp]
            servo = max(servos, key=lambda a: a.kp * a.gear**2, default=None)
            kp = servo.kp * servo.gear**2 if servo is not None else 0.0
            lag = (servo.kv * servo.gear**2 + joint.dynamics.damping) / kp if servo is not None else 0.0
            rates = tuple(_rounded(sqrt(kp / one) / (2.0 * pi)) for one in (most, least)) if kp and least > 0.0 else ()
            limit = float(allowed.min())
            fastest = _rounded_down(limit) if isfinite(limit) and isfinite(self.efforts[j]) else None
            jerk = joint.limit.jerk if isfinite(joint.limit.jerk) else None
            if jerk is None and fastest is not None and lag > 0.0:
                jerk = _rounded_down(fastest / lag)
            figures.append(
                JointFigures(
                    name,
                    *(joint.limit.lower, joint.limit.upper, joint.limit.velocity, float(self.efforts[j])),
                    _rounded(float(np.abs(self.g[:, j]).max()), self.noise),
                    (_rounded(least, 0.0), _rounded(most, 0.0)),
                    fastest,
                    jerk,
                    (rates[0], rates[1]) if rates else None,
                )
            )
        return tuple(figures)


def _rounded(value: float, noise: float = 1e-9) -> float:
    return round(value, _DIGITS - 1 - floor(log10(abs(value)))) if abs(value) > noise else 0.0


def _rounded_down(value: float) -> float:
    """The value to three digits, never more than it is."""
    if value < 1e-9:  # the last decimal
        return 0.0
    unit = 10.0 ** (floor(log10(value)) - 2)
    return round(floor(value / unit * (1.0 + 1e-9)) * unit, 9)


def _tips(robot: Robot) -> list[Frame]:
    """The ends of chains of three or more joints: the farthest frame of the last body, or of that with the fingers."""
    bodies = rigid_bodies(robot.root.name, robot.joints)
    moving = [joint for joint in robot.joints if joint.kind is not JointKind.FIXED]
    below: dict[str, list[str]] = {}
    for joint in moving:
        below.setdefault(bodies[joint.parent], []).append(bodies[joint.child])
    ends: dict[str, None] = {}
    for joint in moving:
        body = bodies[joint.child]
        leaves = [one for one in below.get(body, []) if not below.get(one)]
        inner = [one for one in below.get(body, []) if below.get(one)]
        if (not below.get(body) and len(below[bodies[joint.parent]]) == 1) or (not inner and len(leaves) > 1):
            ends[body] = None
    X = link_poses(robot, initial_configuration(robot))
    tips = []
    for body in ends:
        if len(_chain(robot, body)) < _SHORTEST:
            continue
        places = [frame for frame in robot.frames if bodies[frame.link] == body]
        places = places or [Frame(link.name, link.name) for link in robot.links if bodies[link.name] == body]
        tips.append(
            max(places, key=lambda place: float(np.linalg.norm((X[body].inverse() @ X[place.link] @ place.X_LF).p)))
        )
    return tips


def _chain(robot: Robot, link: str) -> list[str]:
    """The moving joints from the root to a link."""
    above, names = {joint.child: joint for joint in robot.joints}, list[str]()
    while link in above:
        if above[link].kind is not JointKind.FIXED:
            names.append(above[link].name)
        link = above[link].parent
    return names[::-1]


def _outside_loops(robot: Robot) -> Robot:
    """The links and frames that no joint of a loop moves, such as an arm without the closed hand at its end."""
    if not robot.closures:
        return robot
    loops = Loops(robot)
    inside = [name in loops.involved for name in loops.tree.independent]
    closed = {name for name, row in zip(loops.tree.joints, loops.tree.B, strict=True) if row[inside].any()}
    links, joints = {robot.root.name}, list[Joint]()
    for joint in robot.joints:
        if joint.parent in links and joint.name not in closed:
            links.add(joint.child)
            joints.append(joint)
    return Robot(
        robot.name,
        tuple(link for link in robot.links if link.name in links),
        tuple(joints),
        frames=tuple(frame for frame in robot.frames if frame.link in links),
    )


def _arm(forces: _Forces, tip: Frame) -> ArmFigures:
    """An arm's reach, payload and parameters."""
    robot, tree = forces.robot, forces.tree
    names = _chain(robot, tip.link)
    first = robot.joint_by_name[names[0]]

    def distances(q: Array) -> tuple[Array, Array]:
        """Horizontal distance of the tip from the first joint, and its height, at q (..., joints)."""
        X = tree.frames(q)
        i, start = tree.link_index[tip.link], tree.link_index[first.child]
        p = X[..., i, :3, 3] + rotated(X[..., i, :3, :3], np.asarray(tip.X_LF.p))
        apart = p - X[..., start, :3, 3]
        return np.hypot(apart[..., 0], apart[..., 1]), p[..., 2]

    varied = [i for i, name in enumerate(tree.independent) if name in names]
    q = where_largest(robot, tree, [varied], lambda q: distances(q)[0], _RUNS)[0]
    reach = float(distances(q)[0])
    limited = np.isfinite(forces.efforts)
    payloads: list[tuple[float, float]] = []
    if limited.any():
        postures = np.vstack([forces.q, q])
        held = [
            (float(far), _payload(forces, tip, one)) for far, one in zip(distances(postures)[0], postures, strict=True)
        ]
        for part in range(1, _STRETCHES + 1):
            edge = reach * part / _STRETCHES
            within = [mass for far, mass in held if far <= edge * (1.0 + 1e-9)]
            if within and isfinite(min(within)):
                payloads.append((_rounded(edge), _rounded(max(min(within), 0.0), 0.0)))
    shown = _workspace(*distances(sampled(forces.robot, _REACHED)))
    return ArmFigures(
        tip.name, tuple(names), _rounded(reach), tuple(payloads), dh_table(forces.robot, names, tip), shown
    )


def _workspace(apart: Array, height: Array) -> tuple[tuple[float, float, float], ...]:
    """Bands of equal height, and the least and largest distance in each."""
    low, high = float(height.min()), float(height.max())
    if high - low < _BANDS * 1e-6:
        return ((_rounded(low), _rounded(float(apart.min())), _rounded(float(apart.max()))),)
    band = np.minimum((_BANDS * (height - low) / (high - low)).astype(int), _BANDS - 1)
    middle = [low + (j + 0.5) * (high - low) / _BANDS for j in range(_BANDS)]
    inside = [apart[band == j] for j in range(_BANDS)]
    return tuple(
        (_rounded(z), _rounded(float(r.min())), _rounded(float(r.max())))
        for z, r in zip(middle, inside, strict=True)
        if len(r)
    )


def _payload(forces: _Forces, tip: Frame, q: Array) -> float:
    """The mass [kg] at the tip that the efforts hold in one posture; negative if they do not hold the arm."""
    tree = forces.tree
    B = tree.B[:, [tree.independent.index(name) for name in forces.names]]
    X = tree.frames(q)
    i = tree.link_index[tip.link]
    p = X[i, :3, 3] + X[i, :3, :3] @ tip.X_LF.p
    lever = -(tree.jacobian(X, i, p)[3:].T @ np.array(GRAVITY)) @ B
    own = equations_of_motion(forces.robot, forces.named(q), tree=tree).gravity @ B
    masses = [
        (effort - own_ * np.sign(arm)) / abs(arm)
        for effort, own_, arm in zip(forces.efforts, own, lever, strict=True)
        if isfinite(effort) and abs(arm) > 1e-9
    ]
    return float(min(masses, default=inf))
