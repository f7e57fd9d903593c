"""Ports: the links and frames that modules are attached to, by their references.

``tool0`` is an element of the composing file, ``arm/tool0`` the element ``tool0`` of the file of module ``arm``, and
``arm`` alone its root link.
"""

import re
from collections.abc import Iterable, Mapping

from msgspec import Struct

from stepbot.diagnostics import Diagnostics, did_you_mean
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.model import Joint, JointKind, Robot
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.origins import AutoOrigin, ExplicitOrigin, Offset, Origin
from stepbot.sidecar.tree import Keys, subject

from .parts import Part, image_name, joints_above

_MOST_LISTED = 12
_SEPARATORS = re.compile(r"[/.:_\-\s]+")
"""Characters that other formats have between the names of a path."""


class Port(Struct, frozen=True):
    """A frame on a link of the composed robot."""

    link: str
    X_LP: Pose = IDENTITY


class Ports:
    """Resolves references into the parts of a sidecar.

    Args:
        sidecar: The composing file.
        own: Its own links, or None.
        parts: Its modules; one with errors is not among them.
        diagnostics: Receives SB152.
    """

    def __init__(
        self, sidecar: Sidecar, own: Robot | None, parts: Mapping[str, Part], diagnostics: Diagnostics
    ) -> None:
        self._sidecar, self._own, self._parts, self._diagnostics = sidecar, own, parts, diagnostics
        self._links: dict[str, Pose] = {}
        self._frames: dict[str, Port] = {}
        self._joints: dict[str, Joint] = {}
        robots = [part.robot for part in parts.values()] + ([own] if own is not None else [])
        for robot in robots:
            self._frames |= {frame.name: Port(frame.link, frame.X_LF) for frame in robot.frames}
            self._joints |= robot.joint_by_name
        self._above = {joint.child: joint for joint in self._joints.values()}
        self._are_attached = False
        self._resolving: set[str] = set()
        self._in_circle: set[str] = set()

    def port(self, reference: str, keys: Keys) -> Port | None:
        """The port of a reference that stands at ``keys``; None after a diagnostic."""
        module, _, rest = reference.partition("/")
        if module in self._sidecar.document.modules:
            part = self._parts.get(module)
            return None if part is None else self._in_part(module, part, rest, keys)
        if rest:
            self._unknown(keys, f"no module '{module}'", module, self._sidecar.document.modules, "modules")
            return None
        if self._own is not None and reference in self._own.link_by_name:
            return Port(reference)
        if reference in self._sidecar.document.frames:
            return self._own_frame(reference)
        own = (*(self._own.link_by_name if self._own else ()), *self._sidecar.document.frames)
        paths = [f"{name}/{path}" for name, part in self._parts.items() for path in _of_part(part)]
        known = (*own, *paths, *self._parts, *(("world",) if keys[-1] == "at" else ()))
        self._unknown(keys, f"no link, frame or module '{reference}'", reference, known, "ports")
        return None

    def attach(self, mounts: Iterable[Joint]) -> None:
        """Take the joints above the parts: what is placed from now on can be relative to links of other parts."""
        self._above |= {joint.child: joint for joint in mounts}
        self._are_attached = True

    def joint(self, reference: str, keys: Keys) -> str | None:
        """The name in the composed robot of a joint; None after a diagnostic."""
        module, _, rest = reference.partition("/")
        if not rest:
            own = _own_joints(self._sidecar)
            if reference in own:
                return reference
            paths = [f"{m}/{part.local(one)}" for m, part in self._parts.items() for one in part.robot.joint_by_name]
            self._unknown(keys, f"no joint '{reference}'", reference, (*own, *paths), "joints")
            return None
        part = self._parts.get(module)
        if part is None:
            if module not in self._sidecar.document.modules:
                self._unknown(keys, f"no module '{module}'", module, self._sidecar.document.modules, "modules")
            return None
        name = part.written(rest)
        if name not in part.robot.joint_by_name:
            known = [part.local(one) for one in part.robot.joint_by_name]
            self._unknown(keys, f"no joint '{rest}' in module '{module}'", rest, known, f"joints of '{module}'")
            return None
        return name

    def path(self, joint: str) -> str:
        """The reference to a joint of the composed robot."""
        parts = self._parts.items()
        paths = [f"{name}/{part.local(joint)}" for name, part in parts if joint in part.robot.joint_by_name]
        return paths[0] if paths else joint

    def placed(self, reference: str, origin: Origin | None, keys: Keys) -> Port | None:
        """Where an element is that is fixed to a link of a module, with an explicit origin; None after a diagnostic.

        Args:
            origin: Its origin; None for the frame of the link.
            keys: The place of the element: its `link` and `origin` are below.
        """
        link = self.port(reference, (*keys, "link"))
        if link is None or origin is None:
            return link
        if not isinstance(origin, ExplicitOrigin) or origin.relative_to == "assembly":
            message = f"{subject((*keys, 'origin'))}: a module has no assembly here"
            help = [f"give a pose in a link or frame: `origin: {{xyz: [0, 0, 0], relative_to: {reference}}}`"]
            self._diagnostics.add("SB154", message, self._sidecar.span(*keys, "origin"), help=help)
            return None
        base = self.port(origin.relative_to, (*keys, "origin", "relative_to"))
        if base is None:
            return None
        X_LB = self._between(link.link, base.link)
        if X_LB is None:
            what = f"moves relative to '{reference}'"
            if not self._are_attached and self.part(base.link) != self.part(link.link):
                what = f"is in another part than '{reference}', and parts are attached to this frame"
            message = f"{subject((*keys, 'origin'))}: '{origin.relative_to}' {what}"
            help = [f"`relative_to: {reference}`, or a link or frame that is fixed to it"]
            self._diagnostics.add("SB154", message, self._sidecar.span(*keys, "origin"), help=help)
            return None
        return Port(link.link, X_LB @ base.X_LP @ Pose.from_xyz_rpy(origin.xyz, origin.rpy) @ moved_by(origin.offset))

    def rigid(self, link: str) -> tuple[str, Pose]:
        """The link nearest to the root that fixed joints connect a link to, and the pose of the link in it."""
        pose = IDENTITY
        while link in self._above and self._above[link].kind is JointKind.FIXED:
            joint = self._above[link]
            link, pose = joint.parent, joint.X_PC @ pose
        return link, pose

    def part(self, link: str) -> str:
        """The module of a link; empty for own ones."""
        return next((name for name, part in self._parts.items() if link in part.robot.link_by_name), "")

    def _between(self, a: str, b: str) -> Pose | None:
        """X_AB of two links that are fixed to each other; None if one moves relative to the other."""
        (above_a, X_RA), (above_b, X_RB) = self.rigid(a), self.rigid(b)
        return X_RA.inverse() @ X_RB if above_a == above_b else None

    def _in_part(self, module: str, part: Part, path: str, keys: Keys) -> Port | None:
        if not path:
            return Port(part.robot.root.name)
        name = part.written(path)
        if name in part.robot.link_by_name:
            return Port(name)
        frame = next((one for one in part.robot.frames if one.name == name), None)
        if frame is not None:
            return Port(frame.link, frame.X_LF)
        self._unknown(
            keys, f"no frame or link '{path}' in module '{module}'", path, _of_part(part), f"ports of '{module}'"
        )
        return None

    def _own_frame(self, name: str) -> Port | None:
        """A frame of the composing file: on an own link, or on one of a module."""
        if name not in self._frames:
            keys: Keys = ("frames", name)
            if name in self._resolving:
                if not self._in_circle:
                    message = f"frame '{name}': circular frame reference"
                    help = ["fix the frame to a link"]
                    self._diagnostics.add("SB152", message, self._sidecar.span(*keys, "link"), help=help)
                self._in_circle |= self._resolving
                return None
            self._resolving.add(name)
            section = self._sidecar.document.frames[name]
            port = self.placed(section.link, section.origin, keys)
            if port is None:
                return None
            self._frames[name] = port
        return self._frames[name]

    def _unknown(self, keys: Keys, what: str, name: str, known: Iterable[str], kind: str) -> None:
        names = list(dict.fromkeys(known))
        listed = ", ".join(names[:_MOST_LISTED]) + (", ..." if len(names) > _MOST_LISTED else "")
        help = (*_meant(name, names), *((f"{kind}: {listed}",) if names else ()))
        self._diagnostics.add("SB152", f"{subject(keys)}: {what}", self._sidecar.span(*keys), help=help)


