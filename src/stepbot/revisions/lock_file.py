"""``<robot>.lock.json``: the snapshot with which a sidecar was last confirmed.

One line per record, for readable differences in version control; the same input gives the same bytes. Its schema is
``schemas/lock-1.schema.json``.
"""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar

from stepbot.assemble.bound import PlacedJoint
from stepbot.diagnostics import Diagnostics, Span
from stepbot.report.plain import Invalid, picked, unpicked, value_at
from stepbot.runtime.file import open_regular

from .snapshot import Part, Reference, Shape, Snapshot

T = TypeVar("T")
VERSION = 1
"""Version of the schema."""
LARGEST_FILE = 1 << 26
"""Maximum size [bytes] of a file."""
_DIGEST = re.compile("[0-9a-f]{40}")
_SHAPE = "kind faces basis measure com inertia error"
_PART = "path by_ordinal link shape mass density material position rotation box"
_JOINT = "name kind parent child origin axis"
_REFERENCE = "path components"


def lock_bytes(snapshot: Snapshot) -> bytes:
    """The lock as UTF-8, one record on a line."""
    head = {"version": VERSION, "robot": snapshot.robot, "step": {"file": snapshot.source, "blake2b": snapshot.digest}}
    lists: dict[str, list[dict[str, Any]]] = {
        "shapes": [picked(shape, _SHAPE, faces=dict(shape.faces)) for shape in snapshot.shapes],
        "parts": [picked(part, _PART) for part in snapshot.parts],
        "joints": [picked(joint, _JOINT) for joint in snapshot.joints],
        "references": [picked(reference, _REFERENCE) for reference in snapshot.references],
    }
    lines = [f"  {_line(key)}: {_line(value)}" for key, value in head.items()]
    for key, records in lists.items():
        body = ",\n".join(f"    {_line(record)}" for record in records)
        lines.append(f"  {_line(key)}: [\n{body}\n  ]" if records else f"  {_line(key)}: []")
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode("utf-8", "backslashreplace")


def read_lock(path: Path, robot: str, diagnostics: Diagnostics) -> Snapshot | None:
    """The lock of a robot at a path; None if it is missing or unusable, which is reported (SB013 to SB015)."""
    span = Span(path.as_posix())
    remedy = [f"restore '{path.name}' from version control, or replace it with `stepbot lock`"]
    try:
        with open_regular(path) as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        return None
    except OSError as error:
        diagnostics.add("SB013", f"cannot read the lock file: {error.strerror or error}", span, help=remedy)
        return None
    try:
        document = _parsed(content)
        version = value_at(document, "version", int)
        if version > VERSION:
            help = ["upgrade stepbot, or replace the lock file with `stepbot lock`"]
            message = f"lock file has version {version}; the newest supported version is {VERSION}"
            diagnostics.add("SB013", message, span, help=help)
            return None
        lock = _snapshot(document)
    except Invalid as error:
        diagnostics.add("SB013", f"invalid lock file: {error}", Span(path.as_posix(), error.line), help=remedy)
        return None
    if lock.robot != robot:
        help = ["replace it with `stepbot lock`, or delete it"]
        diagnostics.add(
            "SB015", f"lock file ignored: it belongs to robot '{lock.robot}', not '{robot}'", span, help=help
        )
        return None
    return lock


def _line(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


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
    step = value_at(document, "step", dict[str, object])
    digest = value_at(step, "blake2b", str, "step")
    if not _DIGEST.fullmatch(digest):
        raise Invalid("step.blake2b: expected 40 hexadecimal digits")
    shapes = tuple(_shape(one, where) for where, one in _listed(document, "shapes"))
    parts = _records(document, "parts", Part, _PART)
    for number, part in enumerate(parts):
        if not 0 <= part.shape < len(shapes):
            raise Invalid(f"parts[{number}].shape: no shape {part.shape}")
    return Snapshot(
        value_at(step, "file", str, "step"),
        digest,
        shapes,
        parts,
        value_at(document, "robot", str),
        _records(document, "joints", PlacedJoint, _JOINT),
        _records(document, "references", Reference, _REFERENCE),
    )


def _records(document: object, key: str, kind: type[T], keys: str) -> tuple[T, ...]:
    return tuple(unpicked(kind, one, keys, where) for where, one in _listed(document, key))


def _listed(document: object, key: str) -> Iterator[tuple[str, object]]:
    """The objects in a list, each with its place."""
    for number, one in enumerate(value_at(document, key, tuple[dict[str, object], ...])):
        yield f"{key}[{number}]", one


def _shape(document: object, where: str) -> Shape:
    faces = value_at(document, "faces", dict[str, int], where)
    return unpicked(Shape, document, _SHAPE, where, faces=tuple(sorted(faces.items())))
