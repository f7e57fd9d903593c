"""What a reader of a description takes from its XML: everything else is listed, with the place where it first occurs.

A vocabulary lists what is read, not what is lost: an element that nobody thought of is reported, not forgotten.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from msgspec import Struct, field

from stepbot.diagnostics import did_you_mean

_MISSPELT = 0.75
"""Least similarity of a misspelt name to the one that was meant; `mu2` is not `mu1`, and `poze` is `pose`."""

Element = Any
"""``lxml.etree._Element``; the stubs lack ``sourceline``."""


class Unread(Struct, frozen=True):
    """Elements or attributes of one kind that do not reach the model."""

    what: str
    """``<safety_controller> in <joint>``, or ``attribute 'group' of <geom>``."""
    count: int
    line: int
    """Line of the first one; 0 if unknown."""
    file: str = ""
    """The file that it is in, relative to the description's folder; empty for the description itself."""
    effect: str = ""
    """Physical consequence; empty if there is none beyond its absence."""
    help: tuple[str, ...] = ()
    """The name that is read, if this one looks like a misspelling of it."""


class Vocabulary(Struct, frozen=True):
    """The elements and attributes that are read, by path from the root element, as in ``robot/link/inertial``."""

    read: Mapping[str, str]
    """For each path the attributes that are read, separated by spaces; ``*`` for all. A path may end with ``/*``."""
    neutral: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Values without effect, of attributes (``path@name``, ``tag@name``) and of unread elements (``path``)."""
    effects: Mapping[str, str] = field(default_factory=dict)
    """Consequence of the loss of a path, of an attribute (``path@name``), or of the last part of either."""
    nests: tuple[str, ...] = ()
    """Elements that contain themselves: a path has each of them once."""
    holders: Mapping[str, str] = field(default_factory=dict)
    """Elements that only hold others, which count as those of the element around, and the attributes that they have."""
    kinds: Mapping[str, str] = field(default_factory=dict)
    """Attributes that tell elements of a path apart: the path continues with ``[value]``."""
    twins: Mapping[str, str] = field(default_factory=dict)
    """Elements that are not read, and have no effect beside an equal element of another tag."""
    strict: bool = False
    """Whether the format's engine rejects misspelt names, so that none is left to be found here."""

    def unread(self, root: Element, file: str = "", at: str = "") -> tuple[Unread, ...]:
        """What of a document is not read, in the order of its first occurrence.

        Args:
            root: The root element, without expanded entities.
            file: The file, relative to the description's folder; empty for the description itself.
            at: Path of the root element; empty for its tag.
        """
        elements: dict[tuple[str, str], list[int]] = {}
        attributes: dict[str, dict[str, list[int]]] = {}
        for path, tag, name, line in self._lost(root, at or str(root.tag)):
            if name:
                attributes.setdefault(f"{path}>{tag}", {}).setdefault(name, []).append(line)
            else:
                elements.setdefault((path, tag), []).append(line)
        unread = [
            Unread(
                f"<{tag}> in <{_last(path)}>",
                len(lines),
                lines[0],
                file,
                self._effect(f"{path}/{tag}"),
                self._meant(tag, (_last(one) for one in self.read if one.rpartition("/")[0] == path)),
            )
            for (path, tag), lines in elements.items()
        ]
        for key, by_name in attributes.items():
            path, _, tag = key.rpartition(">")
            lines = sorted(line for one in by_name.values() for line in one)
            names = ", ".join(f"'{name}'" for name in by_name)
            what = f"attribute{'s' if len(by_name) > 1 else ''} {names} of <{tag}>"
            effects = dict.fromkeys(filter(None, (self._effect(f"{path}@{name}") for name in by_name)))
            known = f"{self.read[path]} {self.holders.get(tag, '')}".split()
            help = dict.fromkeys(text for name in by_name for text in self._meant(name, known))
            unread.append(Unread(what, len(lines), lines[0], file, "; ".join(effects), tuple(help)))
        return tuple(sorted(unread, key=lambda one: one.line))

    def _lost(self, element: Element, path: str) -> Iterator[tuple[str, str, str, int]]:
        """For each loss the path, the tag, the attribute or nothing, and the line."""
        line, tag = element.sourceline or 0, str(element.tag)
        known = f"{self.read[path]} {self.holders.get(tag, '')}".split()
        for name, value in element.attrib.items():
            neutral = self.neutral.get(f"{path}@{name}") or self.neutral.get(f"{tag}@{name}", ())
            if "*" not in known and name not in known and str(value).strip() not in neutral:
                yield path, tag, name, line
        for child in element:
            if not isinstance(child.tag, str):  # a comment
                continue
            below = self.below(path, child)
            if below in self.read:
                yield from self._lost(child, below)
            elif not (self._is_neutral(child, below) or self._is_twin(child, below)):
                yield path, child.tag, "", child.sourceline or 0

    def reads(self, path: str, name: str, tag: str) -> bool:
        """Whether an attribute of the elements of a tag at a path is read."""
        return bool({"*", name} & set(self.holders.get(tag, self.read.get(path, "")).split()))

    def below(self, path: str, child: Element) -> str:
        """The path of an element below a path."""
        tag = str(child.tag)
        if tag in self.holders:
            return path
        if f"{path}/{tag}" not in self.read and f"{path}/*" in self.read:
            return f"{path}/*"
        below = path if tag in self.nests and path.rpartition("/")[2] == tag else f"{path}/{tag}"
        kind = self.kinds.get(below)
        return below if kind is None else f"{below}[{child.get(kind, '')}]"

    def path_of(self, element: Element, top: str) -> str:
        """The path of an element of a document whose root element has the path ``top``."""
        path = top
        for one in [element, *element.iterancestors()][-2::-1]:
            path = self.below(path, one)
        return path

    def _is_neutral(self, element: Element, path: str) -> bool:
        """Whether an element that is not read has a value without effect."""
        values = self.neutral.get(path)
        return values is not None and (element.text or "").strip() in values

    def _is_twin(self, element: Element, path: str) -> bool:
        """Whether an element that is not read has the same value as its twin beside it."""
        twin = self.twins.get(path)
        other = None if twin is None else element.getparent().find(twin)
        words = [[*one.attrib.items(), *(one.text or "").split()] for one in (element, other) if one is not None]
        return other is not None and words[0] == words[1]

    def _meant(self, name: str, known: Iterable[str]) -> tuple[str, ...]:
        """``help`` for an unread name that looks misspelt; names of which a loss is described are none."""
        return () if self.strict or name in self.effects else did_you_mean(name, known, least=_MISSPELT)

    def _effect(self, path: str) -> str:
        return self.effects.get(path) or self.effects.get(path.replace("@", "/").rpartition("/")[2], "")


