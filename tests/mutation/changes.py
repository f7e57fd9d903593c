"""Changes of a single number in a file, and which of them exceed the tolerance."""

import re
from collections.abc import Iterator, Sequence
from random import Random
from typing import Any

import numpy as np
from lxml import etree
from msgspec import Struct

from stepbot.engines.observation import Quantity
from stepbot.formats.lowering.joints import UNLIMITED
from stepbot.geometry.spatial import Pose, angle_between
from stepbot.verification.deviation import COLOR, TOLERANCES

from .removal import kind_of, path_of

PART = 0.01
"""Relative change of a number, unless its sign is changed."""
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_WHOLE = re.compile(r"(group|contype|conaffinity|count|resolution|width|height|samples)$")
"""Attributes with integers: changed by one, or in sign."""
_NO_NUMBERS = re.compile(r"(.*@(name|version|filename|file|type|key|class|mesh))$")
_ANY = TOLERANCES[Quantity.DYNAMICS]
_POSES, _SHAPES = TOLERANCES[Quantity.POSES].absolute, TOLERANCES[Quantity.MESHES].absolute
_ANGLE = TOLERANCES[Quantity.AXES].absolute


class Slot(Struct, frozen=True):
    """Numbers of one attribute or element."""

    path: str
    kind: str
    element: int
    """Number of the element in the file."""
    attribute: str
    """Empty for the text of the element."""
    words: tuple[str, ...]

    @property
    def is_whole(self) -> bool:
        """Whether the numbers are integers."""
        return _WHOLE.search(self.kind) is not None


def slots_of(content: bytes) -> list[Slot]:
    """Everything in a file that is made of numbers."""
    return list(_slots(etree.fromstring(content)))


class Change(Struct, frozen=True):
    """One number of a file, changed."""

    path: str
    """Place: tags down from the root, with names of elements that have them."""
    kind: str
    """``element`` or ``element@attribute``, with the tag of the element above, for tables."""
    old: str
    new: str
    content: bytes
    """The file with the change."""


def changes(content: bytes, seed: str) -> Iterator[Change]:
    """Changes of every number except zeros, in random order: by one part in a hundred, or in sign.

    Changes within the tolerance of their quantity, which leave the same robot, are omitted.
    """
    random = Random(seed)
    top = etree.fromstring(content)
    every = [(slot, index) for slot in _slots(top) for index, word in enumerate(slot.words) if float(word)]
    random.shuffle(every)
    for slot, index in every:
        old = slot.words[index]
        new = _other(slot, old, random)
        words = (*slot.words[:index], new, *slot.words[index + 1 :])
        if not _is_another(top, slot, words):
            continue
        changed = etree.fromstring(content)
        element = _elements(changed)[slot.element]
        if slot.attribute:
            element.set(slot.attribute, " ".join(words))
        else:
            element.text = " ".join(words)
        yield Change(slot.path, slot.kind, old, new, etree.tostring(changed, encoding="UTF-8", xml_declaration=True))


def _other(slot: Slot, old: str, random: Random) -> str:
    value = float(old)
    if random.random() < 0.5:
        return repr(-value) if "." in old or "e" in old.lower() else str(-int(value))
    if slot.is_whole:
        return str(int(value) + 1)
    return repr(value * (1.0 + PART))


def _elements(top: Any) -> list[Any]:
    return [element for element in top.iter() if isinstance(element.tag, str)]


def _slots(top: Any) -> Iterator[Slot]:
    for number, element in enumerate(_elements(top)):
        given = [("", element.text or ""), *element.attrib.items()]
        for attribute, text in given:
            words = tuple(text.split())
            kind = f"{kind_of(element)}@{attribute}" if attribute else kind_of(element)
            if words and not _NO_NUMBERS.match(kind) and all(_NUMBER.fullmatch(word) for word in words):
                where = f"{path_of(element)}@{attribute}" if attribute else path_of(element)
                yield Slot(where, kind, number, attribute, words)


