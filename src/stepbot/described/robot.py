"""The robot of a URDF, SDFormat or MJCF file, as the file describes it.

A body that MJCF moves by several joints, or by a joint beside its origin, gets links without shape in between. What the
model cannot hold is listed, never left out in silence.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import PurePosixPath
from urllib.parse import unquote

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines.description import DescribedShape, Description
from stepbot.engines.observation import Observation, ObservedClosure, ObservedLink, Quantity
from stepbot.formats.lowering.masses import LEAST_MOMENT
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.primitives import half_size
from stepbot.geometry.spatial import ZERO3, ZERO33, Array, Pose, perpendicular_frame, tidy
from stepbot.robot.inertial_doubts import GREATEST
from stepbot.robot.kinematics import initial_configuration, link_poses, neighbours, without_contacts
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.mesh_names import UniqueNames, ascii_name, free_name, is_device, valid_name
from stepbot.robot.model import (
    GREY,
    Base,
    Collision,
    Frame,
    Geometry,
    JointKind,
    Link,
    LoopClosure,
    MeshAsset,
    MeshRef,
    Robot,
    Visual,
)
from stepbot.robot.renaming import NewNames, renamed

from .devices import actuators_of, sensors_of
from .finding import CHANGED_INERTIA, LOST, REARRANGED, RENAMED, UNSUPPORTED, Finding
from .tree import at_initial, surroundings_of, tree_of, with_locked_fixed, without_broken_mimics, without_links


class Shapes:
    """The shapes of all links."""

    def __init__(self, description: Description, *, drawn: bool) -> None:
        self._shown = description.seen if drawn else [shape for shape in description.shapes if not shape.collides]
        self._solid = [shape for shape in description.shapes if shape.collides]
        self._meshes = UniqueNames()
        self._assets: dict[int, tuple[TriMesh, MeshAsset]] = {}
        self._visual_names = set[str]()
        """Taken by all links: URDF and PyBullet name colours by them."""
        self.pieces = dict[str, str]()
        """For each visual the first one of the same visual in the file, whose mesh has several colours."""

    @property
    def assets(self) -> tuple[MeshAsset, ...]:
        """All meshes that were used so far, sorted by name."""
        return tuple(sorted((asset for _, asset in self._assets.values()), key=lambda asset: asset.name))

    def visuals(self, link: str) -> tuple[Visual, ...]:
        """The visuals of a link; for a picture its collisions if it has none."""
        name, first = _namer(link, "visual", self._visual_names), ""
        visuals = []
        for shape in (one for one in self._shown if one.link == link):
            visual = Visual(name(shape), self._geometry(shape), shape.X_LG, shape.rgba or GREY)
            first = self.pieces[visual.name] = first if shape.piece else visual.name
            visuals.append(visual)
        return tuple(visuals)

    def collisions(self, link: str) -> tuple[Collision, ...]:
        """The collisions of a link."""
        name = _namer(link, "collision", set())
        return tuple(
            Collision(name(shape), self._geometry(shape), shape.X_LG, shape.surface)
            for shape in self._solid
            if shape.link == link
        )

    def _geometry(self, shape: DescribedShape) -> Geometry:
        """A primitive, or the asset of a mesh; equal objects are one."""
        mesh = shape.geometry
        if not isinstance(mesh, TriMesh):
            return mesh
        if id(mesh) not in self._assets:
            stem = PurePosixPath(unquote(shape.mesh.replace("\\", "/"))).stem
            name = self._meshes.unique(ascii_name(stem or shape.name or shape.link))
            self._assets[id(mesh)] = mesh, MeshAsset(name, mesh, shape.mesh)
        return MeshRef(self._assets[id(mesh)][1].name)


def _namer(link: str, kind: str, taken: set[str]) -> Callable[[DescribedShape], str]:
    """Valid names of the shapes of a link: those that they have, with the link's where one is taken."""
    suffix = f"_{valid_name(link, 'link')}"
    return lambda shape: free_name(valid_name(shape.name or f"{link}_{kind}", kind), suffix, taken)


_INVALID_IN_FILES = re.compile(r"[\\:*?|]+")


def valid_file_name(name: str) -> str:
    """A name that is a valid file name on every system, too."""
    valid = _INVALID_IN_FILES.sub("_", valid_name(name, "robot")).strip(". ")[:100].strip(". ") or "robot"
    return f"{valid}_robot" if is_device(valid) else valid


