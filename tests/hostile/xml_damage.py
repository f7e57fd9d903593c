"""Damage to a URDF, an SDFormat or an MJCF: to its elements, which are changed in place, or to its bytes.

Each kind is a function whose only choices are those of a random generator. Replacements come from the file itself, from
the vocabulary of all formats, and from special cases of XML, numbers, names and paths.
"""

import copy
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

from lxml import etree

Element = Any
"""``lxml.etree._Element``."""
XmlDamage = Callable[[Element, Random], None]
Slot = tuple[Element, str]
"""An element, and the name of an attribute; empty for its text."""

_NUMBERS = (
    "0", "-0.0", "1", "-1", "1e-300", "-1e-300", "1e300", "-1e300", "1e400", "5e-324", "nan", "NaN", "inf", "-inf",
    "1e39", "9" * 400, "0x10", "1_000", "1,5", "1/3", "1e", "+-1", "+1", " 1 ", ".5", "5.", "٣", "１", "²", "12 mm",
    "1.0f", "--1", "", " ", "1 2", "true", "1e9", "-1e9", "1e15", "3.14159", "2147483648", "-2147483649", "4294967296",
    "18446744073709551616", "100000000", "0.0000001",
)  # fmt: skip
_NAMES = (
    "", " ", "world", "__model__", "__root__", "a::b", "a/b", "../x", "/etc/passwd", ".", "..", "CON", "nul.obj",
    "x y", "naïve", "Ж", "\U0001f916", "\u202egnirts", "\u200b", "{0}", "%s%n", "<&\">'", "$(arg x)", "${x}", "a\tb",
    "a\nb", "n" * 300, "n" * 5000, "é" * 130, "none", "true", "null", "1", "-1", "nan", "base", "robot", "main",
    "model", "*", "~", "!!python/x", "a\\b", "C:\\x", "'", '"', "#", "é", "e\u0301",
)  # fmt: skip
_FILES = (
    "", ".", "..", "/", "/dev/zero", "/etc/passwd", "file:///etc/passwd", "http://127.0.0.1:9/x.stl",
    "model://x/y.dae", "package://", "package:///x.stl", "package://x", "package://../../x.stl",
    "../outside/secret.stl", "pipe.stl", "linked.stl", "loop.stl", "folder.stl", "absent.stl", "empty.stl",
    "noise.obj", "noise.stl", "noise.dae", "part.obj", "PART.OBJ", "m" * 300 + ".stl", "m/" * 3000 + "a.stl",
    "a\nb.stl", "\u202e.stl", "x.stl?y", "x.stl#y", "~/x.stl", "C:\\x.stl", "\\\\host\\x.stl", "part", "part.obj/",
    "data:;base64,aGk=", "fuel.ignitionrobotics.org/x", "self.urdf", "mutant.urdf", "mutant.sdf", "mutant.xml",
    "part.obj.gz", "$(find x)/y.stl", "%2e%2e/x.stl",
)  # fmt: skip
_WORDS = (
    "revolute", "continuous", "prismatic", "fixed", "floating", "planar", "ball", "universal", "screw", "gearbox",
    "hinge", "slide", "free", "spherical", "revolute2", "box", "sphere", "cylinder", "capsule", "ellipsoid", "mesh",
    "plane", "hfield", "sdf", "skin", "true", "false", "degree", "radian", "auto", "xyz", "ZYX", "motor", "imu",
    "camera", "lidar", "contact", "force_torque", "position", "velocity", "effort", "system", "1.4", "99", "-1", "2d",
    "cube", "none", "REVOLUTE",
)  # fmt: skip
_TAGS = (
    "link", "joint", "robot", "model", "world", "sdf", "mujoco", "body", "worldbody", "geom", "site", "frame",
    "inertial", "mass", "inertia", "origin", "pose", "visual", "collision", "geometry", "mesh", "box", "sphere",
    "cylinder", "capsule", "plane", "heightmap", "polyline", "ellipsoid", "parent", "child", "axis", "axis2", "limit",
    "dynamics", "mimic", "material", "color", "texture", "freejoint", "replicate", "composite", "flexcomp", "attach",
    "include", "default", "compiler", "option", "size", "asset", "tendon", "equality", "connect", "weld", "actuator",
    "position", "general", "sensor", "keyframe", "key", "gazebo", "transmission", "ros2_control", "plugin", "camera",
    "light", "contact", "exclude", "pair", "extension", "custom", "numeric", "visualize", "state", "static", "uri",
    "xyz", "a", "x-y", "Ж",
)  # fmt: skip
_KEYS = (
    "name", "type", "class", "childclass", "pos", "quat", "euler", "axisangle", "xyaxes", "zaxis", "xyz", "rpy",
    "quat_xyzw", "size", "fromto", "mesh", "file", "filename", "scale", "value", "mass", "density", "range", "ref",
    "joint", "body1", "body2", "site1", "relative_to", "expressed_in", "attached_to", "degrees", "rotation_format",
    "placement_frame", "count", "gear", "kp", "nrow", "vertex", "face", "qpos", "dir", "meshdir", "angle",
    "inertiafromgeom", "fusestatic", "discardvisual", "balanceinertia", "settotalmass", "canonical_link", "version",
    "link", "reference", "radius", "length", "user", "Ж",
)  # fmt: skip


