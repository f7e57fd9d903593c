"""Sizes that an MJCF declares in a few digits, and for which MuJoCo reserves memory before it reads anything else."""

from collections.abc import Iterator
from math import prod
from typing import Any

_MOST = {
    "hfield": (("nrow", "ncol"), 1 << 24),
    "texture": (("width", "height"), 1 << 26),
    "replicate": (("count",), 1 << 14),
    "composite": (("count",), 1 << 16),
    "flexcomp": (("count",), 1 << 18),
}
"""For each element the attributes whose numbers are multiplied, and the largest product."""
_SIZES = {"nkey": 1 << 12, "njmax": 1 << 20, "nconmax": 1 << 20, "nstack": 1 << 27}
_USER_DATA = 1 << 12
"""Largest number of values that ``<size nuser_...>`` gives to each body, geom, ... of the model."""
_MEMORY = 1 << 30
"""Largest arena [bytes] that ``<size memory>`` asks for."""
_UNITS = {"K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40, "P": 1 << 50, "E": 1 << 60}


def excessive_sizes(root: Any) -> Iterator[tuple[Any, str]]:
    """Elements of an MJCF that declare more than stepbot loads, each with the reason.

    Args:
        root: The root, an ``lxml.etree._Element``.
    """
    for tag, (attributes, most) in _MOST.items():
        for element in root.iter(tag):
            numbers = [number for name in attributes for number in _numbers(element.get(name, ""))]
            if prod(numbers) > most:
                yield element, f"<{tag}> with {prod(numbers):.3g} values; at most {most} are loaded"
    for element in root.iter("size"):
        for name, text in element.attrib.items():
            most = _MEMORY if name == "memory" else _USER_DATA if name.startswith("nuser_") else _SIZES.get(name, 0)
            number = _bytes(text) if name == "memory" else max(_numbers(text), default=0.0)
            if most and number > most:
                yield element, f"<size {name}> of {number:.3g}; at most {most} is loaded"


def _numbers(text: str) -> list[float]:
    """The numbers of a text; those that are none are left to MuJoCo."""
    found = []
    for word in text.split():
        try:
            found.append(abs(float(word)))
        except ValueError:
            continue
    return found


def _bytes(text: str) -> float:
    unit = _UNITS.get(text.strip()[-1:].upper(), 1)
    return max(_numbers(text.strip().rstrip("KMGTPEkmgtpe")), default=0.0) * unit