def _is_another(top: Any, slot: Slot, words: Sequence[str]) -> bool:
    """Whether a change is beyond the tolerance of the quantity of the numbers."""
    old, new = ([float(word) for word in side] for side in (slot.words, words))
    off = max(abs(a - b) for a, b in zip(old, new, strict=True))
    kind = slot.kind
    if all(a == b or min(abs(a), abs(b)) >= UNLIMITED for a, b in zip(old, new, strict=True)) and min(new) > 0.0:
        return False  # a number that means unlimited, before and after
    if re.search(r"inertia(/i..|@i..)$|fullinertia$|diaginertia$", kind):
        return off > TOLERANCES[Quantity.INERTIA].allowed(_largest_moment(top, slot))
    if re.search(r"inertial/(pose|origin@xyz)$|inertial@pos$", kind):
        return off > TOLERANCES[Quantity.COM].allowed(_size(top, slot))
    if re.search(r"(rgba|ambient|diffuse|specular|emissive)$", kind):
        return off > COLOR.allowed(0.0)
    if re.search(r"(axis2?/xyz|axis2?@xyz|@axis)$", kind):
        return angle_between(old, new) > _ANGLE
    if kind.endswith("@quat"):
        return _turned(Pose.from_quaternion(_four(old)), Pose.from_quaternion(_four(new)))
    if kind.endswith("@rpy"):
        return _turned(Pose.from_xyz_rpy((0.0, 0.0, 0.0), old), Pose.from_xyz_rpy((0.0, 0.0, 0.0), new))
    if kind.endswith("/pose"):
        moved = max(abs(a - b) for a, b in zip(old[:3], new[:3], strict=True))
        X, Y = (Pose.from_xyz_rpy(side[:3], side[3:]) for side in (old, new))
        return moved > _length(kind) or _turned(X, Y)
    if re.search(r"(@pos|@xyz)$", kind):
        return off > _length(kind)
    if re.search(r"(box|cylinder|sphere|capsule)[/@]|geom@size|mesh[/@]scale", kind):
        return off > _SHAPES
    return off > _ANY.allowed(max(map(abs, old)))


def _length(kind: str) -> float:
    """Tolerance of a position [m]."""
    shape = re.search(r"(visual|collision)/(pose|origin)|geom@pos", kind)
    return _SHAPES if shape else _POSES


def _turned(X: Pose, Y: Pose) -> bool:
    return X.distance_to(Y)[1] > _ANGLE


def _four(values: Sequence[float]) -> tuple[float, float, float, float]:
    w, x, y, z = values
    return w, x, y, z


def _inertial(top: Any, slot: Slot) -> Any:
    element = _elements(top)[slot.element]
    return next(one for one in (element, *element.iterancestors()) if one.tag == "inertial")


def _moments(inertial: Any) -> list[float]:
    """All moments and products of inertia in an inertial."""
    texts = [inertial.get("fullinertia") or inertial.get("diaginertia") or ""]
    for inertia in inertial.findall("inertia"):
        texts += [*inertia.attrib.values(), *(one.text or "" for one in inertia)]
    return [float(word) for text in texts for word in text.split()]


def _largest_moment(top: Any, slot: Slot) -> float:
    return max(map(abs, _moments(_inertial(top, slot))))


def _size(top: Any, slot: Slot) -> float:
    """The size [m] of a link in the tolerance of its centre of mass: distance or radius of gyration."""
    inertial = _inertial(top, slot)
    mass = float(inertial.get("mass") or inertial.findtext("mass") or inertial.find("mass").get("value"))
    text = inertial.get("pos") or inertial.findtext("pose")
    text = text if text is not None else inertial.find("origin").get("xyz")
    distance = float(np.linalg.norm([float(word) for word in text.split()][:3]))
    inertia = inertial.find("inertia")
    if inertia is None:
        diagonal = _moments(inertial)[:3]
    else:
        diagonal = [float(inertia.get(name) or inertia.findtext(name)) for name in ("ixx", "iyy", "izz")]
    return max(distance, float(np.sqrt(max(sum(diagonal), 0.0) / (2.0 * mass)))) if mass else distance