def parse(data: bytes) -> Element:
    """The root of a valid file, without its comments."""
    return etree.fromstring(data, etree.XMLParser(remove_comments=True, remove_blank_text=True))


def dropped(root: Element, rng: Random) -> None:
    """Remove elements, attributes and texts."""
    for _ in range(rng.choice((1, 1, 2, 5))):
        element = rng.choice(_elements(root))
        if element.attrib and rng.random() < 0.5:
            del element.attrib[rng.choice(element.keys())]
        elif (element.text or "").strip() and rng.random() < 0.5:
            element.text = None
        elif element.getparent() is not None:
            element.getparent().remove(element)


def doubled(root: Element, rng: Random) -> None:
    """Duplicate elements, in place or elsewhere, with their names or with others."""
    for _ in range(rng.choice((1, 1, 3))):
        element = rng.choice(_elements(root))
        twin = copy.deepcopy(element)
        if rng.random() < 0.3:
            for one in twin.iter():
                if "name" in one.attrib:
                    one.set("name", one.get("name") + "_2")
        parent = element.getparent()
        target = parent if parent is not None and rng.random() < 0.7 else rng.choice(_elements(root))
        target.insert(rng.randrange(len(target) + 1), twin)


def renamed(root: Element, rng: Random) -> None:
    """Give elements and attributes other names: misspelt, of another element, of another format."""
    for _ in range(rng.choice((1, 1, 3))):
        element = rng.choice(_elements(root))
        if element.attrib and rng.random() < 0.5:
            key = rng.choice(element.keys())
            value = element.attrib.pop(key)
            element.set(rng.choice((key.upper(), key + "s", rng.choice(_KEYS), rng.choice(_keys(root)))), value)
        else:
            tag = str(element.tag)
            element.tag = rng.choice((tag.upper(), tag + "s", rng.choice(_TAGS), rng.choice(_elements(root)).tag))


def moved(root: Element, rng: Random) -> None:
    """Put elements elsewhere: into others, out of theirs, around theirs; replace one by another."""
    for _ in range(rng.choice((1, 1, 3))):
        element, other = rng.choice(_elements(root)), rng.choice(_elements(root))
        if element is root or other in element.iter():
            continue
        way = rng.randrange(4)
        if way == 0:
            other.insert(rng.randrange(len(other) + 1), element)
        elif way == 1 and other.getparent() is not None and element not in other.iter():
            other.getparent().replace(other, element)
        elif way == 2:
            wrapper = etree.SubElement(element.getparent(), rng.choice(_TAGS))
            wrapper.append(element)
        else:
            order = list(element.getparent())
            rng.shuffle(order)
            element.getparent()[:] = order


def swapped(root: Element, rng: Random) -> None:
    """Swap values of attributes and texts."""
    slots = _slots(root)
    for _ in range(rng.choice((1, 2, 5))):
        a, b = rng.choice(slots), rng.choice(slots)
        first, second = _value(a), _value(b)
        _put(a, second)
        _put(b, first)


def added(root: Element, rng: Random) -> None:
    """Add elements and attributes of any format, empty or with values of others."""
    for _ in range(rng.choice((1, 1, 3))):
        element = rng.choice(_elements(root))
        slot = element, rng.choice((rng.choice(_KEYS), rng.choice(_keys(root))))
        if rng.random() < 0.5:
            element = etree.Element(rng.choice(_TAGS))
            slot[0].insert(rng.randrange(len(slot[0]) + 1), element)
            slot = element, rng.choice(("", rng.choice(_KEYS)))
        pool = rng.choice((_NUMBERS, _NAMES, _WORDS, _FILES, ("0 0 0", "1 0 0 0", "0 0 0 0 0 0")))
        _put(slot, rng.choice((rng.choice(pool), _value(rng.choice(_slots(root))))))


