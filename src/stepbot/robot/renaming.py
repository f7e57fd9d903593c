"""Renames the elements of a robot, and every reference to them."""

from collections.abc import Callable, Mapping

from msgspec import Struct, field
from msgspec.structs import replace

from .model import Joint, Link, Robot
from .self_collision import PairContact, SelfCollision

Rename = Callable[[str], str]
KINDS = ("link", "joint", "closure", "frame", "actuator", "sensor", "visual", "collision")
"""The kinds of elements with names: the arguments of :func:`renamed`."""


class NewNames(Struct, frozen=True):
    """New names by the old ones, of those that change."""

    links: Mapping[str, str] = field(default_factory=dict)
    joints: Mapping[str, str] = field(default_factory=dict)
    frames: Mapping[str, str] = field(default_factory=dict)

    def link(self, name: str) -> str:
        """The name of a link."""
        return self.links.get(name, name)

    def joint(self, name: str) -> str:
        """The name of a joint."""
        return self.joints.get(name, name)

    def frame(self, name: str) -> str:
        """The name of a frame."""
        return self.frames.get(name, name)


def names_of(robot: Robot, *kinds: str) -> list[str]:
    """The names of the elements of some kinds, which are fields of the robot."""
    return [element.name for kind in kinds for element in getattr(robot, kind)]


def same(name: str) -> str:
    """The name itself: elements of a kind that keep theirs."""
    return name


def renamed(
    robot: Robot,
    *,
    link: Rename = same,
    joint: Rename = same,
    closure: Rename = same,
    frame: Rename = same,
    actuator: Rename = same,
    sensor: Rename = same,
    visual: Rename = same,
    collision: Rename = same,
) -> Robot:
    """The robot with other names; the name of the robot itself and those of its meshes stay.

    Args:
        link: New name of a link; further ones for the other kinds. Each must map different names to different names.
        visual: Visuals, in the order of the links.
        collision: Collisions, in the order of the links.
    """

    def of_link(one: Link) -> Link:
        visuals = tuple(replace(shape, name=visual(shape.name)) for shape in one.visuals)
        collisions = tuple(replace(shape, name=collision(shape.name)) for shape in one.collisions)
        return replace(one, name=link(one.name), visuals=visuals, collisions=collisions)

    def of_joint(one: Joint) -> Joint:
        mimic = None if one.mimic is None else replace(one.mimic, joint=joint(one.mimic.joint))
        return replace(one, name=joint(one.name), parent=link(one.parent), child=link(one.child), mimic=mimic)

    def pair(a: str, b: str) -> tuple[str, str]:
        first, second = sorted((link(a), link(b)))
        return first, second

    def of_pair(contact: PairContact) -> PairContact:
        pose = tuple((joint(name), q) for name, q in contact.pose)
        return replace(contact, link_a=link(contact.link_a), link_b=link(contact.link_b), pose=pose)

    overlaps: SelfCollision | None = robot.self_collision
    if overlaps is not None:
        overlaps = replace(overlaps, pairs=tuple(map(of_pair, overlaps.pairs)))
    return replace(
        robot,
        links=tuple(map(of_link, robot.links)),
        joints=tuple(map(of_joint, robot.joints)),
        closures=tuple(
            replace(one, name=closure(one.name), link_a=link(one.link_a), link_b=link(one.link_b))
            for one in robot.closures
        ),
        frames=tuple(replace(one, name=frame(one.name), link=link(one.link)) for one in robot.frames),
        actuators=tuple(replace(one, name=actuator(one.name), joint=joint(one.joint)) for one in robot.actuators),
        sensors=tuple(
            replace(
                one,
                name=sensor(one.name),
                link=link(one.link) if one.link else "",
                joint=joint(one.joint) if one.joint else "",
                frame=(link if one.frame in robot.link_by_name else frame)(one.frame) if one.frame else "",
            )
            for one in robot.sensors
        ),
        excluded_contacts=tuple(sorted(pair(a, b) for a, b in robot.excluded_contacts)),
        self_collision=overlaps,
        modules=tuple(
            replace(module, links=tuple(map(link, module.links)), at=link(module.at) if module.at else "")
            for module in robot.modules
        ),
    )
