"""Where each part of a composed robot is attached: one root, and everything else on a port or below a joint."""

from collections.abc import Mapping
from fnmatch import fnmatchcase
from math import degrees, radians
from types import MappingProxyType

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.assemble.joints import joint_of
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import IDENTITY, Pose, tidy
from stepbot.robot.bounding_boxes import standing_height
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Base, Joint, JointKind, Robot
from stepbot.sidecar.document import JointSection
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.modules import ModuleSection
from stepbot.sidecar.own_part import TIE
from stepbot.sidecar.tree import ELEMENTS

from .images import Images, is_root_part
from .mirroring import NORMALS, conjugated, flipped, mirrored
from .parts import Part, image_name, joints_above
from .ports import Port, Ports, moved_by, offset_of
from .pruning import elements

_NEAR, _NEARLY_ALONG = 1e-4, radians(0.1)
"""Distance [m] and angle [rad] within which a place is the mirror image of another."""
WORLD = "world"
"""What `at` names for a part that stands by itself."""


class Mount(Struct, frozen=True):
    """A joint that attaches a part: a weld at a port, or a joint of the composing file."""

    joint: Joint
    """Its child is the root link of the part."""
    X_RC: Pose = IDENTITY
    """Pose in the root link, as the part has it, of the frame that the joint moves: the root link's new frame."""