def numbers(root: Element, rng: Random) -> None:
    """Replace numbers by huge, tiny, negative, infinite or non-numeric ones; add and remove some."""
    for slot in _some(root, rng, _is_numeric):
        words = _value(slot).split()
        way = rng.randrange(5)
        if way <= 2:
            words[rng.randrange(len(words))] = rng.choice(_NUMBERS)
        elif way == 3:
            words = words[: rng.randrange(len(words))] or [rng.choice(_NUMBERS)]
        else:
            words += [rng.choice((*_NUMBERS, *words))] * rng.choice((1, 1, 4, 200))
        _put(slot, " ".join(words))


def magnitudes(root: Element, rng: Random) -> None:
    """Multiply numbers by a power of ten, or change their sign; the file stays one, so that a robot may result."""
    for slot in _some(root, rng, _is_numeric):
        words = _value(slot).split()
        at = rng.randrange(len(words))
        words[at] = repr(float(words[at]) * rng.choice((-1.0, 0.0, 1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12, 1e100)))
        _put(slot, " ".join(words))


def words(root: Element, rng: Random) -> None:
    """Replace types, flags and other words by those of another kind."""
    for slot in _some(root, rng, lambda value: not _is_numeric(value)):
        _put(slot, rng.choice(_WORDS))


def references(root: Element, rng: Random) -> None:
    """Redirect references: links become their own parents, joints follow each other in cycles, frames likewise."""
    names = [element.get("name") for element in root.iter() if "name" in element.attrib] or ["x"]
    named = set(names)
    slots = [slot for slot in _slots(root) if slot[1] != "name" and _value(slot) in named]
    if not slots:
        return
    for slot in rng.sample(slots, min(len(slots), rng.choice((1, 1, 2, 4)))):
        _put(slot, rng.choice((rng.choice(names), rng.choice(names), rng.choice(_NAMES))))


def names(root: Element, rng: Random) -> None:
    """Rename an element with all references to it, or alone: empty, reserved, long, foreign, that of another."""
    slots = [(element, "name") for element in root.iter() if "name" in element.attrib]
    if not slots:
        return
    for slot in rng.sample(slots, min(len(slots), rng.choice((1, 1, 3)))):
        before, after = _value(slot), rng.choice((rng.choice(_NAMES), _value(rng.choice(slots))))
        everywhere = rng.random() < 0.7
        for one in [other for other in _slots(root) if _value(other) == before] if everywhere else [slot]:
            _put(one, after)


def files(root: Element, rng: Random) -> None:
    """Let meshes, textures and includes name files that are absent, broken, elsewhere, pipes, links or folders."""
    slots = [slot for slot in _slots(root) if slot[1] in ("file", "filename") or slot[0].tag == "uri"]
    if slots and rng.random() < 0.8:
        for slot in rng.sample(slots, min(len(slots), rng.choice((1, 1, 3)))):
            _put(slot, rng.choice(_FILES))
        return
    element = etree.Element(rng.choice(("include", "mesh", "texture", "hfield", "model", "plugin", "attach", "skin")))
    for key in rng.sample(("file", "filename", "name", "url", "plugin", "model"), 2):
        element.set(key, rng.choice(_FILES))
    if rng.random() < 0.5:
        etree.SubElement(element, "uri").text = rng.choice(_FILES)
    rng.choice(_elements(root)).append(element)


def nested(root: Element, rng: Random) -> None:
    """Nest an element in itself hundreds of times, or repeat it thousands of times; lengthen a list of numbers."""
    element = rng.choice(_elements(root))
    way = rng.randrange(4)
    if way == 0:
        small = copy.deepcopy(element) if len(list(element.iter())) < 8 else etree.Element(element.tag, element.attrib)
        for number in range(rng.choice((3, 60, 300, 2000))):
            twin = copy.deepcopy(small) if rng.random() < 0.5 else etree.Element(small.tag, dict(small.attrib))
            if "name" in twin.attrib:
                twin.set("name", f"{twin.get('name')}_{number}")
            element.append(twin)
            element = twin
    elif way == 1 and element.getparent() is not None and len(list(element.iter())) < 40:
        parent, renames = element.getparent(), rng.random() < 0.7
        for number in range(rng.choice((10, 300, 2000))):
            twin = copy.deepcopy(element)
            if renames and "name" in twin.attrib:
                twin.set("name", f"{twin.get('name')}_{number}")
            parent.append(twin)
    elif way == 2:
        slot = rng.choice(_slots(root))
        _put(slot, " ".join([_value(slot) or "0"] * rng.choice((50, 5000))))
    else:
        _put((element, rng.choice(_KEYS)), rng.choice("x0 ") * rng.choice((5000, 200_000)))


