"""Validity rules of a robot before it is written, whatever its source.

Engines repair, ignore or crash on invalid robots, each in its own way; stepbot reports them instead. Rules that require
valid numbers, names and tree run only if these are valid, so that one fault is not reported many times.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from math import inf, isinf

import numpy as np

from stepbot.diagnostics import Diagnostics, Span
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.poses import Poses
from stepbot.geometry.spatial import Pose

from .closures import closure_gap
from .inertial_doubts import FARTHEST, GREATEST
from .kinematics import initial_configuration, link_poses, mimic_relation, rigid_bodies
from .model import (
    Actuator,
    Base,
    Collision,
    Frame,
    Joint,
    JointKind,
    Link,
    LoopClosure,
    MeshAsset,
    MeshRef,
    Robot,
    Visual,
)
from .scale import check_scale
from .sensors import Sensor, SensorKind

CLOSURE_DISTANCE = 1e-6
"""Maximum gap [m] of a closure as drawn."""
CLOSURE_ANGLE = 1e-3
"""Maximum angle [rad] of a closure as drawn; CAD models align parallel pins no better."""

_CHECK = ("check its numbers and their units in the source; masses follow from densities, also those in a STEP file",)
_ASSUME = "`--assume-inertia DENSITY` computes them from its geometry"
_UNIT_SLACK = 1e-9
_TRIANGLE_SLACK = 1e-6
_NEGLIGIBLE = 1e-6
"""Share of the mass of what a link is fixed to, at most of 1 kg, below which its missing inertia changes nothing."""
_SLIGHT = 0.01
"""The same, up to which it is a point mass and not a forgotten inertia; a description may have any."""

_Named = Actuator | Collision | Frame | Joint | Link | LoopClosure | MeshAsset | Sensor | Visual
Report = Callable[..., None]


def check_robot(
    robot: Robot,
    diagnostics: Diagnostics,
    span: Span | None = None,
    unit: str = "",
    *,
    massless_between: bool = False,
    places: Callable[[], Mapping[str, Span]] = dict,
) -> None:
    """Report properties that no physical robot can have.

    Args:
        robot: Any robot, from any source.
        span: Where the robot is described; None for its source as a whole.
        unit: Length unit of the robot's source, named if the robot is very large or very light.
        massless_between: Whether links without mass and shape may stand between joints, as in other descriptions.
        places: Gives where elements are described, such as ``link 'arm'`` and ``link 'arm': inertial``; others are at
            ``span``. It is called for faults alone.
    """
    place = span if span is not None else Span(robot.source or robot.name)

    def report(code: str, message: str, *, help: Iterable[str] = (), about: str = "") -> None:
        known, subject = places(), message.partition(": ")[0]
        diagnostics.add(code, message, known.get(about) or known.get(subject, place), help=help)

    sound = [check(robot, report) for check in (_check_names, _check_references, _check_numbers)]
    if all(sound) and _check_tree(robot, report) and _check_mimics(robot, report):
        _check_limits(robot, report)
        _check_masses(robot, report, massless_between=massless_between)
        for rule in (_check_closures, _check_contacts):
            rule(robot, report)
        moves = len(list(_rigid_groups(robot))) > 1 or robot.base is Base.FLOATING
        is_massless = not any(link.mass_properties.mass > 0.0 for link in robot.links)
        check_scale(robot, report, unit, massless=is_massless and not moves and not massless_between)


def _check_names(robot: Robot, report: Report) -> bool:
    """Frames become links in URDF, and closures become joints in SDFormat; the others are unique among themselves.

    Collisions are so within their link.
    """
    groups: dict[str, Iterable[_Named]] = {
        "links and frames": (*robot.links, *robot.frames),
        "joints and closures": (*robot.joints, *robot.closures),
        "actuators": robot.actuators,
        "sensors": robot.sensors,
        "meshes": robot.meshes,
        "visuals": tuple(visual for link in robot.links for visual in link.visuals),
    }
    groups |= {f"collisions of '{link.name}'": link.collisions for link in robot.links}
    sound = True
    for group, members in groups.items():
        for name, count in Counter(member.name for member in members).items():
            if count > 1:
                report("SB135", f"{group}: duplicate name '{name}' ({count} times)")
                sound = False
    return sound


def _check_references(robot: Robot, report: Report) -> bool:
    links, joints, meshes = set(robot.link_by_name), set(robot.joint_by_name), set(robot.mesh_by_name)
    wanted = [(f"joint '{j.name}'", "link", name, links) for j in robot.joints for name in (j.parent, j.child)]
    wanted += [(f"joint '{j.name}'", "joint", j.mimic.joint, joints) for j in robot.joints if j.mimic is not None]
    wanted += [(f"closure '{c.name}'", "link", name, links) for c in robot.closures for name in (c.link_a, c.link_b)]
    wanted += [(f"frame '{frame.name}'", "link", frame.link, links) for frame in robot.frames]
    wanted += [(f"actuator '{drive.name}'", "joint", drive.joint, joints) for drive in robot.actuators]
    wanted += [(f"sensor '{sensor.name}'", "link", sensor.link, links) for sensor in robot.sensors]
    wanted += [(f"sensor '{s.name}'", "joint", s.joint, joints) for s in robot.sensors if s.joint]
    for link in robot.links:
        used = dict.fromkeys((*link.visual_poses, *link.collision_poses))
        wanted += [(f"link '{link.name}'", "mesh", one.name, meshes) for one in used if isinstance(one, MeshRef)]
    missing = [(who, kind, name) for who, kind, name, there in wanted if name not in there]
    for who, kind, name in missing:
        report("SB417", f"{who}: no {kind} '{name}'")
    return not missing


def _check_numbers(robot: Robot, report: Report) -> bool:
    """Everything but limits is finite, nothing too large; rotations are valid and axes have unit length."""
    sound = _check_poses(robot, report)
    for who, numbers in _numbers(robot):
        if not all(abs(value) <= GREATEST for value in numbers):
            report("SB414", f"{who}: a number is not finite, or larger than {GREATEST:g}", help=_CHECK)
            sound = False
    for link in robot.links:
        if not all(abs(value) <= FARTHEST for value in link.mass_properties.com):
            message = f"link '{link.name}': centre of mass is not finite, or farther than {FARTHEST:g} m"
            report("SB414", message, help=_CHECK)
            sound = False
    for mesh in robot.meshes:
        vertices = mesh.mesh.vertices
        if not bool((np.abs(vertices) <= FARTHEST).all()):
            report("SB414", f"mesh '{mesh.name}': a vertex is not finite, or farther than {FARTHEST:g} m", help=_CHECK)
            sound = False
    axes = [(f"joint '{joint.name}'", joint.axis) for joint in robot.joints if joint.kind is not JointKind.FIXED]
    axes += [(f"joint '{j.name}', axis2", j.axis2) for j in robot.joints if j.kind is JointKind.UNIVERSAL]
    axes += [(f"closure '{closure.name}'", closure.axis) for closure in robot.closures]
    for who, axis in axes:
        if abs(float(np.linalg.norm(axis)) - 1.0) > _UNIT_SLACK:
            report("SB415", f"{who}: axis has length {float(np.linalg.norm(axis)):g}, expected 1")
            sound = False
    for joint in robot.joints:
        limit = joint.limit
        bounds = (limit.lower, limit.upper, limit.velocity, limit.effort)
        if not all(isinf(bound) or abs(bound) <= GREATEST for bound in bounds):
            report("SB414", f"joint '{joint.name}': a limit is not a number, or larger than {GREATEST:g}", help=_CHECK)
            sound = False
    return sound


def _check_poses(robot: Robot, report: Report) -> bool:
    """Poses are finite and their rotations valid; all at once, since there are thousands."""
    placed = list(_poses(robot))
    names, arrays = [who for who, _ in placed], [Poses.of(pose for _, pose in placed)]
    for link in robot.links:
        for poses in (*link.visual_poses.values(), *link.collision_poses.values()):
            names += [f"link '{link.name}'"] * len(poses)
            arrays.append(poses)
    if not names:
        return True
    poses = Poses.joined(arrays)
    finite = np.asarray(np.isfinite(poses.R).all(axis=(1, 2)) & (np.abs(poses.p) <= FARTHEST).all(axis=1))
    R = np.where(finite[:, None, None], poses.R, np.eye(3))
    skew = np.abs(R @ R.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
    turns = (skew <= _UNIT_SLACK) & (np.linalg.det(R) > 0.0)
    for i in np.flatnonzero(~finite).tolist():
        report("SB414", f"{names[i]}: pose is not finite, or farther than {FARTHEST:g} m", help=_CHECK)
    for i in np.flatnonzero(~turns).tolist():
        report("SB415", f"{names[i]}: rotation matrix is not orthonormal")
    return bool(finite.all() and turns.all())


def _check_tree(robot: Robot, report: Report) -> bool:
    """The root first, each parent before its children, each link but the root the child of one joint."""
    faults = []
    if not robot.links:
        faults.append("no links")
    parents = Counter(joint.child for joint in robot.joints)
    faults += [f"link '{link}' is the child of {count} joints" for link, count in parents.items() if count > 1]
    faults += [
        f"link '{link.name}' is not the root, but has no parent joint"
        for link in robot.links[1:]
        if not parents[link.name]
    ]
    if robot.links and parents[robot.root.name]:
        faults.append(f"root link '{robot.root.name}' has a parent joint")
    known = {robot.root.name} if robot.links else set()
    for joint in robot.joints:
        if not faults and joint.parent not in known:
            faults.append(f"joint '{joint.name}' comes before its parent, or is part of a cycle")
        known.add(joint.child)
    for fault in faults:
        report("SB450", f"robot '{robot.name}': {fault}")
    return not faults


def _check_limits(robot: Robot, report: Report) -> None:
    for joint in robot.joints:
        limit, q = joint.limit, joint.drawn_position
        if not limit.lower < limit.upper:
            report(
                "SB456", f"joint '{joint.name}': lower limit {limit.lower:g} is not below upper limit {limit.upper:g}"
            )
        elif not limit.lower - _UNIT_SLACK <= q <= limit.upper + _UNIT_SLACK:
            report(
                "SB457",
                f"joint '{joint.name}': drawn position {q:g} is outside the limits {limit.lower:g} to {limit.upper:g}",
                help=("widen the limits, or set the drawn position with `zero`",),
            )
        if limit.velocity < 0.0 or limit.effort < 0.0:
            report("SB456", f"joint '{joint.name}': a limit of velocity or effort is negative")


def _check_masses(robot: Robot, report: Report, *, massless_between: bool) -> None:
    """Moving links have mass, and every inertia is physically possible."""
    heavy_below = _links_above_mass(robot) if massless_between else frozenset()
    for members in _rigid_groups(robot):
        moves = robot.base is Base.FLOATING or members[0] is not robot.root
        between = members[0].name in heavy_below and not any(link.shapes for link in members)
        if moves and not between and not any(link.mass_properties.mass > 0.0 for link in members):
            _report_massless(members, report, described=massless_between)
    points = _point_masses(robot, inf if massless_between else _SLIGHT)
    for link in robot.links:
        mass, fault = link.mass_properties.mass, inertia_fault(link.mass_properties)
        if link.name in points:
            if mass > _NEGLIGIBLE * min(points[link.name], 1.0):
                message = f"{mass:.4g} kg without inertia is taken as a point mass at its centre of mass"
                report(
                    "SB518:small-inertia",
                    f"link '{link.name}': {message}",
                    help=("give it an inertia, if it was forgotten",),
                    about=f"link '{link.name}': inertial",
                )
        elif fault:
            solids = "solids without one are open or self-intersecting: repair them in CAD"
            report(
                "SB509",
                f"link '{link.name}': {fault}",
                help=(f"correct its `inertial`; {_ASSUME if massless_between else solids}",),
                about=f"link '{link.name}': inertial",
            )


def _point_masses(robot: Robot, most: float) -> dict[str, float]:
    """Links with a mass and no inertia, frames of programs that need a mass, and what they are fixed to [kg].

    Args:
        most: Greatest share of the latter that they have.
    """
    points = dict[str, float]()
    for members in _rigid_groups(robot):
        bare = {
            link.name
            for link in members
            if link.mass_properties.mass > 0.0 and not np.any(link.mass_properties.inertia)
        }
        rest = exact_sum(link.mass_properties.mass for link in members if link.name not in bare)
        if rest > 0.0:
            points |= {name: rest for name in bare if robot.link_by_name[name].mass_properties.mass < most * rest}
    return points


def _links_above_mass(robot: Robot) -> frozenset[str]:
    """Links but the root that carry a mass below them."""
    above = set()
    for joint in reversed(robot.joints):
        if joint.child in above or robot.link_by_name[joint.child].mass_properties.mass > 0.0:
            above.add(joint.parent)
    return frozenset(above - {robot.root.name})


def _report_massless(members: list[Link], report: Report, *, described: bool) -> None:
    parts = [path for link in members for path in link.components]
    if parts:
        why = f"none of its parts, such as '{parts[0]}', encloses a volume"
        help = "give it an `inertial` with mass, com and inertia"
    elif described:
        why, help = (
            "its mass is 0",
            f"give it a mass and an inertia in the source, or fix it to another link or the world; {_ASSUME}",
        )
    else:
        why = "it has no parts"
        help = "give it parts or an `inertial`, or make it a frame of its parent link"
    report("SB508", f"link '{members[0].name}': moving link without mass: {why}", help=(help,))


def inertia_fault(properties: MassProperties) -> str:
    """Why mass [kg] and inertia [kg m^2] are physically impossible; empty if they are possible."""
    if properties.mass < 0.0:
        return f"its mass is {properties.mass:g} kg"
    if not np.abs(properties.inertia).max() <= GREATEST:
        return f"its inertia is not finite, or larger than {GREATEST:g} kg m^2"
    moments = np.linalg.eigvalsh(np.array(properties.inertia))
    if properties.mass == 0.0:
        return "it has inertia but no mass" if np.abs(moments).max() > 0.0 else ""
    words = ", ".join(f"{moment:.4g}" for moment in moments.tolist())
    if moments[0] <= 0.0:
        return f"its inertia is not positive definite: principal moments {words} kg m^2"
    if moments[2] > (moments[0] + moments[1]) * (1 + _TRIANGLE_SLACK):
        return f"one principal moment is larger than the sum of the others: {words} kg m^2"
    return ""


def _check_mimics(robot: Robot, report: Report) -> bool:
    """No joint mimics itself, directly or through others."""
    sound = True
    for joint in robot.joints:
        try:
            mimic_relation(robot, joint.name)
        except ValueError:
            report("SB458", f"joint '{joint.name}': circular mimic")
            sound = False
    return sound


def _check_closures(robot: Robot, report: Report) -> None:
    """The two sides of each closure coincide in the drawn pose."""
    for name, distance, angle in open_closures(robot):
        message = f"closure '{name}': open by {distance:.3g} m and {angle:.3g} rad in the drawn pose"
        help = "check `zero` of the joints in the loop, and the closure's origin; in an MJCF, the keyframe `home`"
        report("SB411", message, help=(help,))


def open_closures(robot: Robot) -> Iterator[tuple[str, float, float]]:
    """The closures whose sides do not meet in the drawn pose: name, distance [m], angle [rad]."""
    poses = link_poses(robot, initial_configuration(robot)) if robot.closures else {}
    for closure in robot.closures:
        distance, angle = closure_gap(closure, poses[closure.link_a], poses[closure.link_b])
        if distance > CLOSURE_DISTANCE or angle > CLOSURE_ANGLE:
            yield closure.name, distance, angle


def _check_contacts(robot: Robot, report: Report) -> None:
    """A contact sensor measures contacts of its link's collision geometry."""
    for sensor in robot.sensors:
        if sensor.kind is SensorKind.CONTACT and not robot.link_by_name[sensor.link].collisions:
            message = f"sensor '{sensor.name}': link '{sensor.link}' has no collision geometry"
            report("SB418", message, help=("give the link a `collision`, or remove the sensor",))


