"""Nodes of VRML as Webots writes it: https://cyberbotics.com/doc/reference/nodes-and-functions."""

from collections.abc import Iterator, Sequence
from math import atan2, sqrt

from msgspec import Struct, field

from stepbot.geometry.spatial import Pose

from ..xml import number


class Node(Struct):
    """A node with its fields in the order of the file."""

    type: str
    fields: "list[tuple[str, str | Node | list[Node]]]" = field(default_factory=list)

    def set(self, name: str, value: "str | float | Sequence[float] | Node | list[Node]") -> "Node":
        """Add a field: text as it is, numbers, a node, or a list of nodes; returns the node itself."""
        if isinstance(value, int | float):
            value = number(value)
        elif not isinstance(value, str | Node | list):
            value = " ".join(map(number, value))
        self.fields.append((name, value))
        return self

    def place(self, X: Pose) -> "Node":
        """Add translation and rotation, unless they are the default; returns the node itself."""
        if any(X.position):
            self.set("translation", X.position)
        turned = axis_angle(X)
        if turned is not None:
            self.set("rotation", turned)
        return self

    def lines(self, indent: str = "") -> Iterator[str]:
        """The text of the node below its first line, which the caller writes up to the brace."""
        for name, value in self.fields:
            if isinstance(value, str):
                yield f"{indent}  {name} {value}"
            elif isinstance(value, Node):
                yield f"{indent}  {name} {value.type} {{"
                yield from value.lines(f"{indent}  ")
            else:
                yield f"{indent}  {name} ["
                for node in value:
                    yield f"{indent}    {node.type} {{"
                    yield from node.lines(f"{indent}    ")
                yield f"{indent}  ]"
        yield f"{indent}}}"


def text(value: str) -> str:
    """A string of VRML."""
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def axis_angle(X: Pose) -> tuple[float, float, float, float] | None:
    """The rotation of a pose as unit axis and angle [rad]; None for none."""
    w, x, y, z = X.quaternion
    length = sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return None
    scale = (-1.0 if w < 0.0 else 1.0) / length
    return (scale * x, scale * y, scale * z, 2.0 * atan2(length, abs(w)))
