"""Numbers that descriptions of the field have and stepbot never writes: contacts, sensors, solvers, plugins, drives."""

import re
from collections.abc import Mapping
from pathlib import Path
from random import Random
from typing import Any

from lxml import etree

_EXTRAS = Path(__file__).with_name("extras.xml")
_NAMED: Mapping[str, Mapping[str, str]] = {
    "urdf": {"LINK": "link", "JOINT": "joint[@type='revolute' or @type='prismatic' or @type='continuous']"},
    "sdf": {"JOINT": "model/joint[axis]"},
    "mjcf": {
        "BODY": "worldbody//body",
        "HINGE": "worldbody//joint[not(@type) or @type='hinge' or @type='slide']",
        "ACTUATOR": "actuator/*",
        "GEOM": "worldbody//geom[@name][1]",
        "OTHER": "worldbody//geom[@name][last()]",
    },
}
"""What a word in the extras stands for: the name of an element at random."""


_SECTIONS = ("statistic", "visual", "size", "custom", "equality", "tendon", "actuator", "sensor", "contact")
"""Sections of an MJCF, which are there once."""


def with_extras(written_in: str, content: bytes, random: Random, share: float = 0.4) -> bytes:
    """A description with a share of its format's extras, with random numbers, where it has a place for them."""
    top = etree.fromstring(content)
    for extra in etree.parse(_EXTRAS).find(written_in):
        places = top.xpath(extra.get("place"))
        if places and random.random() < share:
            added = etree.fromstring(etree.tostring(extra[0]).strip())
            if _filled(written_in, top, added, random):
                _add(top, random.choice(places), added, alone=extra.tag == "in", random=random)
    return bytes(etree.tostring(top))


def _filled(written_in: str, top: Any, added: Any, random: Random) -> bool:
    """Put numbers and names into an extra; false where the description has nothing of a name's kind."""
    for element in added.iter():
        for name, text in element.items():
            element.set(name, _text(written_in, top, text, random))
        if element.text and element.text.strip():
            element.text = _text(written_in, top, element.text, random)
    return b"NOBODY" not in etree.tostring(added)


def _text(written_in: str, top: Any, text: str, random: Random) -> str:
    if text in _NAMED[written_in]:
        names = [one.get("name") for one in top.xpath(_NAMED[written_in][text]) if one.get("name")]
        return random.choice(names or ["NOBODY"])
    text = re.sub(r"\bR\b", lambda _: f"{random.uniform(0.05, 0.5):.4f}", text)
    return re.sub(r"\bN\b", lambda _: str(random.randint(2, 60)), text)


def _add(top: Any, place: Any, added: Any, *, alone: bool, random: Random) -> None:
    if not alone:
        place.attrib.update({name: text for name, text in added.items() if random.random() < 0.5})
        return
    present = place.find(added.tag) if place is top and added.tag in _SECTIONS else None
    if present is None:
        place.append(added)
    else:
        present.attrib.update(added.attrib)
        present.extend([*added])