def _own_joints(sidecar: Sidecar) -> list[str]:
    """The joints of the composing file, and the mirror images of those above modules."""
    document = sidecar.document
    images = [
        image_name(joint, section.mirror_of, name)
        for name, section in document.modules.items()
        if section.mirror_of
        for joint in joints_above(document, section.mirror_of)
    ]
    return [*document.joints, *images]


def _of_part(part: Part) -> list[str]:
    """The frames and links of a module, by their paths in its file."""
    return [part.local(one) for one in (*(frame.name for frame in part.robot.frames), *part.robot.link_by_name)]


def _meant(reference: str, names: Iterable[str]) -> tuple[str, ...]:
    """Help for an unknown reference: names with other separators, with the same last part, or nearly the same ones."""
    spelt, last = _plain(reference), _plain(reference.rpartition("/")[2])
    equal = [name for name in names if _plain(name) == spelt] or [
        name for name in names if _plain(name.rpartition("/")[2]) == last
    ]
    if equal:
        return ("did you mean " + " or ".join(f"'{name}'" for name in equal[:3]) + "?",)
    return did_you_mean(reference, names)


def _plain(name: str) -> str:
    return _SEPARATORS.sub("_", name).casefold()


def moved_by(offset: Offset | None) -> Pose:
    """The pose of an ``offset``."""
    return IDENTITY if offset is None else Pose.from_xyz_rpy(offset.xyz, offset.rpy)


def offset_of(origin: Origin) -> Pose | None:
    """The pose between two ports that coincide but for an ``offset``; None for an origin that is not found by ports."""
    if isinstance(origin, AutoOrigin) and origin.radius is None and origin.near is None:
        return moved_by(origin.offset)
    return IDENTITY if origin == "auto" else None
