"""Every way to remove one element or one attribute of an XML file."""

import re
from collections.abc import Iterator
from typing import Any

from lxml import etree
from msgspec import Struct

UNREAD = {
    "urdf": ("ros2_control", "gazebo", "transmission"),
    "sdf": ("ambient", "plugin", "sensor"),
    "drake.sdf": ("ambient", "plugin", "sensor"),
    "mjcf": (),
}
"""Blocks that no engine reads, by format; counted separately."""
_SETTINGS = re.compile(
    r"mujoco/option(@.*)?|default/(equality|site)(@.*)?|default/geom@(solref|solimp)|(body/site|equality/.*)@class"
)
"""Settings of simulations and viewers in MJCF, by kind, which are not of the robot: they count with the blocks."""


class Removal(Struct, frozen=True):
    """A removal from a file."""

    path: str
    """Place: tags down from the root, with names of elements that have them."""
    kind: str
    """Kind: ``element`` or ``element@attribute``, with the tag of the element above, for tables."""
    unread: bool
    """Whether it is in a block that no engine reads, or a setting that is not of the robot."""
    content: bytes
    """The file without it."""


def removals(content: bytes, written_in: str) -> Iterator[Removal]:
    """Each element except the root, with its content, and each attribute, one at a time, in file order."""
    count = sum(1 for _ in _elements(etree.fromstring(content)))
    for index in range(count):
        for attribute in (None, *_elements_at(content, index).attrib):
            element = _elements_at(content, index)
            above, path, kind = element.getparent(), path_of(element), kind_of(element)
            blocks = {_tag(one) for one in (element, *element.iterancestors())}
            unread = bool(blocks & set(UNREAD[written_in]))
            top = element.getroottree()
            if attribute is not None:
                del element.attrib[attribute]
                path, kind = f"{path}@{attribute}", f"{kind}@{attribute}"
            elif above is not None:
                above.remove(element)
            else:
                continue
            unread = unread or (written_in == "mjcf" and _SETTINGS.fullmatch(kind) is not None)
            yield Removal(path, kind, unread, etree.tostring(top, encoding="UTF-8", xml_declaration=True))


def _elements(top: Any) -> Iterator[Any]:
    return (element for element in top.iter() if isinstance(element.tag, str))


def _elements_at(content: bytes, index: int) -> Any:
    """The element with a number, in a separate tree that may be changed."""
    return list(_elements(etree.fromstring(content)))[index]


def _tag(element: Any) -> str:
    return str(etree.QName(element).localname)


def kind_of(element: Any) -> str:
    """The tag of an element after that of the element above."""
    above = element.getparent()
    return _tag(element) if above is None else f"{_tag(above)}/{_tag(element)}"


def path_of(element: Any) -> str:
    """Tags down from the root, with names of elements that have them."""
    steps = []
    for one in (element, *element.iterancestors()):
        name = one.get("name") or one.get("class") or ""
        steps.append(_tag(one) + (f"[{name}]" if name else ""))
    return "/".join(reversed(steps))
