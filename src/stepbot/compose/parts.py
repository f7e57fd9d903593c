"""A module as it enters the composition: without what is left out, mirrored, in its initial pose, with its prefix."""

import re
from collections.abc import Mapping
from fnmatch import fnmatchcase
from math import atan2, radians

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, did_you_mean, listed
from stepbot.geometry.spatial import Pose, dot, perpendicular_frame, rotated, rotation_about
from stepbot.robot.kinematics import initial_configuration, link_poses, within_limits
from stepbot.robot.model import JointKind, LoopClosure, Module, Robot
from stepbot.robot.posing import NotReached, coordinates, leader_of, posed
from stepbot.robot.renaming import KINDS, renamed
from stepbot.sidecar.document import Document
from stepbot.sidecar.joint_settings import position_dimension
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.modules import ModuleSection
from stepbot.sidecar.unit_rules import check_unit

from .mirroring import flipped, mirrored, unsymmetric
from .pruning import StillFollowed, elements, without

_SIDES = ("left", "right")
_MOST_LISTED = 6
_FEWEST_DEGREES = 6.0
"""Angle without a unit above which degrees are offered."""


class Part(Struct, frozen=True):
    """A robot that becomes a part of another one."""

    robot: Robot
    """With the names that it has in the composed robot."""
    prefix: str
    """Text in front of the names that it has in its own file."""
    file: str
    """Name of the file that it comes from; empty for the own links of the composing file."""
    mirror: str = ""
    """Normals of the planes that it is mirrored through: one, two for the image of an image, or none."""

    def written(self, path: str) -> str:
        """The name in the composed robot of an element by its path in the part: ``tcp``, ``hand/tcp``, ``hand``."""
        return named(self.robot, path, self.prefix)

    def local(self, name: str) -> str:
        """The path in the part's own file of one of its elements."""
        inner = [
            module for module in self.robot.modules if module.prefix != self.prefix and name.startswith(module.prefix)
        ]
        if not inner:
            return name.removeprefix(self.prefix)
        deepest = max(inner, key=lambda one: len(one.prefix))
        return f"{deepest.name}/{name.removeprefix(deepest.prefix)}"


def named(robot: Robot, path: str, prefix: str = "") -> str:
    """The name in a robot of an element by its path: ``tcp``, ``hand/tcp``, or ``hand``, its module's root link.

    Args:
        robot: The robot, perhaps with a prefix in front of all names.
        path: The path in the file of the robot.
        prefix: That prefix.
    """
    by_name = {module.name: module for module in robot.modules}
    if path in by_name:
        return by_name[path].links[0]
    inner, _, name = path.rpartition("/")
    if inner and inner not in by_name:
        return path  # no name has a slash
    return (by_name[inner].prefix if inner else prefix) + name


