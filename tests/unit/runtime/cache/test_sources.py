"""The hash of source files, and when it is found without reading them."""

import os
import time
from pathlib import Path

import pytest

from stepbot.runtime.cache import Cache, sources
from stepbot.runtime.cache.sources import code_digest


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package whose files are a minute old."""
    (tmp_path / "package" / "room").mkdir(parents=True)
    for name in ("__init__.py", "room/one.py", "room/page.js"):
        _write(tmp_path / "package" / name, name)
    return tmp_path / "package"


@pytest.fixture
def reads(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The files that are read."""
    found: list[Path] = []
    original = Path.read_bytes

    def read_bytes(path: Path) -> bytes:
        found.append(path)
        return original(path)

    monkeypatch.setattr(Path, "read_bytes", read_bytes)
    return found


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
    minute_ago = time.time() - 60.0
    os.utime(path, (minute_ago, minute_ago))


def _pass_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the files that were just written be old: their time of change cannot be set."""
    monkeypatch.setattr(sources, "_SETTLED", -3600 * 10**9)


def test_unchanged_files_are_not_read_again(
    package: Path, tmp_path: Path, reads: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A second run finds the hash by sizes and times; it equals the one of a run without a cache."""
    _pass_time(monkeypatch)
    kept = Cache(tmp_path / "cache")
    first = code_digest(package, kept)
    assert {path.parent.name for path in reads} >= {"package", "room"}
    reads.clear()
    assert code_digest(package, kept) == first
    assert [path for path in reads if package in path.parents] == []
    assert code_digest(package, None) == first


@pytest.mark.parametrize("name", ["__init__.py", "room/one.py", "room/page.js", "room/two.py"])
def test_changed_or_new_file_is_other_code(
    package: Path, tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A change of the same size and the same time of modification is found, and so is a new file."""
    _pass_time(monkeypatch)
    kept = Cache(tmp_path / "cache")
    first, path = code_digest(package, kept), package / name
    before = path.stat() if path.exists() else None
    _write(path, name[::-1])
    if before is not None:
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    second = code_digest(package, kept)
    assert second != first
    assert second == code_digest(package, None)


def test_other_files_do_not_matter(package: Path, tmp_path: Path) -> None:
    """Bytecode and data are no source files."""
    first = code_digest(package, None)
    (package / "__pycache__").mkdir()
    (package / "__pycache__" / "one.py").write_text("", encoding="utf-8")
    (package / "robot.step").write_text("", encoding="utf-8")
    assert code_digest(package, None) == first


def test_hash_of_files_that_were_just_written_is_not_kept(package: Path, tmp_path: Path, reads: list[Path]) -> None:
    """A file that changes again within the resolution of its time would have the same stamp."""
    kept = Cache(tmp_path / "cache")
    code_digest(package, kept)
    assert kept.usage().entries == 0
    reads.clear()
    code_digest(package, kept)
    assert len([path for path in reads if package in path.parents]) == 3
