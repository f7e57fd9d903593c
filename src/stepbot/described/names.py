"""Names that every format can hold: those of a description that it cannot are replaced, and listed."""

import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from stepbot.robot.file_names import is_device
from stepbot.robot.model import Joint, Link, Robot
from stepbot.robot.unique_names import free_name

from .finding import RENAMED, Finding

_INVALID = re.compile(r"""[/<>&"'\x00-\x1f\x7f]+|::""")
_INVALID_IN_FILES = re.compile(r"[\\:*?|]+")
_LONGEST = 200


def valid_name(name: str, fallback: str) -> str:
    """A name that every format can hold, resembling ``name``."""
    visible = "".join(letter for letter in name if unicodedata.category(letter) not in ("Cf", "Cs"))
    valid = _INVALID.sub("_", visible).strip()[:_LONGEST].strip() or fallback
    if valid.startswith("__") and valid.endswith("__"):
        valid = valid.strip("_") or fallback
    return "world_link" if valid == "world" else valid


def valid_file_name(name: str) -> str:
    """A name that is a valid file name on every system, too."""
    valid = _INVALID_IN_FILES.sub("_", valid_name(name, "robot")).strip(". ")[:100].strip(". ") or "robot"
    return f"{valid}_robot" if is_device(valid) else valid


@dataclass(frozen=True)
class Names:
    """New names by the old ones, of those that change."""

    links: Mapping[str, str]
    joints: Mapping[str, str]
    frames: Mapping[str, str]


def with_valid_names(robot: Robot, found: list[Finding]) -> tuple[Robot, Names]:
    """The robot with valid names, unique within their kind, and the new names."""
    taken: set[str] = set()
    links = _renamed((link.name for link in robot.links), "link", taken)
    frames = _renamed((frame.name for frame in robot.frames), "frame", taken)
    taken = set()
    joints = _renamed((joint.name for joint in robot.joints), "joint", taken)
    closures = _renamed((closure.name for closure in robot.closures), "closure", taken)
    actuators = _renamed((one.name for one in robot.actuators), "actuator", set())
    sensors = _renamed((one.name for one in robot.sensors), "sensor", set())
    name = valid_file_name(robot.name)
    maps = (links, joints, frames, closures, actuators, sensors)
    for kind, of_kind in zip(("link", "joint", "frame", "closure", "actuator", "sensor"), maps, strict=True):
        for old, new in of_kind.items():
            if old != new:
                found.append(Finding(RENAMED, f"{kind} '{old}' is renamed to '{new}'"))
    if name != robot.name:
        found.append(Finding(RENAMED, f"robot '{robot.name}' is renamed to '{name}'"))
    pairs = (sorted((links[a], links[b])) for a, b in robot.excluded_contacts)
    renamed = replace(
        robot,
        name=name,
        excluded_contacts=tuple(sorted((a, b) for a, b in pairs)),
        links=_links(robot.links, links),
        joints=tuple(_joint(joint, links, joints) for joint in robot.joints),
        closures=tuple(
            replace(one, name=closures[one.name], link_a=links[one.link_a], link_b=links[one.link_b])
            for one in robot.closures
        ),
        frames=tuple(replace(one, name=frames[one.name], link=links[one.link]) for one in robot.frames),
        actuators=tuple(replace(one, name=actuators[one.name], joint=joints[one.joint]) for one in robot.actuators),
        sensors=tuple(
            replace(one, name=sensors[one.name], link=links[one.link], joint=joints.get(one.joint, ""))
            for one in robot.sensors
        ),
    )
    changes = ({old: new for old, new in of_kind.items() if old != new} for of_kind in (links, joints, frames))
    return renamed, Names(*changes)


def _renamed(names: Iterable[str], kind: str, taken: set[str]) -> dict[str, str]:
    return {name: free_name(valid_name(name, kind), f"_{kind}", taken) for name in names}


def _joint(joint: Joint, links: Mapping[str, str], joints: Mapping[str, str]) -> Joint:
    mimic = joint.mimic and replace(joint.mimic, joint=joints[joint.mimic.joint])
    return replace(joint, name=joints[joint.name], parent=links[joint.parent], child=links[joint.child], mimic=mimic)


def _links(links: Iterable[Link], names: Mapping[str, str]) -> tuple[Link, ...]:
    """The links, with shapes whose names are valid and unique in the robot."""
    seen: set[str] = set()
    touched: set[str] = set()
    return tuple(
        replace(
            link,
            name=names[link.name],
            visuals=tuple(
                replace(one, name=free_name(valid_name(one.name, "visual"), "_2", seen)) for one in link.visuals
            ),
            collisions=tuple(
                replace(one, name=free_name(valid_name(one.name, "collision"), "_2", touched))
                for one in link.collisions
            ),
        )
        for link in links
    )
