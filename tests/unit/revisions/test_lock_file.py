"""Lock files are read back as written; an invalid one is an error with its place."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from msgspec.structs import replace

from stepbot.assemble.bound import PlacedJoint
from stepbot.diagnostics import Diagnostics
from stepbot.revisions import lock_path
from stepbot.revisions.lock_file import lock_bytes, read_lock
from stepbot.revisions.snapshot import Part, Reference, Shape, Snapshot

SCHEMA = Path(__file__).parents[3] / "schemas" / "lock-1.schema.json"
LOCK = Snapshot(
    "arm.step",
    "0123456789abcdef0123456789abcdef01234567",
    (Shape("solid", (("plane", 6),), "exact", 1.25e-5, (0.1, 0.0, -1e-9), (1.0, 2.0, 3.0, 0.0, -0.5, 0.0), 1e-9),),
    (
        Part("base/plate", 0, box=((0.0, 0.0, 0.0), (0.1, 0.2, 0.3)), density=2700.0, link="base", mass=0.03375),
        Part('base/\u043f\u043b\u0438\u0442\u0430 "#1"', 0, (0.0, 1.0, 2.0), by_ordinal=True),
    ),
    "arm",
    (
        PlacedJoint("hinge", "revolute", "base", "arm", (0.0, 0.1, 0.2), (0.0, 0.0, 1.0)),
        PlacedJoint("ball", "ball", "a", "b", (0, 0, 0)),
    ),
    (Reference("**/plate", ("base/plate",)),),
)


def read(path: Path, content: bytes, robot: str = "arm") -> tuple[Snapshot | None, list[tuple[str, str]]]:
    """The content of a lock file, and the codes and messages of its errors."""
    path.write_bytes(content)
    diagnostics = Diagnostics()
    return read_lock(path, robot, diagnostics), [(one.code, one.message) for one in diagnostics]


def test_what_was_written_is_read_back(tmp_path: Path) -> None:
    """All values are read back, and the file conforms to the schema."""
    content = lock_bytes(LOCK)
    assert read(tmp_path / "arm.lock.json", content) == (LOCK, [])
    jsonschema.validate(json.loads(content), json.loads(SCHEMA.read_text(encoding="utf-8")))
    empty = replace(LOCK, shapes=(), parts=(), joints=(), references=())
    assert read(tmp_path / "arm.lock.json", lock_bytes(empty)) == (empty, [])


def test_each_record_is_one_line() -> None:
    """Each record is one line, for diffs of version control."""
    moved = replace(LOCK, parts=(replace(LOCK.parts[0], position=(1.0, 0.0, 0.0)), LOCK.parts[1]))
    before, after = (lock_bytes(one).splitlines() for one in (LOCK, moved))
    assert sum(a != b for a, b in zip(before, after, strict=True)) == 1


def test_no_lock_is_no_error(tmp_path: Path) -> None:
    """A missing lock is not reported."""
    diagnostics = Diagnostics()
    assert read_lock(tmp_path / "arm.lock.json", "arm", diagnostics) is None
    assert not list(diagnostics)


@pytest.mark.parametrize("name", ["arm.robot.yaml", "arm.robot.yml", "arm.yaml"])
def test_lock_has_the_name_of_its_sidecar(name: str) -> None:
    """The lock is named after its sidecar, for any suffix."""
    assert lock_path(Path("folder") / name) == Path("folder/arm.lock.json")
    assert lock_path(Path("robot.yaml")) == Path("robot.lock.json")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "not JSON"),
        (b"\xff", "not UTF-8"),
        (b"[]", "top level: expected an object"),
        (b"{}", "version: missing"),
        (b'{"version": true}', "version: expected a whole number"),
        (b'{"version": 1}', "step: missing"),
        (b"[" * 100_000, "not JSON that a lock may hold"),
        (b'{"version": ' + b"9" * 5000 + b"}", "not JSON that a lock may hold"),
    ],
)
def test_broken_files_are_errors(content: bytes, words: str, tmp_path: Path) -> None:
    """Invalid content is one error with the reason."""
    lock, ((code, message),) = read(tmp_path / "arm.lock.json", content)
    assert lock is None
    assert code == "SB013"
    assert words in message


@pytest.mark.parametrize(
    ("keys", "value", "words"),
    [
        (("parts", 0, "position"), [0, 0], "parts[0].position: expected three numbers"),
        (("parts", 1, "shape"), 99, "parts[1].shape: no shape 99"),
        (("shapes", 0, "measure"), "big", "shapes[0].measure: expected a number"),
        (("shapes", 0, "error"), 10**400, "shapes[0].error: expected a number"),
        (("shapes", 0, "inertia"), [1.0], "shapes[0].inertia: expected 6 values"),
        (("step", "blake2b"), "", "step.blake2b: expected 40 hexadecimal digits"),
        (("joints", 0, "axis"), [0, 0, None], "joints[0].axis: expected a number"),
        (("references",), {}, "references: expected a list"),
    ],
)
def test_wrong_values_are_errors(keys: tuple[Any, ...], value: Any, words: str, tmp_path: Path) -> None:
    """A value of a wrong type is an error that names its place."""
    document = at = json.loads(lock_bytes(LOCK))
    for key in keys[:-1]:
        at = at[key]
    at[keys[-1]] = value
    assert read(tmp_path / "arm.lock.json", json.dumps(document).encode()) == (
        None,
        [("SB013", f"invalid lock file: {words}")],
    )


def test_infinite_numbers_are_errors(tmp_path: Path) -> None:
    """NaN and Infinity, which Python's JSON reader accepts, are errors."""
    content = lock_bytes(LOCK).replace(b"2700.0", b"Infinity")
    assert read(tmp_path / "arm.lock.json", content)[1] == [
        ("SB013", "invalid lock file: parts[0].density: expected a number")
    ]


def test_locks_of_others_are_not_used(tmp_path: Path) -> None:
    """A later version is an error, another robot's lock a warning; neither is used."""
    path = tmp_path / "arm.lock.json"
    later = lock_bytes(LOCK).replace(b'"version": 1', b'"version": 2')
    assert [code for code, _ in read(path, later)[1]] == ["SB013"]
    lock, found = read(path, lock_bytes(LOCK), robot="leg")
    assert (lock, [code for code, _ in found]) == (None, ["SB015"])
