"""``<robot>.lock.json``: the snapshot with which a sidecar was last confirmed.

One line per record, for readable differences in version control; the same input gives the same bytes. Its schema is
``schemas/lock-1.schema.json``.
"""

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any, TypeVar

from stepbot.diagnostics import Diagnostics, Span
from stepbot.geometry.spatial import Vector3
from stepbot.runtime.file import open_regular

from .snapshot import Joint, Part, Reference, Shape, Snapshot

_T = TypeVar("_T")


@dataclass
class Invalid(Exception):
    """The content has the wrong type or structure."""

    what: str
    line: int = 0

    def __str__(self) -> str:
        return self.what


class Record:
    """A JSON object with its position; values of a wrong type are errors."""

    def __init__(self, value: object, where: str) -> None:
        if not isinstance(value, dict):
            raise Invalid(f"{where or 'top level'}: expected an object")
        self._value: Json = value
        self._where = where

    @property
    def keys(self) -> list[str]:
        """All keys."""
        return list(self._value)

    def place(self, key: str) -> str:
        """The path from the root to the value at a key."""
        return f"{self._where}.{key}" if self._where else key

    def record(self, key: str) -> "Record":
        """The object at a key."""
        return Record(self._get(key), self.place(key))

    def records(self, key: str, made: "Callable[[Record], _T]") -> tuple[_T, ...]:
        """The list of objects at a key, each converted."""
        return tuple(made(Record(one, f"{self.place(key)}[{i}]")) for i, one in enumerate(self._listed(key)))

    def text(self, key: str) -> str:
        """The text at a key."""
        return self._typed(key, self._get(key), str, "text")

    def texts(self, key: str) -> tuple[str, ...]:
        """The list of texts at a key."""
        return tuple(self._typed(key, one, str, "text") for one in self._listed(key))

    def flag(self, key: str) -> bool:
        """The truth value at a key."""
        return self._typed(key, self._get(key), bool, "true or false")

    def integer(self, key: str) -> int:
        """The whole number at a key."""
        value = self._get(key)
        if isinstance(value, bool):
            raise Invalid(f"{self.place(key)}: expected a whole number")
        return self._typed(key, value, int, "a whole number")

    def number(self, key: str) -> float:
        """The finite number at a key."""
        return self._number(key, self._get(key))

    def numbers(self, key: str, count: int) -> list[float]:
        """The list of a given number of numbers at a key."""
        return [self._number(key, one) for one in self._listed(key, count)]

    def vector(self, key: str) -> Vector3:
        """The three numbers at a key."""
        return self._vector(key, self._get(key))

    def vectors(self, key: str, count: int) -> list[Vector3]:
        """The list of a given number of vectors at a key."""
        return [self._vector(key, one) for one in self._listed(key, count)]

    def is_null(self, key: str) -> bool:
        """Whether the value at a key is null."""
        return self._get(key) is None

    def _get(self, key: str) -> object:
        if key not in self._value:
            raise Invalid(f"{self.place(key)}: missing")
        return self._value[key]

    def _listed(self, key: str, count: int | None = None) -> list[object]:
        value: list[object] = self._typed(key, self._get(key), list, "a list")
        if count is not None and len(value) != count:
            raise Invalid(f"{self.place(key)}: expected {count} values")
        return value

    def _vector(self, key: str, value: object) -> Vector3:
        values: list[object] = self._typed(key, value, list, "three numbers")
        if len(values) != 3:
            raise Invalid(f"{self.place(key)}: expected three numbers")
        x, y, z = (self._number(key, one) for one in values)
        return x, y, z

    def _number(self, key: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not _is_finite(value):
            raise Invalid(f"{self.place(key)}: expected a number")
        return float(value)

    def _typed(self, key: str, value: object, kind: type[_T], words: str) -> _T:
        if not isinstance(value, kind):
            raise Invalid(f"{self.place(key)}: expected {words}")
        return value


def _is_finite(value: float) -> bool:
    try:
        return isfinite(value)
    except OverflowError:
        return False


VERSION = 1
"""Version of the schema."""
LARGEST_FILE = 1 << 26
"""Maximum size [bytes] of a file."""
_DIGEST = re.compile("[0-9a-f]{40}")

Json = dict[str, Any]


def lock_bytes(snapshot: Snapshot) -> bytes:
    """The lock as UTF-8, one record on a line."""
    head = {
        "version": VERSION,
        "robot": snapshot.robot,
        "step": {"file": snapshot.source, "blake2b": snapshot.digest},
    }
    lists: dict[str, list[Json]] = {
        "shapes": [_shape_record(one) for one in snapshot.shapes],
        "parts": [_part_record(one) for one in snapshot.parts],
        "joints": [_joint_record(one) for one in snapshot.joints],
        "references": [{"path": one.path, "components": list(one.components)} for one in snapshot.references],
    }
    lines = [f"  {_line(key)}: {_line(value)}" for key, value in head.items()]
    for key, records in lists.items():
        body = ",\n".join(f"    {_line(record)}" for record in records)
        lines.append(f"  {_line(key)}: [\n{body}\n  ]" if records else f"  {_line(key)}: []")
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode("utf-8", "backslashreplace")


def read_lock(path: Path, robot: str, found: Diagnostics) -> Snapshot | None:
    """The lock at a path; None if it is missing or unusable, which is reported (SB013 to SB015).

    Args:
        robot: Name of the expected robot.
    """
    span = Span(path.as_posix())
    remedy = [f"restore '{path.name}' from version control, or replace it with `stepbot lock`"]
    try:
        with open_regular(path) as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        return None
    except OSError as error:
        found.add("SB013", f"cannot read the lock file: {error.strerror or error}", span, help=remedy)
        return None
    try:
        document = _parsed(content)
        version = Record(document, "").integer("version")
        if version > VERSION:
            help = ["upgrade stepbot, or replace the lock file with `stepbot lock`"]
            found.add(
                "SB013", f"lock file has version {version}; the newest supported version is {VERSION}", span, help=help
            )
            return None
        lock = _snapshot(document)
    except Invalid as error:
        found.add("SB013", f"invalid lock file: {error}", Span(path.as_posix(), error.line), help=remedy)
        return None
    if lock.robot != robot:
        help = ["replace it with `stepbot lock`, or delete it"]
        found.add("SB015", f"lock file ignored: it belongs to robot '{lock.robot}', not '{robot}'", span, help=help)
        return None
    return lock


def _line(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def _shape_record(shape: Shape) -> Json:
    record: Json = {"kind": shape.kind, "faces": dict(shape.faces), "basis": shape.basis}
    return {
        **record,
        "measure": shape.measure,
        "com": list(shape.com),
        "inertia": list(shape.inertia),
        "error": shape.error,
    }


def _part_record(part: Part) -> Json:
    return {
        "path": part.path,
        "by_ordinal": part.by_ordinal,
        "link": part.link,
        "shape": part.shape,
        "mass": part.mass,
        "density": part.density,
        "material": part.material,
        "position": list(part.position),
        "rotation": [list(row) for row in part.rotation],
        "box": [list(corner) for corner in part.box],
    }


def _joint_record(joint: Joint) -> Json:
    return {
        "name": joint.name,
        "kind": joint.kind,
        "parent": joint.parent,
        "child": joint.child,
        "origin": list(joint.origin),
        "axis": None if joint.axis is None else list(joint.axis),
    }


def _parsed(content: bytes) -> object:
    if len(content) > LARGEST_FILE:
        raise Invalid(f"larger than {LARGEST_FILE >> 20} MiB")
    try:
        return json.loads(content.decode("utf-8"))
    except UnicodeDecodeError:
        raise Invalid("not UTF-8") from None
    except json.JSONDecodeError as error:
        raise Invalid(f"not JSON: {error.msg}", error.lineno) from None
    except (RecursionError, ValueError):
        raise Invalid("not JSON that a lock may hold") from None


def _snapshot(document: object) -> Snapshot:
    root = Record(document, "")
    step = root.record("step")
    shapes = root.records("shapes", _shape)

    def part(record: Record) -> Part:
        shape = record.integer("shape")
        if not 0 <= shape < len(shapes):
            raise Invalid(f"{record.place('shape')}: no shape {shape}")
        a, b, c = record.vectors("rotation", 3)
        low, high = record.vectors("box", 2)
        mass = None if record.is_null("mass") else record.number("mass")
        return Part(
            *(record.text("path"), shape, record.vector("position"), (a, b, c), (low, high), record.number("density")),
            *(record.text("material"), record.flag("by_ordinal"), record.text("link"), mass),
        )

    digest = step.text("blake2b")
    if not _DIGEST.fullmatch(digest):
        raise Invalid(f"{step.place('blake2b')}: expected 40 hexadecimal digits")
    return Snapshot(
        *(step.text("file"), digest, shapes, root.records("parts", part), root.text("robot")),
        *(root.records("joints", _joint), root.records("references", _reference)),
    )


def _shape(record: Record) -> Shape:
    faces = record.record("faces")
    return Shape(
        record.text("kind"),
        tuple(sorted((kind, faces.integer(kind)) for kind in faces.keys)),
        record.text("basis"),
        record.number("measure"),
        record.vector("com"),
        tuple(record.numbers("inertia", 6)),
        record.number("error"),
    )


def _joint(record: Record) -> Joint:
    return Joint(
        *(record.text("name"), record.text("kind"), record.text("parent"), record.text("child")),
        record.vector("origin"),
        None if record.is_null("axis") else record.vector("axis"),
    )


def _reference(record: Record) -> Reference:
    return Reference(record.text("path"), record.texts("components"))