class Places:
    """Finds the place of every part.

    Args:
        sidecar: The composing file.
        own: Its own links, tied together by joints whose names begin with :data:`TIE`, or None.
        parts: Its modules.
        ports: Resolves references.
        diagnostics: Receives SB154 and SB168:place.
    """

    def __init__(
        self, sidecar: Sidecar, own: Robot | None, parts: Mapping[str, Part], ports: Ports, diagnostics: Diagnostics
    ) -> None:
        self._sidecar, self._own, self._parts, self._ports, self._diagnostics = sidecar, own, parts, ports, diagnostics
        self._document = sidecar.document
        self._images = Images(sidecar, parts, ports, diagnostics)
        joints = own.joints if own is not None else ()
        self._own_roots = [own.root.name] if own is not None else []
        self._own_roots += [joint.child for joint in joints if joint.name.startswith(TIE)]
        self._of_root = {part.robot.root.name: name for name, part in parts.items()}
        robots = [part.robot for part in parts.values()] + ([own] if own is not None else [])
        self._taken = {one.name for robot in robots for kind in elements(robot).values() for one in kind}
        self._taken |= {name for section in ELEMENTS for name in getattr(sidecar.document, section)}
        self._reported: set[tuple[str, ...]] = set()
        self.mounts: dict[str, Mount] = {}
        """The joint above each root link that has one, by the link, in the order of the sidecar."""
        self.world = ""
        """The link that this adds as the root, in which several parts stand; empty for none."""

    def find(self) -> str | None:
        """Fill :attr:`mounts`, and return the root link of the whole; None after errors.

        If modules stand in the world, the root is the part that stands there without `at`, if it is fixed; else
        :attr:`world`, a link without mass.
        """
        for name, section in self._document.joints.items():
            if not (self._own is not None and name in self._own.joint_by_name):
                self._joint(name, section)
        for name, module in self._document.modules.items():
            if name in self._parts:
                self._module(name, module)
        if self._diagnostics.has_errors:
            return None
        mounts = dict(self.mounts)  # those in the world, before one of the parts becomes the root
        root = self._root()
        for name, module in self._document.modules.items() if root is not None else ():
            if module.mirror_of and module.at:
                self._report_no_image(name, module, mounts)
        return root

    def _module(self, name: str, section: ModuleSection) -> None:
        above, keys = joints_above(self._document, name), ("modules", name, "at")
        if section.at is not None:
            if section.at == WORLD and not above:
                self._stand(name, section, moved_by(section.offset))
                return
            if above:
                message = f"module '{name}': placed by `at` and by joint '{above[0]}'"
                self._diagnostics.add("SB154", message, self._sidecar.span(*keys), help=["remove one of them"])
                return
            port = self._ports.port(section.at, keys)
            if port is not None:
                self._weld(name, section, port, moved_by(section.offset))
        elif section.mirror_of and not above:
            self._mirror(name, section)

    def _report_no_image(self, name: str, section: ModuleSection, mounts: Mapping[str, Mount]) -> None:
        """Report SB168:place: the place given for a mirrored module is not the mirror image of the original's."""
        roots = [self._parts[one].robot.root.name for one in (name, str(section.mirror_of))]
        joints = [mounts[root].joint for root in roots if root in mounts]
        if len(joints) < 2 or any(joint.kind is not JointKind.FIXED for joint in joints):
            return
        here, there = (Port(joint.parent, joint.X_PC) for joint in joints)
        off = self._off(name, here, there, mounts)
        if off:
            message = f"module '{name}': not at the mirror image of the place of '{section.mirror_of}': {off}"
            help = ["without `at` it is placed there; a part that is turned instead of mirrored needs no `mirror_of`"]
            self._diagnostics.add("SB168:place", message, self._sidecar.span("modules", name, "at"), help=help)

    def _off(self, name: str, here: Port, there: Port, mounts: Mapping[str, Mount]) -> str:
        """How far a place is from the mirror image of the original's; empty if it is there, or if no image is known."""
        m, module = np.array(NORMALS[self._document.modules[name].mirror or "y"]), self._ports.part(there.link)
        images = self._images.beside(name, module)
        if len(images) > 1:
            return ""
        if images:
            link = self._parts[images[0]].written(self._parts[module].local(there.link))
            m_there = np.array(NORMALS[self._document.modules[images[0]].mirror or "y"])
            image = Port(link, conjugated(there.X_LP, m_there, m))
        else:
            for above in (self._rigid, self._drawn):  # two places on one link, or on two links of one part
                (a, X_A), (b, X_B) = above(here), above(there)
                if a == b:
                    return _apart(X_A, conjugated(X_B, m))
            if module and not is_root_part(self._document, module):
                return ""
            image = Port(there.link, conjugated(there.X_LP, m))
        (a, X_A), (b, X_B) = (self._rigid(port, mounts) for port in (here, image))
        return _apart(X_A, X_B) if a == b else f"on link '{here.link}' instead of '{image.link}'"

    def _rigid(self, port: Port, mounts: Mapping[str, Mount] = MappingProxyType({})) -> tuple[str, Pose]:
        """The link nearest to the root that a port is fixed to, also through ``mounts``, and the port's pose in it."""
        link, X = self._ports.rigid(port.link)
        X = X @ port.X_LP
        if link in mounts and mounts[link].joint.kind is JointKind.FIXED:
            return self._rigid(Port(mounts[link].joint.parent, mounts[link].joint.X_PC @ X), mounts)
        return link, X

    def _drawn(self, port: Port) -> tuple[str, Pose]:
        """The root link of the part of a port, and the port's pose in it in the initial pose."""
        root = self._part_root(port.link)
        robot = self._parts[self._of_root[root]].robot if root in self._of_root else self._own
        if root == WORLD or robot is None:
            return root, port.X_LP
        poses = link_poses(robot, initial_configuration(robot))
        return root, poses[root].inverse() @ poses[port.link] @ port.X_LP

    def _stand(self, name: str, section: ModuleSection, X_W: Pose) -> None:
        """Place a module in the world: fixed, or free and with its lowest point at that height if its base floats."""
        robot = self._parts[name].robot
        if robot.base is Base.FIXED:
            self._weld(name, section, Port(WORLD), X_W)
            return
        X_RB = self._own_port(name, section)
        if X_RB is not None:
            X_PC = self._standing(robot.root.name, X_W @ X_RB.inverse(), X_W.p[2])
            self._attach(robot.root.name, Mount(self._freely(name, robot.root.name, X_PC)), name)

    def _weld(self, name: str, section: ModuleSection, port: Port, offset: Pose) -> None:
        root = self._parts[name].robot.root.name
        X_RB = self._own_port(name, section)
        if X_RB is not None:
            X_PC = tidy(port.X_LP @ offset @ X_RB.inverse())
            self._attach(
                root, Mount(Joint(self._free_name(f"{name}_mount"), JointKind.FIXED, port.link, root, X_PC)), name
            )

    def _own_port(self, name: str, section: ModuleSection) -> Pose | None:
        """The pose in its root link of a module's port `by`, or of its original's; None after a diagnostic."""
        by = section.by or (self._document.modules[section.mirror_of].by if section.mirror_of else None)
        return self._of_part(name, by, ("modules", name, "by")) if by else IDENTITY

    def _of_part(self, name: str, local: str, keys: tuple[str, ...]) -> Pose | None:
        """The pose in a part's root link of one of its own ports; None after a diagnostic."""
        port = self._ports.port(f"{name}/{local}", keys)
        return None if port is None else self._in_root(port, f"module '{name}'", keys)

    def _in_root(self, port: Port, who: str, keys: tuple[str, ...]) -> Pose | None:
        root, X_RL = self._ports.rigid(port.link)
        if root in self._of_root or root in self._own_roots:
            return X_RL @ port.X_LP
        if keys in self._reported:  # the image of what moves moves, too
            return None
        self._reported.add(keys)
        message = f"{who}: '{port.link}' moves relative to the root link of its part"
        help = ["attach it by a port that is fixed to its root link, or close the loop by a closure"]
        self._diagnostics.add("SB154", message, self._sidecar.span(*keys), help=help)
        return None

    def _joint(self, name: str, section: JointSection) -> None:
        keys = ("joints", name)
        parent = self._ports.port(section.parent, (*keys, "parent"))
        child = self._ports.port(section.child, (*keys, "child"))
        offset = self._offset(name, section)
        if parent is None or child is None or offset is None:
            return
        X_RC = self._in_root(child, f"joint '{name}'", (*keys, "child"))
        if X_RC is not None:
            root, _ = self._ports.rigid(child.link)
            joint = self._joint_of(name, section, parent.link, root, tidy(parent.X_LP @ offset))
            self._attach(root, _mount(joint, X_RC), name)

    def _joint_of(self, name: str, section: JointSection, parent: str, child: str, X_PC: Pose) -> Joint:
        mimic = section.mimic
        leader = None if mimic is None else self._ports.joint(mimic.joint, ("joints", name, "mimic", "joint"))
        return joint_of(self._document, name, (parent, child), X_PC, leader)

    def _offset(self, name: str, section: JointSection) -> Pose | None:
        if (offset := offset_of(section.origin)) is not None:
            return offset
        message = f"joint '{name}': origin: its links are not in one assembly"
        help = ["leave out `origin`: the ports coincide; `frames` can add a port, `origin: {offset: ...}` moves it"]
        self._diagnostics.add("SB154", message, self._sidecar.span("joints", name, "origin"), help=help)
        return None

    def _mirror(self, name: str, section: ModuleSection) -> None:
        """Attach a module at the mirror image of the place of another one."""
        of = str(section.mirror_of)
        original = self._document.modules[of]
        m = np.array(NORMALS[section.mirror or "y"])
        if original.at == WORLD:
            self._stand(name, section, conjugated(moved_by(original.offset), m))
        elif original.at is not None:
            port = self._images.port(name, original.at, ("modules", of, "at"), moved_by(original.offset), m)
            if port is not None:
                self._weld(name, section, port, IDENTITY)
        for above in joints_above(self._document, of):
            joint = self._document.joints[above]
            offset = self._offset(above, joint)
            port = None
            if offset is not None:
                port = self._images.port(name, joint.parent, ("joints", above, "parent"), offset, m)
            local = joint.child.partition("/")[2]
            X_RC = self._of_part(name, local, ("joints", above, "child")) if local else IDENTITY
            if port is None or X_RC is None:
                continue
            root = self._parts[name].robot.root.name
            made = self._joint_of(above, joint, port.link, root, IDENTITY)
            made = replace(made, mimic=self._images.mimic(name, above))
            image = _mirrored_joint(replace(made, name=image_name(above, of, name)), section)
            self._attach(root, _mount(replace(image, X_PC=tidy(port.X_LP)), X_RC), name)

    def _attach(self, root: str, mount: Mount, who: str) -> None:
        if root in self.mounts:
            first = self.mounts[root].joint.name
            message = f"{self._label(root)}: placed by '{first}' and by '{mount.joint.name}'"
            place = self._sidecar.key_span("joints" if who in self._document.joints else "modules", who)
            help = ["remove one of them, or make one of the joints a closure"]
            self._diagnostics.add("SB154", message, place, help=help)
            return
        self.mounts[root] = mount

    def _root(self) -> str | None:
        roots = [root for root in (*self._own_roots, *self._of_root) if root not in self.mounts]
        if len(roots) < 2 and any(mount.joint.parent == WORLD for mount in self.mounts.values()):
            return self._in_world(roots)
        if len(roots) == 1:
            return self._reaching(roots[0])
        if not roots:
            self._report_rings(self.mounts)
        for root in roots[1:]:
            message = f"{self._label(root)}: no place; only one part can be the root, and {self._label(roots[0])} is"
            place = self._sidecar.key_span("modules", self._of_root[root]) if root in self._of_root else None
            help = ["`at: LINK_OR_FRAME` fixes it to a port; a joint with it as its child moves it"]
            self._diagnostics.add("SB154", message, place or self._sidecar.key_span("links", root), help=help)
        return None

    def _freely(self, name: str, root: str, X_PC: Pose) -> Joint:
        """The joint of a part that nothing holds in the world."""
        return Joint(self._free_name(f"{name}_free"), JointKind.FLOATING, WORLD, root, X_PC)

    def _free_name(self, name: str) -> str:
        """A name for a joint that no file has: formats have one namespace for all of these."""
        return free_name(name, "_joint", self._taken)

    def _in_world(self, roots: list[str]) -> str | None:
        """The root of parts that stand in the world."""
        taken = {link for part in self._parts.values() for link in part.robot.link_by_name}
        taken |= set(self._own.link_by_name) if self._own is not None else set()
        root = roots[0] if roots and not self._floats(roots[0]) else ""
        if not root:
            root = self.world = free_name(self._document.robot, "_cell", taken)
            for one in roots:
                name = self._of_root.get(one, one)
                self.mounts[one] = Mount(self._freely(name, one, self._standing(one, IDENTITY, 0.0)))
        for child, mount in self.mounts.items():
            if mount.joint.parent == WORLD:
                self.mounts[child] = replace(mount, joint=replace(mount.joint, parent=root))
        return self._reaching(root)

    def _floats(self, root: str) -> bool:
        if root in self._of_root and "base" not in self._document.model_fields_set:
            return self._parts[self._of_root[root]].robot.base is Base.FLOATING
        return self._document.base is Base.FLOATING

    def _standing(self, root: str, X_WR: Pose, floor: float) -> Pose:
        """A pose of a root link, raised or lowered so that the lowest point of its part is at the height ``floor``."""
        robot = self._parts[self._of_root[root]].robot if root in self._of_root else self._own
        assert robot is not None  # the root is a link of a part
        alone = replace(robot, base=Base.FLOATING)
        height = standing_height(alone, initial_configuration(alone), Pose.of(X_WR.R))
        return tidy(Pose.of(X_WR.R, (X_WR.p[0], X_WR.p[1], floor + height)))

    def _reaching(self, root: str) -> str | None:
        """The root, if every part is below it; parts in a ring are not."""
        reached: set[str] = {root}
        waiting = dict(self.mounts)
        while True:
            new = [one for one, mount in waiting.items() if self._part_root(mount.joint.parent) in reached]
            if not new:
                break
            reached.update(new)
            for one in new:
                del waiting[one]
        self._report_rings(waiting)
        return None if waiting else root

    def _report_rings(self, mounts: Mapping[str, Mount]) -> None:
        """Report SB154 for each ring of parts that are attached to each other; not for what hangs on them."""
        seen: set[str] = set()
        for start in mounts:
            chain: list[str] = []
            one = start
            while one in mounts and one not in seen:
                seen.add(one)
                chain.append(one)
                one = self._part_root(mounts[one].joint.parent)
            if one in chain:
                ring = [self._of_root.get(root, root) for root in (*chain[chain.index(one) :], one)]
                message = f"{self._label(one)}: attached in a circle: {' -> '.join(ring)}"
                help = ["attach one of them to another part, or remove its place: it is the root then"]
                place = ("modules", self._of_root[one]) if one in self._of_root else ("links", one)
                self._diagnostics.add("SB154", message, self._sidecar.key_span(*place), help=help)

    def _part_root(self, link: str) -> str:
        for root, name in self._of_root.items():
            if link in self._parts[name].robot.link_by_name:
                return root
        above = {} if self._own is None else {joint.child: joint for joint in self._own.joints}
        while link in above and not above[link].name.startswith(TIE):
            link = above[link].parent
        return link

    def _label(self, root: str) -> str:
        return f"module '{self._of_root[root]}'" if root in self._of_root else f"link '{root}'"


def _apart(a: Pose, b: Pose) -> str:
    distance, angle = a.distance_to(b)
    is_near = distance <= _NEAR and angle <= _NEARLY_ALONG
    return "" if is_near else f"{1000.0 * distance:.3g} mm, {degrees(angle):.3g} deg"


def _mirrored_joint(joint: Joint, section: ModuleSection) -> Joint:
    """The image of one joint: its axis, and with `flip` its positive direction."""
    alone = Robot(joint.name, (), (joint,))
    image = mirrored(alone, section.mirror or "y")
    flips = [one for one in section.flip if fnmatchcase(joint.name, one)]
    return (flipped(image, flips) if flips else image).joints[0]


def _mount(joint: Joint, X_RC: Pose) -> Mount:
    """A fixed joint keeps the frame of the root link; one that moves needs it on its axis."""
    if joint.kind is JointKind.FIXED:
        return Mount(replace(joint, X_PC=tidy(joint.X_PC @ X_RC.inverse())))
    return Mount(joint, tidy(X_RC))