def spoiled_bytes(data: bytes, rng: Random) -> bytes:
    """Damage bytes, tags and encodings, add entities and doctypes, or remove the end."""
    cut = rng.randrange(len(data) + 1)
    way = rng.randrange(10)
    if way == 0:
        return data[:cut]
    if way == 1:
        return data[:cut] + rng.randbytes(rng.choice((1, 2, 8))) + data[cut:]
    if way == 2:
        flipped = bytearray(data)
        flipped[min(cut, len(data) - 1)] ^= 1 << rng.randrange(8)
        return bytes(flipped)
    if way == 3:
        text = data.decode("utf-8", "replace")
        return rng.choice((text.encode("utf-16"), text.encode("utf-32"), b"\xef\xbb\xbf" + data, data + bytes(99), b""))
    if way == 4:
        encoding = rng.choice(("utf-16", "latin-1", "utf-7", "x", "ebcdic-cp-us", "utf-8", ""))
        return f'<?xml version="{rng.choice(("1.0", "1.1", "2"))}" encoding="{encoding}"?>'.encode() + data
    if way == 5:
        doctype = b'<!DOCTYPE x [<!ENTITY e "1"><!ENTITY f "&e;&e;"><!ATTLIST link name CDATA "auto">]>'
        return doctype + data.replace(b'"0', b'"&f;', 1)
    if way == 6:
        return data.replace(b">", rng.choice((b">&undefined;", b"><![CDATA[x]]>", b"><?pi x?>", b"><!-- -- -->")), 1)
    if way == 7:
        return data.replace(b"<", rng.choice((b"<x:", b"< ", b"<<", b"</", b"<!")), rng.choice((1, 2)))
    if way == 8:
        return data + rng.choice((data, b"<x/>", b"x", b"\0", b"<!-- ", b"]]>"))
    pieces = data.split(b"<")
    at = rng.randrange(len(pieces))
    return b"<".join([*pieces[:at], *pieces[at + 1 :]])


def _elements(root: Element) -> list[Element]:
    return [element for element in root.iter() if isinstance(element.tag, str)]


def _keys(root: Element) -> list[str]:
    return [key for element in _elements(root) for key in element.attrib] or ["name"]


def _slots(root: Element) -> list[Slot]:
    return list(_all_slots(root)) or [(root, "name")]


def _all_slots(root: Element) -> Iterator[Slot]:
    for element in _elements(root):
        yield from ((element, str(key)) for key in element.attrib)
        if (element.text or "").strip():
            yield element, ""


def _value(slot: Slot) -> str:
    element, key = slot
    return str((element.get(key) if key else element.text) or "")


def _put(slot: Slot, value: str) -> None:
    element, key = slot
    if key:
        element.set(key, value)
    else:
        element.text = value


def _some(root: Element, rng: Random, wanted: Callable[[str], bool]) -> list[Slot]:
    found = [slot for slot in _slots(root) if wanted(_value(slot))]
    return rng.sample(found, min(len(found), rng.choice((1, 1, 2, 6))))


def _is_numeric(value: str) -> bool:
    try:
        return bool([float(word) for word in value.split()])
    except ValueError:
        return False


TREE_DAMAGE: dict[str, XmlDamage] = {
    "dropped": dropped,
    "doubled": doubled,
    "renamed": renamed,
    "moved": moved,
    "swapped": swapped,
    "added": added,
    "numbers": numbers,
    "magnitudes": magnitudes,
    "words": words,
    "references": references,
    "names": names,
    "files": files,
    "nested": nested,
}
KINDS = (*TREE_DAMAGE, "bytes", "mixed")


def damaged(base: Element, kind: str, rng: Random) -> bytes:
    """The bytes of a description with damage of a kind; the tree itself is not changed."""
    root = copy.deepcopy(base)
    if kind == "bytes":
        return spoiled_bytes(etree.tostring(root), rng)
    for one in [kind] if kind != "mixed" else rng.choices(list(TREE_DAMAGE), k=rng.choice((2, 3, 5))):
        TREE_DAMAGE[one](root, rng)
    data: bytes = etree.tostring(root)
    return spoiled_bytes(data, rng) if kind == "mixed" and rng.random() < 0.3 else data