class Parts:
    """Makes each module of a sidecar a part.

    Args:
        sidecar: The composing file.
        robots: The robot of each module that names a file, as it is alone.
        diagnostics: Receives SB158 and SB160.
    """

    def __init__(self, sidecar: Sidecar, robots: Mapping[str, Robot], diagnostics: Diagnostics) -> None:
        self._sidecar, self._robots, self._diagnostics = sidecar, robots, diagnostics
        self._sections = sidecar.document.modules
        self._originals: dict[str, Robot] = {}

    def all(self) -> dict[str, Part]:
        """The parts by module name, without those that have errors."""
        parts = {name: self._part(name, section) for name, section in self._sections.items()}
        return {name: part for name, part in parts.items() if part is not None}

    def _part(self, name: str, section: ModuleSection) -> Part | None:
        original = section.mirror_of
        robot = self._original(original or name)
        if robot is None:
            return None
        if original:
            robot = self._mirrored(name, robot, section.mirror or "y", section)
            robot = self._home(name, self._without(name, robot, section.without), section)
        prefix = f"{name}_" if section.prefix is None else section.prefix
        return Part(_with_prefix(robot, prefix), prefix, robot.source, self._planes(section))

    def _original(self, name: str) -> Robot | None:
        """The robot of a module that names a file, mirrored if it states a plane."""
        if name not in self._originals and name in self._robots:
            section = self._sections[name]
            robot = self._home(name, self._without(name, self._robots[name], section.without), section)
            if section.mirror:
                robot = self._mirrored(name, robot, section.mirror, section)
            self._originals[name] = robot
        return self._originals.get(name)

    def _planes(self, section: ModuleSection) -> str:
        """The normals of the planes that a module is mirrored through; two reflections through one cancel."""
        if not section.mirror_of:
            return section.mirror or ""
        planes = {section.mirror or "y"} ^ set(self._sections[section.mirror_of].mirror or "")
        return "".join(sorted(planes))

    def _without(self, name: str, robot: Robot, names: tuple[str, ...]) -> Robot:
        known = {one.name for kind in elements(robot).values() for one in kind} - {robot.root.name}
        gone = [named(robot, one) for one in names]
        for index, (one, element) in enumerate(zip(names, gone, strict=True)):
            if element not in known:
                what = "is the root link" if element == robot.root.name else "no such link, joint, frame or device"
                self._unknown(name, ("without", index), one, what, sorted(known))
        try:
            return without(robot, known.intersection(gone))
        except StillFollowed as followed:
            message = (
                f"module '{name}': without: joint '{followed.joint}' mimics '{followed.leader}', which is left out"
            )
            help = [f"leave out '{followed.joint}' as well"]
            self._diagnostics.add("SB160", message, self._sidecar.span("modules", name, "without"), help=help)
            return robot

    def _home(self, name: str, robot: Robot, section: ModuleSection) -> Robot:
        """The robot in the pose of `home`; mimics follow, and loops stay closed."""
        if not section.home:
            return robot
        known, given = coordinates(robot), {}
        for path, position in section.home.items():
            keys, joint = ("home", path), named(robot, path)
            if joint not in known:
                self._unknown(name, keys, path, "no such moving joint", list(known))
                continue
            kind = known[joint].kind
            needed, who = position_dimension(kind), f"module '{name}': home"
            if needed is not None:
                check_unit(
                    self._sidecar, who, kind, position.dimension, needed, ("modules", name, *keys), self._diagnostics
                )
            if leader_of(robot, joint) != joint:
                help = [f"set '{leader_of(robot, joint)}', which it follows"]
                self._wrong_home(name, keys, f"joint '{joint}' is a mimic", help)
            else:
                given[joint] = position.value
        try:
            pose = posed(robot, given)
        except NotReached as end:
            reached = ", ".join(f"'{joint}' at {q:g}" for joint, q in end.reached.items())
            help = ["give the driven joints alone; those that loops move follow from them"]
            self._wrong_home(name, ("home",), f"the loops do not close there; the nearest pose has {reached}", help)
            return robot
        moved = replace(
            robot, joints=tuple(replace(j, drawn_position=pose.get(j.name, j.drawn_position)) for j in robot.joints)
        )
        at = link_poses(moved, initial_configuration(moved)) if moved.closures else {}
        closures = (
            coinciding(closure, at[closure.link_a].inverse() @ at[closure.link_b]) for closure in moved.closures
        )
        moved = replace(moved, closures=tuple(closures))
        if not within_limits(moved, pose):
            limits = {joint: (q, known[joint].limit) for joint, q in given.items()}
            beyond = {joint: one for joint, one in limits.items() if not one[1].lower <= one[0] <= one[1].upper}
            outside = [
                f"'{joint}' at {q:g} ({one.lower:g} to {one.upper:g})" for joint, (q, one) in (beyond or limits).items()
            ]
            help = ["choose positions within the limits"]
            in_degrees = [joint for joint, (q, one) in beyond.items() if one.lower <= radians(q) <= one.upper]
            if in_degrees and abs(given[in_degrees[0]]) > _FEWEST_DEGREES:
                help.append(f"angles without a unit are radians: `{in_degrees[0]}: {given[in_degrees[0]]:g} deg`")
            self._wrong_home(name, ("home",), f"outside the limits of a joint: {', '.join(outside)}", help)
        return moved

    def _mirrored(self, name: str, robot: Robot, normal: str, section: ModuleSection) -> Robot:
        image = mirrored(robot, normal)
        names = [joint.name for joint in robot.joints]
        original = section.mirror_of or ""
        above = [image_name(joint, original, name) for joint in joints_above(self._sidecar.document, original)]
        for index, pattern in enumerate(section.flip):
            if flipped(image, [pattern]).joints == image.joints and not any(
                fnmatchcase(joint, pattern) for joint in above
            ):
                self._unknown(name, ("flip", index), pattern, "matches no joint that moves", names)
        image = flipped(image, section.flip)
        if len(self._planes(section)) != 1:  # the image of an image is the shape of the file
            return image
        span = self._sidecar.key_span("modules", name)
        threads = [joint.name for joint in robot.joints if joint.pitch]
        if threads:
            message = f"module '{name}': mirrored threads are left-handed: {listed(threads, _MOST_LISTED)}"
            help = ["describe the joint in the composing file if the spindle is a bought one"]
            self._diagnostics.add("SB158:thread", message, span, help=help)
        names = [*robot.link_by_name, *robot.joint_by_name]
        sided = [one for one in names if any(side in one.lower() for side in _SIDES)]
        if sided:
            message = f"module '{name}': names of a mirrored module contain a side: {listed(sided, _MOST_LISTED)}"
            self._diagnostics.add(
                "SB158:side-name", message, span, help=["name them without a side in the module's file"]
            )
        parts = unsymmetric(robot, image)
        if parts:
            message = f"module '{name}': not their own mirror image: {listed(parts, _MOST_LISTED)}"
            self._diagnostics.add("SB168:shape", message, span)
        return image

    def _wrong_home(self, name: str, keys: tuple[str, ...], what: str, help: list[str]) -> None:
        place = self._sidecar.span("modules", name, *keys)
        self._diagnostics.add("SB160", f"module '{name}': home: {what}", place, help=help)

    def _unknown(self, name: str, keys: tuple[str | int, ...], one: str, what: str, known: list[str]) -> None:
        near = did_you_mean(one, known) or ((f"known: {listed(known, _MOST_LISTED)}",) if known else ())
        message = f"module '{name}': {keys[0]}: '{one}': {what} in '{self._robots_file(name)}'"
        self._diagnostics.add("SB160", message, self._sidecar.span("modules", name, *keys), help=near)

    def _robots_file(self, name: str) -> str:
        section = self._sections[name]
        origin = self._sections[section.mirror_of] if section.mirror_of else section
        return origin.file or name


