"""Normalizes observations of formats that represent the same thing differently, or a missing number by another one."""

from collections.abc import Iterator, Mapping, Sequence
from math import inf, isfinite, nan, tau

import numpy as np
from msgspec.structs import replace

from stepbot.engines.observation import Observation, ObservedActuator, ObservedLink, ObservedSensor, ObservedShape
from stepbot.formats.lowering.shapes import capsule_parts
from stepbot.geometry.spatial import Pose, join_bounds
from stepbot.robot.joint_types import HINGES
from stepbot.robot.model import ActuatorKind, Mimic

from .chains import is_bare
from .shapes import plain_name
from .stand_ins import freed, with_points_of, with_surfaces_of, without_stand_ins

WORLD = "world"
"""Common name in URDF of the link that represents the world."""


def normalized(a: Observation, b: Observation) -> tuple[Observation, Observation]:
    """Both observations, normalized as far as possible.

    A massless link called ``world`` is the world. A link that is only a frame becomes a frame if the other side has no
    link of that name. Mimics refer to the first joint of their chain. Only frames and shapes that both sides name are
    kept, since formats mark different places and split shapes differently; equally many shapes without names are paired
    by their boxes; the name of the robot, and colours that one file lacks, are ignored. Initial angles are compared up
    to full turns with a file that has poses instead. Actuators are converted to their joints if a format has no gears.
    A file without any velocity limit is treated as not reporting them: MJCF has no such attribute. Numbers that mean
    unlimited become infinite, and surfaces of shapes one per link if a format has no more. Two files that one engine
    reads in one format represent everything in the same way, but for capsules, which not each version of URDF has, and
    limits that mean unlimited, which one may state.
    """
    alike = a.format == b.format and a.engine == b.engine
    a, b = (
        replace(side, joints=tuple(map(freed, side.joints))) if alike else without_stand_ins(side)
        for side in map(_without_world, (a, b))
    )
    links_a, links_b = ({link.name for link in side.links} for side in (a, b))
    a, b = _with_leaders(_with_frames(a, links_b)), _with_leaders(_with_frames(b, links_a))
    if alike:
        a, b = _with_capsules_of(a, b), _with_capsules_of(b, a)
        return _with_common_frames(a, b)
    a, b = with_points_of(a, b), with_points_of(b, a)
    a, b = with_surfaces_of(a, b), with_surfaces_of(b, a)
    a, b = _without_held_mimics(a, b), _without_held_mimics(b, a)
    a, b = _with_common_looks(_with_velocities(a), _with_velocities(b))
    a, b = (_within_a_turn(a), _within_a_turn(b)) if "usd" in (a.format, b.format) else (a, b)
    return _with_common_frames(*_with_common_views(*_with_common_gears(a, b)))


def _within_a_turn(observation: Observation) -> Observation:
    """Initial angles within one turn, whose ends are not multiples of 90 degrees, where angles often are."""
    if observation.initial is None:
        return observation
    turning = {joint.name for joint in observation.joints if joint.kind in HINGES}
    initial = {
        name: q - round((q - 0.1) / tau) * tau if name in turning else q for name, q in observation.initial.items()
    }
    return replace(observation, initial=initial)


def _without_world(observation: Observation) -> Observation:
    """A massless link called ``world`` is no link: its one fixed or floating joint states how the base is held."""
    joints = [joint for joint in observation.joints if joint.parent == WORLD]
    world = [link for link in observation.links if link.name == WORLD and is_bare(link)]
    if not world or len(joints) != 1 or joints[0].kind not in ("fixed", "floating"):
        return observation
    root = joints[0].child
    poses = []
    for X_W in observation.poses:
        X_RW = X_W[root].inverse()
        poses.append({link: X_RW @ X for link, X in X_W.items() if link != WORLD})
    return replace(
        observation,
        base=joints[0].kind,
        links=tuple(link for link in observation.links if link.name != WORLD),
        joints=tuple(joint for joint in observation.joints if joint.parent != WORLD),
        poses=tuple(poses),
    )