def with_valid_names(robot: Robot, findings: list[Finding]) -> tuple[Robot, NewNames]:
    """The robot with valid names, unique within their kind, and the new names."""
    taken: set[str] = set()
    links = _renamed((link.name for link in robot.links), "link", taken)
    frames = _renamed((frame.name for frame in robot.frames), "frame", taken)
    taken = set()
    joints = _renamed((joint.name for joint in robot.joints), "joint", taken)
    closures = _renamed((closure.name for closure in robot.closures), "closure", taken)
    actuators = _renamed((actuator.name for actuator in robot.actuators), "actuator", set())
    sensors = _renamed((sensor.name for sensor in robot.sensors), "sensor", set())
    name = valid_file_name(robot.name)
    maps = (links, joints, frames, closures, actuators, sensors)
    for kind, of_kind in zip(("link", "joint", "frame", "closure", "actuator", "sensor"), maps, strict=True):
        for old, new in of_kind.items():
            if old != new:
                findings.append(Finding(RENAMED, f"{kind} '{old}' is renamed to '{new}'"))
    if name != robot.name:
        findings.append(Finding(RENAMED, f"robot '{robot.name}' is renamed to '{name}'"))
    with_names = renamed(
        replace(robot, name=name),
        link=links.__getitem__,
        joint=joints.__getitem__,
        closure=closures.__getitem__,
        frame=frames.__getitem__,
        actuator=actuators.__getitem__,
        sensor=sensors.__getitem__,
    )
    changes = ({old: new for old, new in of_kind.items() if old != new} for of_kind in (links, joints, frames))
    return with_names, NewNames(*changes)


def _renamed(names: Iterable[str], kind: str, taken: set[str]) -> dict[str, str]:
    return {name: free_name(valid_name(name, kind), f"_{kind}", taken) for name in names}


def closures_of(seen: Iterable[ObservedClosure], links: set[str], findings: list[Finding]) -> Iterator[LoopClosure]:
    """The closures; those of other kinds are listed."""
    for number, one in enumerate(seen, start=1):
        name = one.name or f"closure {number}"
        kind = JointKind(one.kind) if one.kind in set(JointKind) else None
        X_AF, X_BF, axis = one.X_AF, one.X_BF, one.axis or (0.0, 0.0, 1.0)
        if kind is None and one.X_AF is None and one.points is not None:  # a `connect` of MuJoCo
            kind = JointKind.BALL if one.axes is None else JointKind.REVOLUTE
            directions = one.axes or (axis, axis)
            X_AF, X_BF = (Pose.of(perpendicular_frame(d), p) for d, p in zip(directions, one.points, strict=True))
            axis = (0.0, 0.0, 1.0)
        if (
            kind is None
            or not (kind.closes or kind.is_hinge)
            or X_AF is None
            or X_BF is None
            or not {one.link_a, one.link_b} <= links
        ):
            findings.append(
                Finding(
                    UNSUPPORTED,
                    f"closure '{name}' of type '{one.kind}' between '{one.link_a}' and '{one.link_b}' is not supported",
                )
            )
            continue
        yield LoopClosure(name, kind, one.link_a, X_AF, one.link_b, X_BF, axis)


_WORLD = "world"
_BASES = {JointKind.FIXED: Base.FIXED, JointKind.FLOATING: Base.FLOATING}
"""The base that a joint on the world makes."""
_ROUNDED = 1e-9
"""Share of the largest principal moment up to which the least one may be the rounding of 0."""


class DescribedRobot(Struct, frozen=True):
    """A robot, and where it differs from its file."""

    robot: Robot
    findings: tuple[Finding, ...]
    is_base_known: bool
    """Whether the file states if its base is fixed: a URDF only by a root link ``world``."""
    names: NewNames
    """New names of links, joints and frames that cannot keep theirs."""
    pieces: Mapping[str, str]
    """For each visual the first one of the same visual in the file, whose mesh has several colours."""
    surroundings: frozenset[str]
    """Links of the file that are not part of the robot."""

    def of_robot(self, observation: Observation) -> Observation:
        """What an engine reports about the file, without the surroundings."""
        return observation.without(self.surroundings, self.robot.base) if self.surroundings else observation

    @property
    def missing(self) -> tuple[str, ...]:
        """What a picture of the robot lacks, or shows otherwise."""
        return tuple(finding.text for finding in self.findings if finding.code == UNSUPPORTED)


def _unread_mesh(uri: str) -> Finding:
    remedy = "put it where the file names it, as STL, OBJ, PLY, Collada or glTF"
    if "$(" in uri or "${" in uri:
        expand = "name the file .xacro, and pass its arguments with `--xacro NAME:=VALUE`"
        remedy = f"the name has a substitution of xacro: {expand}"
    elif "://" in uri:
        remedy = "name the folder of the package: `--package-path DIR`; the mesh must be STL, OBJ, PLY, Collada or glTF"
    return Finding(UNSUPPORTED, f"mesh '{uri}' is missing or of an unsupported type", help=(remedy,))