def joints_above(document: Document, module: str) -> list[str]:
    """The joints of the composing file that move a module."""
    return [name for name, joint in document.joints.items() if joint.child.partition("/")[0] == module]


def coinciding(closure: LoopClosure, X_AB: Pose) -> LoopClosure:
    """The same closure with its frames at one place in the initial pose, as in a robot drawn in it.

    Formats that state one frame have the other one from this pose.
    """
    X_FG, axis = closure.X_AF.inverse() @ X_AB @ closure.X_BF, np.array(closure.axis)
    R, along = np.eye(3), axis * dot(axis, X_FG.p) if closure.kind.slides else np.zeros(3)
    if closure.kind is JointKind.BALL:
        R = X_FG.R
    elif closure.kind.about == "line":
        x, y, _ = perpendicular_frame(closure.axis).T
        turned = rotated(X_FG.R, x)
        R = rotation_about(closure.axis, atan2(dot(turned, y), dot(turned, x)))
    return replace(closure, X_AF=closure.X_AF @ Pose.of(R, along))


def _with_prefix(robot: Robot, prefix: str) -> Robot:
    named = renamed(robot, **dict.fromkeys(KINDS, lambda name: prefix + name))
    inner = tuple(replace(module, prefix=prefix + module.prefix) for module in named.modules)
    return replace(named, modules=inner)


def image_name(joint: str, original: str, name: str) -> str:
    """The name of the image of a joint above module ``of``, for its mirror image ``name``.

    ``left_roll`` above ``left_arm`` becomes ``right_roll`` for ``right_arm``: what differs between the modules' names
    is replaced in the joint's. A joint without it gets the image's name in front.
    """
    begin = r"(?<![A-Z])" if original[:1].isupper() else r"(?<![A-Za-z0-9])"
    words = re.sub(f"{begin}{re.escape(original)}(?![a-z0-9])", lambda _: name, joint)
    if words != joint:
        return words
    ours, theirs = original.split("_"), name.split("_")
    while len(ours) > 1 and len(theirs) > 1 and ours[-1] == theirs[-1]:
        ours, theirs = ours[:-1], theirs[:-1]
    while len(ours) > 1 and len(theirs) > 1 and ours[0] == theirs[0]:
        ours, theirs = ours[1:], theirs[1:]
    words = f"_{joint}_".replace(f"_{'_'.join(ours)}_", f"_{'_'.join(theirs)}_", 1)[1:-1]
    return words if words != joint else f"{name}_{joint}"


def module_record(name: str, part: Part, at: str) -> tuple[Module, ...]:
    """What the composed robot records of a part, and of the modules in it."""
    links = tuple(link.name for link in part.robot.links)
    gains = tuple(
        (actuator.name, actuator.kp, actuator.kv) for actuator in part.robot.actuators if actuator.tuning is not None
    )
    own = Module(name, part.file, part.prefix, links, at, part.mirror, gains)
    return own, *(replace(module, name=f"{name}/{module.name}", gains_alone=()) for module in part.robot.modules)