def _with_frames(observation: Observation, links: set[str]) -> Observation:
    """Links without mass and shape at the end of a fixed joint are URDF's frames, unless they are among ``links``."""
    parents = {joint.parent for joint in observation.joints}
    bare = {link.name for link in observation.links if is_bare(link)} - parents - links
    mounts = {
        joint.child: joint.parent for joint in observation.joints if joint.kind == "fixed" and joint.child in bare
    }
    if not mounts or not observation.poses:
        return observation
    X_W = observation.poses[0]
    frames = {name: (parent, X_W[parent].inverse() @ X_W[name]) for name, parent in mounts.items()}
    return replace(
        observation,
        links=tuple(link for link in observation.links if link.name not in mounts),
        joints=tuple(joint for joint in observation.joints if joint.child not in mounts),
        poses=tuple({link: X for link, X in poses.items() if link not in mounts} for poses in observation.poses),
        frames={**(observation.frames or {}), **frames},
        sensors=None
        if observation.sensors is None
        else tuple(_on_link(sensor, frames) for sensor in observation.sensors),
    )


def _on_link(sensor: ObservedSensor, frames: Mapping[str, tuple[str, Pose]]) -> ObservedSensor:
    """A sensor with its pose on the link that its frame is on."""
    if sensor.link is None or sensor.link not in frames:
        return sensor
    link, X_LF = frames[sensor.link]
    return replace(sensor, link=link, X_LS=None if sensor.X_LS is None else X_LF @ sensor.X_LS)


def _with_leaders(observation: Observation) -> Observation:
    """Every mimic relative to a joint that is not a mimic: not every format and reader supports chains."""
    mimics = {joint.name: joint.mimic for joint in observation.joints if joint.mimic is not None}

    def led(mimic: Mimic) -> Mimic:
        for _ in mimics:
            above = mimics.get(mimic.joint)
            if above is None:
                return mimic
            offset = mimic.multiplier * above.offset + mimic.offset
            mimic = Mimic(above.joint, mimic.multiplier * above.multiplier, offset)
        return mimic  # a cycle: cannot be resolved

    joints = tuple(
        joint if joint.mimic is None else replace(joint, mimic=led(joint.mimic)) for joint in observation.joints
    )
    return replace(observation, joints=joints)


def _without_held_mimics(a: Observation, b: Observation) -> Observation:
    """Without mimics that stand for loops which the other side closes: a format without loops has nothing else."""
    if a.closures or not b.closures:
        return a
    free = {joint.child for joint in b.joints if joint.mimic is None}
    above = {joint.child: joint.parent for joint in b.joints}
    held = set[str]()
    for closure in b.closures:
        ways = [set(_way_up(link, above)) for link in (closure.link_a, closure.link_b)]
        held |= (ways[0] ^ ways[1]) & free
    joints = (replace(joint, mimic=None, mimic_read=False) if joint.child in held else joint for joint in a.joints)
    return replace(a, joints=tuple(joints))


def _way_up(link: str, above: Mapping[str, str]) -> Iterator[str]:
    """A link and those above it."""
    yield link
    while link in above:
        link = above[link]
        yield link


def _with_common_looks(a: Observation, b: Observation) -> tuple[Observation, Observation]:
    """Both without the name of the robot, with common shapes only, and with colours that both give.

    The ambient colour is the diffuse one if a format has only one.
    """
    theirs = {link.name: link for link in b.links}
    ours, others = dict[str, ObservedLink](), dict[str, ObservedLink]()
    for link in a.links:
        other = theirs.get(link.name)
        if other is not None:
            visuals = _common_shapes(link.visuals, other.visuals, link.name)
            collisions = _common_shapes(link.collisions, other.collisions, link.name)
            ours[link.name], others[link.name] = (
                replace(one, visuals=visuals[i], collisions=collisions[i]) for i, one in enumerate((link, other))
            )
    return (
        replace(a, name=None, links=tuple(ours.get(link.name, link) for link in a.links)),
        replace(b, name=None, links=tuple(others.get(link.name, link) for link in b.links)),
    )