def robot_of_description(
    description: Description, name: str, source: str, base: Base | None = None, *, drawn: bool = False
) -> DescribedRobot:
    """The robot of a description with at least one link.

    Args:
        name: Name of the robot if the file has none.
        base: Whether the base is fixed, for files that do not tell; None for the default, fixed.
        drawn: Whether the robot is for a picture, in which a link without visuals shows its collisions.
    """
    around = frozenset[str]() if drawn else surroundings_of(description)
    description = without_links(description, around)
    seen = description.observation
    loose = "is not connected to the robot, and has no joints: not converted"
    findings = [Finding(LOST, f"link '{link}' {loose}") for link in sorted(around)]
    findings += [_unread_mesh(uri) for uri in description.unread]
    findings += [Finding(UNSUPPORTED, text) for text in description.unsupported]
    shapes = Shapes(_with_volume(description, findings), drawn=drawn)
    links = {link.name: _link(link, shapes, findings) for link in seen.links}
    joints, extra = tree_of(description, findings)
    root = joints[0].parent if joints else next(iter(links))
    order = [root, *(joint.child for joint in joints)]
    kept = without_broken_mimics(with_locked_fixed(joints, seen.format == "urdf", findings), findings)
    robot = Robot(
        seen.name or name,
        tuple(links.get(one) or extra[one] for one in order),
        kept,
        tuple(closures_of(seen.closures or (), set(links), findings)),
        tuple(Frame(one, link, X_LF) for one, (link, X_LF) in (seen.frames or {}).items() if link in links),
        actuators_of(description, {joint.name: joint for joint in kept}, findings),
        shapes.assets,
        base or Base.FIXED if seen.base is None else Base(seen.base),
        source,
        sensors_of(seen.sensors or (), kept, set(links), findings),
        description.simulation,
    )
    robot = replace(robot, excluded_contacts=_excluded(robot, seen))
    _report_contacts(robot, seen, findings)
    rooted = _without_world(robot, findings)
    _report_place(rooted, description.X_WR, findings)
    known = seen.base is not None or robot.root.name == _WORLD  # which may have several joints, or one that moves
    placed = at_initial(share_meshes(rooted), seen.initial or {}, None if drawn else findings)
    robot, names = with_valid_names(_with_turned_balls(placed), findings)
    return DescribedRobot(robot, tuple(findings), known, names, shapes.pieces, around)


def _with_volume(description: Description, findings: list[Finding]) -> Description:
    """The description without primitives of size 0 or less, which engines reject; lists approximated shapes, too."""
    kept = []
    for shape in description.shapes:
        if shape.approximated:
            kind = "collision" if shape.collides else "visual"
            text = f"link '{shape.link}': {kind} with {shape.approximated}: approximated by a mesh"
            findings.append(Finding(LOST, text, (Quantity.MESHES,)))
        if isinstance(shape.geometry, TriMesh) or min(half_size(shape.geometry)) > 0.0:
            kept.append(shape)
            continue
        kind, form = "collision" if shape.collides else "visual", type(shape.geometry).__name__.lower()
        text = f"link '{shape.link}': {kind} with a {form} without volume: not converted"
        findings.append(Finding(LOST, text, (Quantity.SHAPES, Quantity.MESHES)))
    return replace(description, shapes=tuple(kept))


def _with_turned_balls(robot: Robot) -> Robot:
    """The robot with both frames of a ball closure parallel in the drawn pose.

    Their orientations have no effect in MJCF. A joint of SDFormat has one frame for both links.
    """
    balls = [closure for closure in robot.closures if closure.kind is JointKind.BALL]
    X = link_poses(robot, initial_configuration(robot)) if balls else {}
    turned = {
        ball.name: replace(
            ball, X_AF=tidy(Pose.of((X[ball.link_a].inverse() @ X[ball.link_b] @ ball.X_BF).R, ball.X_AF.p))
        )
        for ball in balls
    }
    return replace(robot, closures=tuple(turned.get(closure.name, closure) for closure in robot.closures))


