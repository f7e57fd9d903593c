"""A folder for one command: its input, earlier output, and everything around them that it must not change.

Around the input are files of others, a named pipe, symbolic links, a loop of them, a folder without permission to
write, and a home. Only the output folder, the cache and the folder for temporary files may change.
"""

import hashlib
import os
import shutil
import stat
from pathlib import Path

from msgspec import Struct

WORK, OUTPUT, OUTSIDE, TEMPORARY, HOME = "work", "work/out", "outside", "tmp", "home"
_NOISE = bytes(range(256)) * 4
FOREIGN = ("notes.txt", "meshes/mine.obj")
"""Files of the user in the output folder."""


class Entry(Struct, frozen=True):
    """What is known of a file, a link, a folder or a pipe without following it."""

    mode: int
    """Type and permissions."""
    content: str
    """Hash of the content, or the target of a link."""
    modified: int
    """Time [ns] of the last change; 0 for folders, in which temporary files may be."""


def build(place: Path, base: Path, output: Path | None) -> None:
    """Make the sandbox in an empty folder.

    Args:
        place: The folder.
        base: Folder with the valid file and all that it refers to; copied.
        output: Earlier output; None for none.
    """
    work, outside = place / WORK, place / OUTSIDE
    shutil.copytree(base, work)
    for folder in (outside, place / TEMPORARY, place / HOME):
        folder.mkdir()
    (outside / "secret.stl").write_bytes(b"solid secret\nendsolid secret\n")
    (outside / "kept.txt").write_text("kept", encoding="utf-8")
    os.mkfifo(work / "pipe.stl")
    (work / "linked.stl").symlink_to(outside / "secret.stl")
    (work / "loop.stl").symlink_to("loop.stl")
    (work / "folder.stl").mkdir()
    (work / "empty.stl").touch()
    for suffix in ("obj", "stl", "dae"):
        (work / f"noise.{suffix}").write_bytes(_NOISE)
    if output is not None:
        shutil.copytree(output, place / OUTPUT, symlinks=True)
        for name in FOREIGN:
            (place / OUTPUT / name).parent.mkdir(exist_ok=True)
            (place / OUTPUT / name).write_text("mine", encoding="utf-8")
        (place / OUTPUT / "elsewhere").symlink_to(outside)


def entries(place: Path) -> dict[str, Entry]:
    """Everything in the sandbox except temporary files, by path."""
    found = {}
    for folder, folders, files in os.walk(place):
        for name in (*folders, *files):
            path = Path(folder) / name
            inside = path.relative_to(place).as_posix()
            if not inside.startswith(f"{TEMPORARY}/"):
                found[inside] = _entry(path)
    return found


def _entry(path: Path) -> Entry:
    status = path.lstat()
    if stat.S_ISLNK(status.st_mode):
        return Entry(status.st_mode, str(path.readlink()), status.st_mtime_ns)
    if stat.S_ISREG(status.st_mode):
        return Entry(status.st_mode, hashlib.sha256(path.read_bytes()).hexdigest(), status.st_mtime_ns)
    return Entry(status.st_mode, "", 0)


def changed(before: dict[str, Entry], after: dict[str, Entry], may_change: tuple[str, ...]) -> list[str]:
    """Entries that differ and must not.

    Args:
        before: Those before the command.
        after: Those after it.
        may_change: Paths of files and folders that the command writes, if it succeeds; empty if it fails.
    """
    allowed = tuple(f"{path}/" for path in may_change)
    users = {f"{OUTPUT}/{name}" for name in (*FOREIGN, "elsewhere")}
    faults = []
    for path in sorted(before.keys() | after.keys()):
        if before.get(path) == after.get(path):
            continue
        if path not in users and (path in may_change or path.startswith(allowed)):
            continue
        how = "is new" if path not in before else "is gone" if path not in after else "is another"
        faults.append(f"'{path[:200]}' {how}")
    return faults