def _last(path: str) -> str:
    return path.rpartition("/")[2].partition("[")[0]


def paths(prefix: str, read: Mapping[str, str]) -> dict[str, str]:
    """The entries of a vocabulary below an element; an empty path is the element itself."""
    return {f"{prefix}/{path}" if path else prefix: names for path, names in read.items()}


def each(prefixes: Iterable[str], read: Mapping[str, str]) -> dict[str, str]:
    """The same entries below each of several elements."""
    return {path: names for prefix in prefixes for path, names in paths(prefix, read).items()}


_LIDAR = {
    "": "",
    "scan": "",
    "scan/horizontal": "",
    "scan/horizontal/samples": "",
    "scan/horizontal/min_angle": "",
    "scan/horizontal/max_angle": "",
    "scan/vertical": "",
    "scan/vertical/samples": "",
    "range": "",
    "range/min": "",
    "range/max": "",
}

SENSOR = {
    "": "name type",
    "pose": "relative_to degrees rotation_format",
    "update_rate": "",
    "topic": "",  # topics and frames of messages are named anew
    "gz_frame_id": "",
    "force_torque": "",
    "force_torque/frame": "",
    "force_torque/measure_direction": "",
    "camera": "name",
    "camera/pose": "relative_to degrees rotation_format",
    "camera/horizontal_fov": "",
    "camera/image": "",
    "camera/image/width": "",
    "camera/image/height": "",
    "camera/clip": "",
    "camera/clip/near": "",
    "camera/clip/far": "",
    "contact": "",
    "contact/collision": "",
    **{f"{tag}/{path}".rstrip("/"): names for tag in ("lidar", "ray") for path, names in _LIDAR.items()},
}
"""Paths below ``<sensor>`` and the attributes that are read."""
