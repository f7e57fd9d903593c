"""URDF as every engine takes it: versions 1.1 and 1.2 as 1.0, and what the format defines stated.

Engines take a quaternion for no rotation, all but those of urdfdom 5.1, and differ in what a missing bound or mass is.

https://docs.ros.org/en/rolling/p/urdfdom/ defines what the versions add. MuJoCo, PyBullet, Drake and yourdfpy read the
capsules of 1.1 whatever version a file states, and ignore the limits of 1.2.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from math import hypot, inf
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from msgspec.structs import replace

from stepbot.geometry.spatial import Vector3, rotation_from_quaternion, rpy_from_rotation
from stepbot.robot.model import Limit
from stepbot.runtime.file import is_file
from stepbot.runtime.temporary import run_folder

from .observation import EngineRefused, Request
from .source_copy import locate
from .xml import with_readable_head, xml_root

Element = Any
"""``lxml.etree._Element``."""
Change = Callable[[Element], str]
"""Changes a file for an engine; returns what it did, or nothing."""

QUATERNION = "quat_xyzw"
EXTRA_LIMITS = ("acceleration", "deceleration", "jerk")
"""Attributes of ``<limit>`` in URDF 1.2, and fields of :class:`.Limit`."""
_RPY = f"rpy in place of {QUATERNION}, which this engine ignores"
_CYLINDERS = "cylinders in place of capsules, which this engine rejects"
_MASSES = "mass 0 of links without <inertial>, to which this engine gives a mass"
_NAMES = "names for materials without one, whose colours this engine would exchange"
_ENDLESS = "no bounds of continuous joints, by which PyBullet would limit them"
_VERSION = "an XML declaration that this engine reads"
_BOUNDS = "0 in place of the one bound that a limit lacks, as URDF defines"


class Newer(NamedTuple):
    """What a file has and readers of the version that it states ignore."""

    what: str
    needs: float
    """The version that added it."""
    line: int


def stated_version(robot: Element) -> float:
    """The version of a URDF; 1.0 if it states none, or no number."""
    try:
        return float(robot.get("version", "1.0"))
    except ValueError:
        return 1.0


def newer_than_stated(robot: Element) -> Iterator[Newer]:
    """The first of each kind of element or attribute that the stated version lacks, in the order of the versions."""
    stated = stated_version(robot)
    kinds = {
        f"attribute '{QUATERNION}'": (1.1, f"(link|joint)//origin[@{QUATERNION}]"),
        "<capsule>": (1.1, "link//geometry/capsule"),
        **{f"attribute '{name}' of <limit>": (1.2, f"joint/limit[@{name}]") for name in EXTRA_LIMITS},
    }
    for what, (needs, path) in kinds.items():
        elements = robot.xpath(path.replace("(link|joint)", "*[self::link or self::joint]")) if stated < needs else ()
        if elements:
            yield Newer(what, needs, elements[0].sourceline or 0)


def _rpy_of(origin: Element) -> Vector3:
    """The rotation of an ``<origin>`` with a quaternion.

    Raises:
        EngineRefused: The attribute is not four numbers with a direction.
    """
    try:
        x, y, z, w = (float(part) for part in origin.get(QUATERNION).split())
    except ValueError:
        x = y = z = w = 0.0
    whole = hypot(x, y, z, w)
    if not 0.0 < whole < inf:
        text = origin.get(QUATERNION)
        raise EngineRefused(f"line {origin.sourceline}: '{QUATERNION}' of <origin> is '{text}', not a rotation")
    return rpy_from_rotation(rotation_from_quaternion((w / whole, x / whole, y / whole, z / whole)))


def extra_limits(joint: Element) -> Limit:
    """The limits of a joint that URDF 1.2 adds, and no others."""
    limit = joint.find("limit")
    given = {} if limit is None else {name: limit.get(name) for name in EXTRA_LIMITS}
    return Limit(**{name: float(text) for name, text in given.items() if text is not None})


def with_rpy(robot: Element) -> bool:
    """Replace each quaternion by roll, pitch and yaw; returns whether there was one.

    Raises:
        EngineRefused: One is no rotation.
    """
    origins = robot.xpath(f"*[self::link or self::joint]//origin[@{QUATERNION}]")
    for origin in origins:
        origin.set("rpy", " ".join(map(repr, _rpy_of(origin))))
        del origin.attrib[QUATERNION]
    return bool(origins)


def _without_bounds_of_turns(robot: Element) -> bool:
    """Remove the bounds of continuous joints, which have no meaning; returns whether there was one."""
    limits = robot.xpath("joint[@type = 'continuous']/limit[@lower or @upper]")
    for limit in limits:
        for bound in {"lower", "upper"} & set(limit.keys()):
            del limit.attrib[bound]
    return bool(limits)


def _with_both_bounds(robot: Element) -> bool:
    """State 0 for one missing bound of a joint; returns whether there was one.

    MuJoCo would ignore the other one, PyBullet takes -1 for it.
    """
    limits = [one for one in robot.iterfind("joint/limit") if len({"lower", "upper"} & set(one.keys())) == 1]
    for limit in limits:
        limit.set("lower", limit.get("lower", "0"))
        limit.set("upper", limit.get("upper", "0"))
    return bool(limits)


def _with_named_materials(robot: Element) -> bool:
    """Name materials without a name, and those with another colour than the first of their name; returns whether any.

    The exporter of SolidWorks writes an empty name for all, and engines look for colours by name: ROS takes the first,
    PyBullet the last.
    """
    stated = [one for one in robot.iterfind("material") if one.find("color") is not None]
    stated += [one for one in robot.iterfind("link/visual/material") if one.find("color") is not None]
    colors = [(one.find("color").get("rgba") or "").split() for one in stated]
    first: dict[str, list[str]] = {}
    for one, color in zip(stated, colors, strict=True):
        first.setdefault(one.get("name") or "", color)
    own = [one for one, color in zip(stated, colors, strict=True) if color != first[one.get("name") or ""]]
    if any(not one.get("name") for one in own):
        own += [one for one in stated if not one.get("name") and one not in own]
    taken = {one.get("name") for one in robot.iter("material")}
    free = (name for number in count(1) if (name := f"material_{number}") not in taken)
    for one, name in zip(own, free, strict=False):
        one.set("name", name)
    return bool(own)


def without_inertial(robot: Element) -> list[Element]:
    """The links without ``<inertial>``, which have no mass as URDF defines."""
    return [link for link in robot.findall("link") if link.find("inertial") is None]


def _with_inertials(robot: Element) -> bool:
    """State the mass 0 of links without ``<inertial>``; returns whether there was one."""
    from lxml import etree

    links = without_inertial(robot)
    for link in links:
        inertial = etree.SubElement(link, "inertial")
        etree.SubElement(inertial, "mass", value="0")
        etree.SubElement(inertial, "inertia", dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0"))
    return bool(links)


@contextmanager
def readable(
    request: Request, *, capsules: bool = True, inertials: bool = True, changes: Sequence[Change] = ()
) -> Iterator[tuple[Request, tuple[str, ...]]]:
    """A request for a file that the engine reads, and a note if that is a copy; meshes have absolute paths in it.

    URDF 1.1 and 1.2 become URDF 1.0, and one bound that a limit lacks is 0.

    Args:
        capsules: Whether the engine reads capsules; for one that does not and reports no sizes they become cylinders.
        inertials: Whether a link without ``<inertial>`` has no mass in the engine; for one that invents it 0 is stated.
        changes: What the engine needs of files of any format, without another robot than it would report.
    """
    from lxml import etree

    file, is_urdf = Path(request.file), request.format == "urdf"
    top = xml_root(file) if (is_urdf or changes) and is_file(file) else None
    done = [] if top is None else [what for change in changes if (what := change(top))]
    if top is not None and is_urdf:
        done += _changed(top, capsules=capsules, inertials=inertials)
    if top is not None and (content := file.read_bytes()) != with_readable_head(content):
        done.append(_VERSION)
    if top is None or not done:
        yield request, ()
        return
    locate(top, file, ())
    with TemporaryDirectory(dir=run_folder()) as folder:
        copy = Path(folder) / file.name
        copy.write_bytes(etree.tostring(top, encoding="UTF-8", xml_declaration=True))
        yield replace(request, file=str(copy)), (f"read from a copy with {' and '.join(done)}",)


def _changed(top: Element, *, capsules: bool, inertials: bool) -> Iterator[str]:
    """Change what :func:`readable` states of a URDF, and name each change."""
    if with_rpy(top):
        yield _RPY
    round_ended = [] if capsules else top.findall("link//geometry/capsule")
    for capsule in round_ended:
        capsule.tag = "cylinder"
    if round_ended:
        yield _CYLINDERS
    if _without_bounds_of_turns(top):
        yield _ENDLESS
    if _with_both_bounds(top):
        yield _BOUNDS
    if _with_named_materials(top):
        yield _NAMES
    if not inertials and _with_inertials(top):
        yield _MASSES
