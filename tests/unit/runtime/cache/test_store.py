"""Cache entries in files: complete or absent, limited in size, with concurrent writers and crashes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from stepbot.runtime.cache import Cache, Digest


def key(name: object) -> str:
    """A realistic key."""
    return Digest("test").add(str(name)).key


def only_file(folder: Path) -> Path:
    """The one file below a folder."""
    (path,) = (path for path in folder.rglob("*") if path.is_file())
    return path


def test_what_was_put_is_got(tmp_path: Path) -> None:
    """Stored bytes are returned, in another process too; an unknown key returns nothing."""
    Cache(tmp_path).put(key(1), b"content")
    assert Cache(tmp_path).get(key(1)) == b"content"
    assert Cache(tmp_path).get(key(2)) is None
    assert Cache(tmp_path / "nowhere").get(key(1)) is None


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty", "longer", "other head"])
def test_broken_entry_is_a_miss(tmp_path: Path, damage: str) -> None:
    """A damaged entry is not used; writing it again repairs it."""
    cache = Cache(tmp_path)
    cache.put(key(1), bytes(1000))
    path = only_file(tmp_path)
    data = path.read_bytes()
    path.write_bytes(
        {
            "cut": data[:-1],
            "flipped": data[:500] + bytes([data[500] ^ 1]) + data[501:],
            "empty": b"",
            "longer": data + b"x",
            "other head": data.replace(b"entry 3", b"entry 2"),
        }[damage]
    )
    assert cache.get(key(1)) is None
    cache.put(key(1), bytes(1000))
    assert cache.get(key(1)) == bytes(1000)


def test_entry_under_a_wrong_name_is_a_miss(tmp_path: Path) -> None:
    """A renamed file is not used as an entry."""
    cache = Cache(tmp_path)
    cache.put(key(1), b"one")
    path = only_file(tmp_path)
    cache.put(key(2), b"two")
    (other,) = (p for p in tmp_path.rglob("*") if p.is_file() and p != path)
    other.replace(path)
    assert cache.get(key(1)) is None


def test_least_recently_used_go_first(tmp_path: Path) -> None:
    """Beyond the size limit the least recently used entries are removed."""
    cache = Cache(tmp_path, limit=100_000)
    for number in range(9):
        cache.put(key(number), bytes(10_000))
        os.utime(cache._path(key(number)), (number + 1, number + 1))
    assert cache.get(key(0)) is not None  # used just now
    cache.put(key(9), bytes(10_000))
    assert cache.usage().size <= 100_000
    left = [number for number in range(10) if cache.get(key(number)) is not None]
    assert left[0] == 0
    assert left[1:] == list(range(left[1], 10)), "the oldest are gone"
    assert left[1] > 1


def test_processes_share_the_check_of_the_size(tmp_path: Path) -> None:
    """The first entry of a process checks the size of all, unless a process has done so in the last minutes."""
    for number in range(20):
        Cache(tmp_path).put(key(number), bytes(10_000))
    Cache(tmp_path, limit=100_000).put(key(20), b"small")
    assert Cache(tmp_path).usage().size > 100_000
    os.utime(tmp_path / "entries-1", (1, 1))
    Cache(tmp_path, limit=100_000).put(key(21), b"small")
    assert Cache(tmp_path).usage().size <= 100_000
    os.utime(tmp_path / "entries-1", (1, 1))
    Cache(tmp_path).put(key(22), b"small")
    assert (tmp_path / "entries-1").stat().st_mtime > 1


def test_what_is_too_large_is_not_kept(tmp_path: Path) -> None:
    """An entry above the limit is not stored and removes no other."""
    cache = Cache(tmp_path, limit=1000)
    cache.put(key(1), bytes(900))
    assert cache.get(key(1)) is None
    assert not cache.trouble


def test_clear_removes_entries_and_nothing_else(tmp_path: Path) -> None:
    """`clear` keeps other files in the folder."""
    mine = tmp_path / "thesis.txt"
    mine.write_text("mine", encoding="utf-8")
    cache = Cache(tmp_path)
    for number in range(3):
        cache.put(key(number), b"content")
    assert cache.usage().entries == 3
    assert cache.clear().entries == 3
    assert cache.usage().entries == 0
    assert mine.exists()


def test_unwritable_folder_is_reported(tmp_path: Path) -> None:
    """A cache that cannot be written reports the reason, and all else works."""
    (tmp_path / "file").write_bytes(b"")
    cache = Cache(tmp_path / "file" / "cache")
    cache.put(key(1), b"content")
    assert "cannot write" in cache.trouble
    assert cache.get(key(1)) is None


def test_drafts_of_killed_processes_are_removed(tmp_path: Path) -> None:
    """Old unfinished files are removed, recent ones are kept."""
    cache = Cache(tmp_path)
    cache.put(key(1), b"content")
    folder = only_file(tmp_path).parent
    old, new = folder / ".new-old", folder / ".new-new"
    for draft in (old, new):
        draft.write_bytes(b"half")
    os.utime(old, (1, 1))
    cache.trim()
    assert not old.exists()
    assert new.exists()
    assert cache.usage().entries == 1


WRITER = """
import sys
from pathlib import Path
from stepbot.runtime.cache import Cache, Digest
cache = Cache(Path(sys.argv[1]), limit=400_000)
print("started", flush=True)
for round in range(int(sys.argv[2])):
    for number in range(40):
        key = Digest("test").add(str(number)).key
        content = bytes([number]) * 20_000
        kept = cache.get(key)
        assert kept in (None, content), "torn"
        cache.put(key, content)
