"""No file of the library has numeric residue: numbers that are 0 but for rounding errors."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from lxml import etree

from stepbot.geometry.inertia import RESIDUE as SHARE
from stepbot.geometry.spatial import RESIDUE
from tests.library.conftest import Converted, every_converted_robot

POSES = {"xyz", "rpy", "pos", "quat", "axis", "euler", "size", "range", "pose"}
_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


@every_converted_robot
def test_files_have_no_residue(robot: str, converted: Converted) -> None:
    """Coordinates and angles are 0 or at least 1e-12, products of inertia 0 or at least 1e-8 of the moments."""
    conversion = converted(robot)
    for suffix in (".urdf", ".sdf", ".xml"):
        file = conversion.file(suffix)
        vectors, inertias = list(_vectors(file)), list(_inertias(file))
        assert vectors
        assert inertias
        assert [text for text, values in vectors if any(0.0 < abs(value) < RESIDUE for value in values)] == []
        for xx, yy, zz, xy, xz, yz in inertias:
            scales = np.sqrt([xx * yy, xx * zz, yy * zz])
            shares = np.abs([xy, xz, yz])[scales > 0.0] / scales[scales > 0.0]
            assert shares[(shares > 0.0) & (shares < SHARE)].tolist() == [], file.name


def _vectors(file: Path) -> Iterator[tuple[str, list[float]]]:
    for node in etree.parse(file).iter(etree.Element):
        texts = [value for name, value in node.attrib.items() if name in POSES]
        texts += [node.text] if node.tag in ("pose", "xyz", "size") and node.text else []
        for text in texts:
            yield f"{file.name}: <{node.tag}> {text}", [float(word) for word in text.split() if _is_number(word)]


def _inertias(file: Path) -> Iterator[list[float]]:
    for node in etree.parse(file).iter("inertia", "inertial"):
        if "fullinertia" in node.attrib:
            yield [float(word) for word in node.attrib["fullinertia"].split()]
        elif "ixx" in node.attrib:
            yield [float(node.attrib.get(name, 0)) for name in _MOMENTS]
        elif node.find("ixx") is not None:
            yield [float(node.findtext(name) or 0) for name in _MOMENTS]


def _is_number(word: str) -> bool:
    return re.fullmatch(r"[-+]?[0-9.]+(e[-+]?[0-9]+)?", word) is not None
