"""VRML as Webots writes it: nodes with fields, PROTO declarations, DEF and USE.

https://cyberbotics.com/doc/reference/proto-definition
"""

import re
from typing import TypeAlias, Union

from msgspec import Struct, field

from stepbot.geometry.spatial import Pose, rotation_about

from ..observation import EngineCannotRead, EngineRefused

Value: TypeAlias = Union[str, float, "Node", list["Value"]]

_TOKEN = re.compile(r'"(?:\\.|[^"\\])*"|[\[\]{}]|[^\s,"\[\]{}#]+|#[^\n]*')
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\Z")
_MOST_NESTED = 200
_MOST_NODES = 1_000_000
"""Number of nodes after each USE is replaced by what it stands for."""


class Node(Struct):
    """A node; a field with one value has that value, and one with several a list."""

    type: str
    fields: dict[str, Value] = field(default_factory=dict)
    size: int = 1
    """Number of nodes in it, itself included; a node that is used twice counts twice."""

    def node(self, name: str) -> "Node | None":
        """The node in a field; None without one."""
        value = self.fields.get(name)
        return value if isinstance(value, Node) else None

    def nodes(self, name: str) -> list["Node"]:
        """The nodes in a field."""
        value = self.fields.get(name, [])
        return [one for one in (value if isinstance(value, list) else [value]) if isinstance(one, Node)]

    def numbers(self, name: str, default: tuple[float, ...] = ()) -> tuple[float, ...]:
        """The numbers in a field.

        Raises:
            EngineRefused: It has something else.
        """
        value = self.fields.get(name)
        if value is None:
            return default
        values = [one for one in (value if isinstance(value, list) else [value]) if isinstance(one, float)]
        if len(values) != (len(value) if isinstance(value, list) else 1) or (default and len(values) != len(default)):
            raise EngineRefused(f"{self.type}: field '{name}' is not {len(default) or 'a list of'} numbers")
        return tuple(values)

    def number(self, name: str, default: float) -> float:
        """The number in a field."""
        return self.numbers(name, (default,))[0]

    def text(self, name: str) -> str:
        """The string in a field; empty without one."""
        value = self.fields.get(name)
        quoted = isinstance(value, str) and value.startswith('"')
        return re.sub(r"\\(.)", r"\1", str(value)[1:-1]) if quoted else ""

    def pose(self) -> Pose:
        """The pose of the node in its parent."""
        x, y, z, angle = self.numbers("rotation", (0.0, 0.0, 1.0, 0.0))
        return Pose.of(rotation_about((x, y, z), angle), self.numbers("translation", (0.0, 0.0, 0.0)))


def read_proto(text: str) -> tuple[str, Node]:
    """The name of a PROTO and the node that it stands for, with the defaults of its parameters.

    Raises:
        EngineRefused: The text is not VRML.
        EngineCannotRead: It is no PROTO, or one with a template.
    """
    if not text.startswith("#VRML_SIM "):
        raise EngineRefused("the file does not begin with #VRML_SIM")
    tokens = [token for token in _TOKEN.findall(text) if not token.startswith("#")]
    if any(token.startswith("%") for token in tokens):
        raise EngineCannotRead("PROTOs with templates are not supported")
    reader = _Reader(tokens)
    while reader.next_is("EXTERNPROTO"):
        reader.take(2)
    if not reader.next_is("PROTO"):
        raise EngineCannotRead("the file declares no PROTO")
    _, name = reader.take(2)
    parameters = reader.parameters()
    reader.expect("{")
    body = reader.node(parameters)
    reader.expect("}")
    return name, body


class _Reader:
    """A sequence of tokens, read one after the other."""

    def __init__(self, tokens: list[str]) -> None:
        self._tokens, self._at, self._depth = tokens, 0, 0
        self._defined: dict[str, Node] = {}

    def next_is(self, *words: str) -> bool:
        return self._at < len(self._tokens) and self._tokens[self._at] in words

    def take(self, count: int) -> list[str]:
        taken = self._tokens[self._at : self._at + count]
        if len(taken) < count:
            raise EngineRefused("unexpected end of the file")
        self._at += count
        return taken

    def expect(self, word: str) -> None:
        (token,) = self.take(1)
        if token != word:
            raise EngineRefused(f"expected '{word}', not '{token}'")

    def parameters(self) -> dict[str, Value]:
        """The parameters of a PROTO with their defaults."""
        self.expect("[")
        parameters: dict[str, Value] = {}
        while not self.next_is("]"):
            _, _, name = self.take(3)
            parameters[name] = self._value({}, ("field", "unconnectedField", "vrmlField", "hiddenField", "]"))
        self.expect("]")
        return parameters

    def node(self, parameters: dict[str, Value]) -> Node:
        """A node, from its type on."""
        (word,) = self.take(1)
        name = ""
        if word == "USE":
            (name,) = self.take(1)
            if name not in self._defined:
                raise EngineRefused(f"USE of '{name}', which is not defined")
            return self._defined[name]
        if word == "DEF":
            name, word = self.take(2)
        self._depth += 1
        if self._depth > _MOST_NESTED:
            raise EngineCannotRead(f"nodes are nested deeper than {_MOST_NESTED}")
        node = Node(word)
        self.expect("{")
        while not self.next_is("}"):
            (field_name,) = self.take(1)
            if self.next_is("IS"):
                _, parameter = self.take(2)
                value = parameters.get(parameter)
                if value is None:
                    raise EngineRefused(f"IS '{parameter}', which is not a parameter")
                node.fields[field_name] = value
            else:
                node.fields[field_name] = self._value(parameters, ())
        self.expect("}")
        self._depth -= 1
        node.size += sum(one.size for name in node.fields for one in node.nodes(name))
        if node.size > _MOST_NODES:
            raise EngineCannotRead(f"more than {_MOST_NODES:,} nodes")
        if name:
            self._defined[name] = node
        return node

    def _value(self, parameters: dict[str, Value], ends: tuple[str, ...]) -> Value:
        """The value of a field: a list, a node, a word, a string or numbers up to the next word."""
        if self.next_is("["):
            self.expect("[")
            values = list[Value]()
            while not self.next_is("]"):
                values.append(self._single(parameters))
            self.expect("]")
            return values
        first = self._single(parameters)
        if not isinstance(first, float):
            return first
        numbers: list[Value] = [first]
        while not self.next_is(*ends, "}") and self._at < len(self._tokens) and _NUMBER.match(self._tokens[self._at]):
            numbers.append(float(self.take(1)[0]))
        return numbers if len(numbers) > 1 else first

    def _single(self, parameters: dict[str, Value]) -> Value:
        (word,) = self._tokens[self._at : self._at + 1] or [""]
        if _NUMBER.match(word):
            return float(self.take(1)[0])
        following = self._tokens[self._at + 1 : self._at + 2]
        if word in ("DEF", "USE") or following == ["{"]:
            return self.node(parameters)
        return self.take(1)[0]