Shapes = tuple[ObservedShape, ...] | None
Named = dict[str, ObservedShape]


def _common_shapes(a: Shapes, b: Shapes, link: str) -> tuple[Shapes, Shapes]:
    names = [[plain_name(shape.name, link) for shape in side or () if shape.name] for side in (a, b)]
    of = link if all(len(set(some)) == len(some) for some in names) else ""  # one name may be another with the link's
    ours, theirs = (
        {
            plain: replace(shape, name=plain)
            for shape in side or ()
            if shape.name and (plain := plain_name(shape.name, of))
        }
        for side in (a, b)
    )
    ours, theirs = _with_whole_capsules(ours, theirs), _with_whole_capsules(theirs, ours)
    pairs = [_same_looks(ours[name], theirs[name]) for name in ours if name in theirs]
    if a and b and len(a) == len(b) and not (ours and theirs):
        pairs = [_same_looks(replace(x, name=""), replace(y, name="")) for x, y in _by_box(a, b)]
    if not pairs:
        return None, None
    return tuple(one for one, _ in pairs), tuple(other for _, other in pairs)


def _with_capsules_of(a: Observation, b: Observation) -> Observation:
    """The observation ``a`` with one shape in place of the three that it has for a capsule of ``b``."""
    theirs = {link.name: link for link in b.links}

    def whole(shapes: Shapes, others: Shapes) -> Shapes:
        named = {shape.name: shape for shape in shapes or () if shape.name}
        wanted = {other.name: other for other in others or () if other.name} or _capsules(named, others or ())
        capsules = {capsule_parts(name)[0]: name for name in wanted if name not in named}
        split = {part for name in capsules.values() for part in capsule_parts(name)}
        if shapes is None or not split & set(named):
            return shapes
        by_name = _with_whole_capsules(named, wanted)
        kept = (by_name[capsules.get(shape.name, shape.name)] if shape.name in capsules else shape for shape in shapes)
        return tuple(one for one in kept if one.name not in split)

    links = (
        replace(
            link,
            visuals=whole(link.visuals, theirs[link.name].visuals),
            collisions=whole(link.collisions, theirs[link.name].collisions),
        )
        if link.name in theirs
        else link
        for link in a.links
    )
    return replace(a, links=tuple(links))


def _capsules(shapes: Named, others: Sequence[ObservedShape]) -> Named:
    """The shapes named as three parts of a capsule, under its name; none unless as many are left as the others are."""
    middles = {capsule_parts(name)[0]: name for name in (part.removesuffix("_middle") for part in shapes)}
    split = {name: shapes[part] for part, name in middles.items() if set(capsule_parts(name)) <= set(shapes)}
    return split if len(shapes) - 2 * len(split) == len(others) else {}


def _with_whole_capsules(shapes: Mapping[str, ObservedShape], others: Mapping[str, ObservedShape]) -> Named:
    """The shapes with one in place of the three that a format without capsules has for a capsule of the other side."""
    whole = dict(shapes)
    for name in (name for name in others if name not in shapes):
        parts = [shapes[part] for part in capsule_parts(name) if part in shapes]
        if len(parts) == len(capsule_parts(name)):
            whole[name] = replace(joined(parts), name=name)
    return whole


def joined(parts: Sequence[ObservedShape]) -> ObservedShape:
    """The first of several shapes with the box of all; its colour is none that compares as equal if theirs differ."""
    color = parts[0].rgba if len({part.rgba for part in parts}) == 1 else (nan,) * 4
    boxes = ([getattr(part, box) for part in parts] for box in ("bounds", "oblique"))
    upright, oblique = (join_bounds(box) if None not in box else None for box in boxes)
    return replace(parts[0], rgba=color, bounds=upright, oblique=oblique)