def _link(link: ObservedLink, shapes: Shapes, findings: list[Finding]) -> Link:
    mass, text, inertia = MassProperties(), "", np.array(link.inertia or ZERO33)
    if link.mass:
        added = _least_moment_of(inertia)
        if added:
            least = max(float(np.linalg.eigvalsh(inertia)[0]), 0.0)
            text = f"link '{link.name}': principal moment of {least:g} kg m^2: {added:g} added about each axis"
            inertia = inertia + added * np.eye(3)
        mass = MassProperties.of(link.mass, link.com or ZERO3, inertia)
    elif np.any(inertia):
        text = f"link '{link.name}': inertia without mass is not converted"
    if text:
        changed = (Quantity.INERTIA, Quantity.MASS_MATRIX, Quantity.INVERSE_DYNAMICS)
        findings.append(Finding(CHANGED_INERTIA, text, changed))
    return Link(link.name, mass, shapes.visuals(link.name), shapes.collisions(link.name))


def _least_moment_of(inertia: Array) -> float:
    """What engines need about each axis [kg m^2] of what is nearly a point, or a rod without thickness; else 0."""
    largest_entry = float(np.abs(inertia).max())
    if not 0.0 < largest_entry <= GREATEST:  # validation rejects those that are not finite
        return 0.0
    least, middle, largest = np.linalg.eigvalsh(inertia).tolist()
    rounding = _ROUNDED * largest
    if rounding < least < LEAST_MOMENT:
        return LEAST_MOMENT
    is_rod = abs(least) <= 1e-3 * rounding and largest - middle <= rounding
    return max(LEAST_MOMENT, 2.0 * rounding) if is_rod else 0.0


def _without_world(robot: Robot, findings: list[Finding]) -> Robot:
    """A bare root link called ``world`` above one fixed or floating joint is the world: the link below is the root."""
    below = [joint for joint in robot.joints if joint.parent == robot.root.name]
    root, first = robot.root, robot.joints[0] if robot.joints else None
    bare = not (root.mass_properties.mass or root.visuals or root.collisions)
    if root.name != _WORLD or not bare or first is None or len(below) != 1 or first.kind not in _BASES:
        return robot
    held = {link for closure in robot.closures for link in (closure.link_a, closure.link_b)}
    if root.name in held.union(frame.link for frame in robot.frames):
        return robot
    below_world = replace(robot, links=robot.links[1:], joints=robot.joints[1:], base=_BASES[first.kind])
    _report_place(below_world, first.X_PC, findings)
    return below_world


def _excluded(robot: Robot, observation: Observation) -> tuple[tuple[str, str], ...]:
    """Pairs of links that are not adjacent whose contacts the file excludes."""
    ours = without_contacts(robot)
    return tuple(sorted(pair for pair in observation.excluded_pairs or () if frozenset(pair) not in ours))


def _report_contacts(robot: Robot, observation: Observation, findings: list[Finding]) -> None:
    """Adjacent links that collide in the file, and links that have shapes there alone.

    In MuJoCo, a base that is fixed to the world collides with the links next to it, and the world of a file may have
    shapes of its own.
    """
    if observation.excluded_pairs is None:
        return
    solid = {link.name for link in robot.links if link.collisions}
    kept = {frozenset(pair) for pair in observation.excluded_pairs}
    pairs = sorted(tuple(sorted(pair)) for pair in neighbours(robot) - kept if pair <= solid)
    if pairs:
        links = ", ".join(f"'{a}' and '{b}'" for a, b in pairs)
        text = f"contacts between adjacent links, which the written files exclude: {links}"
        findings.append(Finding(LOST, text, (Quantity.CONTACTS,)))
    bare = sorted({link for pair in observation.excluded_pairs for link in pair} - solid)
    if bare:
        links = ", ".join(f"'{link}'" for link in bare)
        text = f"contacts with shapes that are not converted, of links {links}"
        findings.append(Finding(LOST, text, (Quantity.CONTACTS,)))


def _report_place(robot: Robot, X_WR: Pose, findings: list[Finding]) -> None:
    """The pose of the root in the world of the file; a floating robot stands on the floor wherever it is."""
    (x, y, z), (roll, pitch, yaw) = X_WR.position, X_WR.rpy
    if X_WR.is_identity or (robot.base is Base.FLOATING and not (x or y or roll or pitch or yaw)):
        return
    where = f"({x:g}, {y:g}, {z:g}) m, turned by ({roll:g}, {pitch:g}, {yaw:g}) rad"
    text = f"link '{robot.root.name}': the root's place in the world is not kept: {where}"
    if roll or pitch:
        held = robot.base is Base.FIXED
        effect = "gravity acts in another direction of the robot" if held else "the robot starts upright"
        findings.append(Finding(LOST, f"{text}; {effect}", (Quantity.GRAVITY, Quantity.INVERSE_DYNAMICS)))
        return
    findings.append(Finding(REARRANGED, text))
