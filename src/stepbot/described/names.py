"""Names that every format can hold: those of a description that it cannot are replaced, and listed."""

import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial

from stepbot.robot.mesh_names import free_name, is_device
from stepbot.robot.model import Robot
from stepbot.robot.renaming import renamed

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
    with_names = renamed(
        replace(robot, name=name),
        link=links.__getitem__,
        joint=joints.__getitem__,
        closure=closures.__getitem__,
        frame=frames.__getitem__,
        actuator=actuators.__getitem__,
        sensor=sensors.__getitem__,
        visual=partial(_free, "visual", set()),
        collision=partial(_free, "collision", set()),
    )
    changes = ({old: new for old, new in of_kind.items() if old != new} for of_kind in (links, joints, frames))
    return with_names, Names(*changes)


def _renamed(names: Iterable[str], kind: str, taken: set[str]) -> dict[str, str]:
    return {name: free_name(valid_name(name, kind), f"_{kind}", taken) for name in names}


def _free(kind: str, taken: set[str], name: str) -> str:
    """A valid name for a shape that no earlier one has; the shapes are named in the robot's order."""
    return free_name(valid_name(name, kind), "_2", taken)