def _by_box(a: Sequence[ObservedShape], b: Sequence[ObservedShape]) -> Iterator[tuple[ObservedShape, ObservedShape]]:
    """Pairs of shapes whose boxes are nearest; those without a box are paired in the order of the files."""
    left = list(b)
    for shape in a:
        apart = [_apart(shape, other) for other in left]
        yield shape, left.pop(apart.index(min(apart)))


def _apart(a: ObservedShape, b: ObservedShape) -> float:
    if a.bounds is None or b.bounds is None:
        return 0.0 if a.bounds is b.bounds else inf
    return float(np.abs(np.subtract(a.bounds, b.bounds)).max())


def _same_looks(a: ObservedShape, b: ObservedShape) -> tuple[ObservedShape, ObservedShape]:
    shapes = [
        replace(shape, name=plain_name(shape.name or ""), rgba=shape.rgba or None, ambient=shape.ambient or shape.rgba)
        for shape in (a, b)
    ]
    if shapes[0].rgba is None or shapes[1].rgba is None:
        shapes = [replace(shape, rgba=None, ambient=None) for shape in shapes]
    return shapes[0], shapes[1]


def _with_common_gears(a: Observation, b: Observation) -> tuple[Observation, Observation]:
    """Both with actuators at their joints, if one of the formats has no gears."""
    sides = a, b
    if all(drive.gear is not None for side in sides for drive in side.actuators or ()):
        return sides
    a, b = (replace(side, actuators=side.actuators and tuple(map(_at_joint, side.actuators))) for side in sides)
    return a, b


def _with_common_views(a: Observation, b: Observation) -> tuple[Observation, Observation]:
    """Both without the range of sensors that is unlimited in one file: some formats require a number."""
    endless = {sensor.name for side in (a, b) for sensor in side.sensors or () if sensor.farthest == inf}
    a, b = (
        side
        if side.sensors is None
        else replace(
            side,
            sensors=tuple(
                replace(sensor, farthest=None) if sensor.name in endless else sensor for sensor in side.sensors
            ),
        )
        for side in (a, b)
    )
    return a, b


def _at_joint(drive: ObservedActuator) -> ObservedActuator:
    """An actuator with its gains and bounds at the joint."""
    gear = drive.gear
    if gear is None or not gear:
        return drive
    scale = gear if drive.kind == ActuatorKind.MOTOR else 1.0 / gear
    return replace(
        drive,
        gear=None,
        kp=None if drive.kp is None else drive.kp * gear**2,
        kv=None if drive.kv is None else drive.kv * gear**2,
        control=_scaled(drive.control, scale),
        force=_scaled(drive.force, gear),
    )


def _scaled(bounds: tuple[float, float] | None, factor: float) -> tuple[float, float] | None:
    if bounds is None:
        return None
    low, high = sorted(bound * factor for bound in bounds)
    return low, high


def _with_velocities(observation: Observation) -> Observation:
    if observation.format != "mjcf" or any(j.limit and isfinite(j.limit.velocity) for j in observation.joints):
        return observation
    joints = tuple(
        replace(joint, limit_fields=tuple(field for field in joint.limit_fields if field != "velocity"))
        for joint in observation.joints
    )
    return replace(observation, joints=joints)


def _with_common_frames(a: Observation, b: Observation) -> tuple[Observation, Observation]:
    if a.frames is None or b.frames is None:
        return replace(a, frames=None), replace(b, frames=None)
    names = [name for name in a.frames if name in b.frames]
    return _with_only(a, names), _with_only(b, names)


def _with_only(observation: Observation, names: list[str]) -> Observation:
    known = observation.frames or {}
    return replace(observation, frames={name: known[name] for name in names})
