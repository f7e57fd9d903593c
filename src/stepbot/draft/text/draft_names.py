"""Names of drafted links and joints, made valid and unique for every format."""

import re
from collections.abc import Iterable, Mapping

from msgspec import Struct

from stepbot.draft.draft import Draft
from stepbot.sidecar.section import NOT_IN_NAMES

_LONGEST = 60
_RESERVED = ("world", "assembly")


class DraftNames(Struct, frozen=True):
    """The names of links, joints and closures in the sidecar."""

    links: Mapping[str, str]
    """By the name in the draft."""
    joints: tuple[str, ...]
    """In the order of the draft."""
    closures: tuple[str, ...]
    frames: tuple[str, ...] = ()
    freed: tuple[str, ...] = ()
    """Links that fused parts would be, in the order of ``Draft.fused``."""


def names_of(draft: Draft) -> DraftNames:
    """Valid, unique names for everything in a draft; a link keeps its name if a joint has the same."""
    taken: set[str] = set()
    links = [link.name for link in draft.links]
    return DraftNames(
        dict(zip(links, _named(links, "link", taken), strict=True)),
        _named((joint.name for joint in draft.joints), "joint", taken),
        _named((closure.name for closure in draft.closures), "closure", taken),
        _named((frame.name for frame in draft.frames), "frame", taken),
        _named((one.freed for one in draft.fused), "link", taken),
    )


def _named(wanted: Iterable[str], kind: str, taken: set[str]) -> tuple[str, ...]:
    names = []
    for name in wanted:
        base = readable_name(name) or kind
        if base in _RESERVED:
            base = f"{base}_{kind}"
        free, count = base, 1
        while free in taken:
            count += 1
            free = f"{base}_{count}"
        taken.add(free)
        names.append(free)
    return tuple(names)


def readable_name(text: str) -> str:
    """A text as a name that needs no quotes: letters of any script, digits, ``_ . -``; may be empty.

    Formats allow more characters; scripts, shells and ROS topics do not.
    """
    kept = "".join(c if c.isprintable() and c not in NOT_IN_NAMES else "_" for c in text)
    return re.sub(r"_{2,}", "_", re.sub(r"[^\w.-]+", "_", kept))[:_LONGEST].strip("_.-")
