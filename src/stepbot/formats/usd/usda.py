"""USD's text format: prims, metadata and properties, https://openusd.org/release/spec_usda.html.

Most attributes of UsdPhysics and UsdGeom have single precision. Their numbers are written as the shortest text that
reads back as the same single; those of double precision as the same double.

Names of prims are identifiers, unique among siblings; a prim keeps a name that is not one as its ``displayName``.
"""

import re
from collections.abc import Iterable, Mapping

import numpy as np
from msgspec import Struct, field

from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Robot
from stepbot.version import __version__

from ..xml import number

UNITS: Mapping[str, float | str] = {"kilogramsPerUnit": 1.0, "metersPerUnit": 1.0, "upAxis": "Z"}
"""Metadata of all layers."""
INDENT = "    "


class Prim(Struct):
    """A prim: one node of the scene."""

    type: str
    """``Xform``, ``Mesh``; empty for none."""
    name: str
    """A valid identifier, unique among its siblings."""
    schemas: list[str] = field(default_factory=list)
    """Applied API schemas."""
    metadata: list[str] = field(default_factory=list)
    """Further metadata, as text."""
    properties: list[str] = field(default_factory=list)
    """Attributes and relationships, as text."""
    children: list["Prim"] = field(default_factory=list)
    specifier: str = "def"
    """``over`` for what a layer adds to a prim of another layer."""

    def add(self, child: "Prim") -> "Prim":
        """The child, after it was added."""
        self.children.append(child)
        return child

    def set(self, declaration: str, value: str) -> None:
        """Add an attribute, such as ``float physics:mass``, or a relationship."""
        self.properties.append(f"{declaration} = {value}")


def layer(top: Prim, doc: str = "", custom: Iterable[str] = ()) -> bytes:
    """The bytes of a layer with one root prim, its default one.

    Args:
        custom: Lines of further metadata.
    """
    metadata = [*custom, f"defaultPrim = {quoted(top.name)}", *([f"doc = {quoted(doc)}"] if doc else [])]
    metadata += [f"{key} = {quoted(one) if isinstance(one, str) else number(one)}" for key, one in UNITS.items()]
    lines = ["#usda 1.0", "(", *(INDENT + line for line in metadata), ")", "", *_lines(top, "")]
    return ("\n".join(lines) + "\n").encode()


def written_by(robot: Robot) -> str:
    """The documentation of a robot's layers."""
    return f"Written by stepbot {__version__}{f' from {robot.source}' if robot.source else ''}."


def _lines(prim: Prim, indent: str) -> Iterable[str]:
    words = [prim.specifier, *([prim.type] if prim.type else []), quoted(prim.name)]
    schemas = [f"prepend apiSchemas = [{', '.join(map(quoted, prim.schemas))}]"] if prim.schemas else []
    inside = [*schemas, *prim.metadata]
    yield indent + " ".join(words) + (" (" if inside else "")
    yield from (f"{indent}{INDENT}{line}" for line in inside)
    if inside:
        yield f"{indent})"
    yield f"{indent}{{"
    yield from (f"{indent}{INDENT}{line}" for line in prim.properties)
    for number_, child in enumerate(prim.children):
        if number_ or prim.properties:
            yield ""
        yield from _lines(child, indent + INDENT)
    yield f"{indent}}}"


def quoted(text: str) -> str:
    """A string with its quotation marks; control characters and quotation marks are escaped."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(f"\\x{ord(one):02x}" if ord(one) < 32 or ord(one) == 127 else one for one in escaped) + '"'


def asset_path(path: str) -> str:
    """A path of another file with its delimiters."""
    delimiter = "@@@" if "@" in path else "@"
    return f"{delimiter}{path}{delimiter}"


def single(value: float) -> str:
    """Shortest text that reads back as the same single; whole numbers without a point, no minus on zero.

    Raises:
        ValueError: Not a number.
    """
    rounded = np.float32(value)
    if np.isnan(rounded):
        raise ValueError("NaN cannot be written")
    return "0" if rounded == 0.0 else np.format_float_positional(rounded, trim="-")


def singles(values: Iterable[float]) -> str:
    """A tuple of singles."""
    return f"({', '.join(map(single, values))})"


def doubles(values: Iterable[float]) -> str:
    """A tuple of doubles."""
    return f"({', '.join(map(number, values))})"


_OTHER = re.compile(r"[^A-Za-z0-9_]")


class Names:
    """The names of the children of one prim."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)

    def of(self, name: str) -> str:
        """An identifier for a name, unique among those that were given."""
        plain = _OTHER.sub("_", name)
        return free_name(plain if not plain[:1].isdigit() else f"_{plain}", "_", self._taken)


def named(type_: str, name: str, names: Names, identifier: str = "") -> Prim:
    """A prim with a name of the robot.

    Args:
        name: Its name in the robot.
        names: Names of its siblings.
        identifier: Its identifier, if it has one already.
    """
    prim = Prim(type_, identifier or names.of(name))
    if prim.name != name:
        prim.metadata.append(f"displayName = {quoted(name)}")
    return prim