"""


@pytest.mark.slow
def test_processes_at_once_and_one_killed(tmp_path: Path) -> None:
    """With four processes writing and removing the same entries, one of them killed, no partial entry is visible."""
    command = [sys.executable, "-c", WRITER, str(tmp_path)]
    victim = subprocess.Popen([*command, "100000"], stdout=subprocess.PIPE)
    others = [subprocess.Popen([*command, "6"], stdout=subprocess.PIPE, stderr=subprocess.PIPE) for _ in range(3)]
    assert victim.stdout is not None
    assert victim.stdout.readline().strip() == b"started"
    time.sleep(0.1)
    victim.send_signal(signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)
    victim.communicate()
    for other in others:
        _, errors = other.communicate(timeout=120)
        assert other.returncode == 0, errors.decode()
    cache = Cache(tmp_path, limit=400_000)
    cache.trim()
    assert 0 < cache.usage().size <= 400_000
    for number in range(40):
        assert cache.get(Digest("test").add(str(number)).key) in (None, bytes([number]) * 20_000)


POSIX = pytest.mark.skipif(os.name == "nt", reason="needs links and pipes")


@POSIX
@pytest.mark.parametrize("place", ["entries-1", "entries-1/{}", "entries-0"])
def test_links_are_not_followed(tmp_path: Path, place: str) -> None:
    """What is behind a link in place of a folder of the cache is neither used, nor removed, nor added to."""
    elsewhere, cache = tmp_path / "elsewhere", Cache(tmp_path / "cache", limit=1)
    Cache(elsewhere).put(key(1), b"content")
    link = cache.folder / place.format(key(1)[:2])
    link.parent.mkdir(parents=True)
    link.symlink_to(elsewhere / "entries-1" / (key(1)[:2] if "{" in place else ""))
    entry = only_file(elsewhere)
    before = (entry.read_bytes(), entry.stat().st_mtime_ns)
    is_used = place != "entries-0"
    assert cache.get(key(1)) is None
    cache = Cache(cache.folder)
    cache.put(key(1), b"content")
    assert bool(cache.trouble) == is_used
    cache.limit = 1
    cache.trim()
    cache.clear()
    assert only_file(elsewhere) == entry
    assert (entry.read_bytes(), entry.stat().st_mtime_ns) == before


@POSIX
@pytest.mark.parametrize("kind", ["pipe", "zero", "link"])
def test_entry_that_is_no_file(tmp_path: Path, kind: str) -> None:
    """A pipe, a device or a link in place of an entry is a miss at once; clearing leaves it, storing replaces it."""
    cache, elsewhere = Cache(tmp_path / "cache"), tmp_path / "elsewhere"
    cache.put(key(1), b"content")
    path = only_file(cache.folder)
    elsewhere.write_bytes(path.read_bytes())
    path.unlink()
    if kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/dev/zero" if kind == "zero" else elsewhere)
    assert cache.get(key(1)) is None
    assert cache.clear().entries == 0
    assert os.path.lexists(path)
    cache.put(key(1), b"content")
    assert cache.get(key(1)) == b"content"
    assert elsewhere.exists()


def test_files_of_others_stay(tmp_path: Path) -> None:
    """Clearing and trimming leave files with names that are not those of entries, wherever they are."""
    cache = Cache(tmp_path)
    cache.put(key(1), b"content")
    entry = only_file(tmp_path)
    others = [tmp_path / "notes", entry.parent / "notes.txt", tmp_path / "entries-1" / "my" / "thesis.tex"]
    for path in others:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"mine")
        os.utime(path, (1, 1))
    cache.limit = 0
    cache.trim()
    cache.clear()
    assert not entry.exists()
    assert all(path.read_bytes() == b"mine" for path in others)