def _rigid_groups(robot: Robot) -> Iterator[list[Link]]:
    """Links connected by fixed joints, the one nearest to the root first."""
    groups: dict[str, list[Link]] = {}
    for link, body in rigid_bodies(robot.root.name, robot.joints).items():
        groups.setdefault(body, []).append(robot.link_by_name[link])
    yield from groups.values()


def _poses(robot: Robot) -> Iterator[tuple[str, Pose]]:
    for joint in robot.joints:
        yield f"joint '{joint.name}'", joint.X_PC
    for closure in robot.closures:
        yield f"closure '{closure.name}'", closure.X_AF
        yield f"closure '{closure.name}'", closure.X_BF
    for frame in robot.frames:
        yield f"frame '{frame.name}'", frame.X_LF
    for sensor in robot.sensors:
        yield f"sensor '{sensor.name}'", sensor.X_LS


def _numbers(robot: Robot) -> Iterator[tuple[str, list[float]]]:
    """Every number that must be finite, with its element."""
    for joint in robot.joints:
        d = joint.dynamics
        mimic = [] if joint.mimic is None else [joint.mimic.multiplier, joint.mimic.offset]
        passive = [d.damping, d.friction, d.stiffness, d.spring_reference, d.armature]
        yield f"joint '{joint.name}'", [*joint.axis, *joint.axis2, *passive, *mimic, joint.drawn_position, joint.pitch]
    for closure in robot.closures:
        yield f"closure '{closure.name}'", [*closure.axis]
    for drive in robot.actuators:
        yield f"actuator '{drive.name}'", [drive.kp, drive.kv, drive.gear]
    for sensor in robot.sensors:
        yield f"sensor '{sensor.name}'", [sensor.rate, sensor.view.fov, sensor.view.nearest]
    for link in robot.links:
        m = link.mass_properties
        yield f"link '{link.name}'", [m.mass, *np.array(m.inertia).reshape(-1).tolist()]
