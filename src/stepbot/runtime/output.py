"""The one place that writes results to disk: all files of a run or none.

New files are made in a hidden folder beside their places and then moved there one by one, meshes first, the files that
refer to them last; a file that did not change is not touched. If one of them cannot be moved, those that were are moved
back. A process that is killed leaves every single file whole, old or new, and the next run puts things in order.

``.stepbot.json`` in the output folder lists each robot file and the meshes it needs, with a hash of what was written.
With it a later run removes meshes that nothing needs any more; what is not listed, or was changed since, is never
touched. It also names the sidecar of each robot file, so that ``stepbot uptodate`` finds what was written where, and it
is the stamp of the last run: newer than all input, also where no other file changed.
"""

import contextlib
import errno
import hashlib
import json
import os
import shutil
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any, NoReturn

from stepbot.diagnostics import Diagnostics, Span, StepbotError

from .folder_lock import LOCK, FolderInUse, locked

MANIFEST = ".stepbot.json"
_STAGING = ".stepbot-"
_ABANDONED_AFTER = 24 * 3600.0
"""Age [s] from which a staging folder belongs to a run that was killed."""
_LONGEST_WAIT = 60.0
"""For another run that writes into the same folder [s]."""
_NEVER_IN_NAMES = frozenset("\\\0")
_NEVER_IN_WINDOWS_NAMES = frozenset('<>:"|?*')

Manifest = dict[str, dict[str, str]]
"""For each file at the top of the folder itself and the files below that it needs, each with its SHA-256."""


def failed_output(folder: Path) -> Path:
    """Where the files of a run go that failed its checks: beside ``folder``, which keeps what it has."""
    return folder.parent / f"{folder.resolve().name}.failed"


def check_writable(folder: Path) -> None:
    """Find out before the work begins that a folder could not be written, or not be made; changes nothing.

    Raises:
        StepbotError: A file is in the way, or the right to write is missing (SB004).
    """
    nearest = next((path for path in (folder, *folder.absolute().parents) if os.path.lexists(path)), folder)
    if not nearest.is_dir():
        _refuse(folder, f"cannot write {folder}: '{nearest}' is not a folder")
    if not os.access(nearest, os.W_OK | os.X_OK):
        _refuse(folder, f"cannot write {folder}: no write permission in '{nearest}'")


def write_atomically(
    files: Mapping[str, bytes], folder: Path, sidecar: Path | None = None, found: Diagnostics | None = None
) -> None:
    """Write all files, or none.

    Files at the top of the folder are taken to need all of those in sub-folders; meshes that an earlier run wrote for
    the same files, and that are needed no more, are removed.

    Args:
        files: Content by path relative to ``folder``, with forward slashes.
        folder: Where to; made where it is missing.
        sidecar: What they were converted from. The list names it where it and ``folder`` are below the current folder;
            no path outside of a project gets into its files.
        found: Takes the note SB011 where the file system has no locks.

    Raises:
        StepbotError: A path is no path below ``folder``, or something cannot be written (SB004); nothing was changed.
    """
    for path in files:
        _check_path(path, folder)
    made: list[Path] = []
    try:
        _make_folders(folder, made)
        with locked(folder, _LONGEST_WAIT) as is_alone:
            if not is_alone and found is not None:
                message = "file system without locks: concurrent conversions into this folder are not detected"
                found.add("SB011", message, Span(str(folder)), help=["run one conversion at a time"])
            staging = Path(tempfile.mkdtemp(prefix=_STAGING, dir=folder))
            try:
                _check_case(files, staging, folder)
                _write(files, folder, staging, made, _from_folder(sidecar, folder))
            finally:
                shutil.rmtree(staging, ignore_errors=True)
    except FolderInUse as error:
        _refuse(folder, str(error), "wait until it has finished, or choose another folder with -o")
    except OSError as error:
        _refuse(folder, f"cannot write {error.filename or folder}: {error.strerror or error}")
    finally:
        for path_made in reversed(made):  # after an error they are empty
            _remove_if_empty(path_made)


def discard(folder: Path) -> None:
    """Remove what an earlier run wrote into a folder; what was changed since, or is not of stepbot, stays."""
    try:
        with locked(folder, _LONGEST_WAIT):
            _discard(folder)
    except FolderInUse as error:
        _refuse(folder, str(error), "wait until it has finished, or choose another folder with -o")
    except OSError:  # there is no such folder
        return


def _discard(folder: Path) -> None:
    for needs in _read_manifest(folder).values():
        for path, digest in needs.items():
            _remove_stale(folder, path, digest)
    try:
        if {path.name for path in folder.iterdir()} - {LOCK} == {MANIFEST}:
            (folder / MANIFEST).unlink()
            _remove_if_empty(folder)
    except OSError:  # there is no such folder
        return


def sidecars_of(folder: Path) -> dict[str, str]:
    """For each file at the top of an output folder the way from the folder to its sidecar, where the list has it."""
    try:
        sidecars = _listed(folder)["sidecars"]
        return {str(name): str(sidecar) for name, sidecar in sidecars.items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}


def stamp(folder: Path) -> None:
    """Make the list of an output folder newer than all input, where a run found that its files are what they should be.

    Raises:
        OSError: The list is there and its time cannot be set.
    """
    with contextlib.suppress(FileNotFoundError):
        os.utime(folder / MANIFEST)


def _from_folder(sidecar: Path | None, folder: Path) -> str:
    """The way from an output folder to a sidecar; empty where one of them is outside of the current folder."""
    if sidecar is None:
        return ""
    here, source, target = Path.cwd().resolve(), sidecar.resolve(), folder.resolve()
    if not (source.is_relative_to(here) and target.is_relative_to(here)):
        return ""
    return Path(os.path.relpath(source, target)).as_posix()


def _write(files: Mapping[str, bytes], folder: Path, staging: Path, made: list[Path], sidecar: str) -> None:
    before = _read_manifest(folder)
    _check_others(files, before, folder)
    after = {**before, **_manifest_of(files)}
    stale = _stale(before, after)
    # While files are on the move the manifest lists old and new, so that a killed run leaves nothing unknown behind.
    during = {**after, **{name: {**before.get(name, {}), **needs} for name, needs in _manifest_of(files).items()}}
    sidecars = {name: source for name, source in sidecars_of(folder).items() if name in after}
    sidecars |= dict.fromkeys(_manifest_of(files), sidecar)
    below = {path: content for path, content in files.items() if "/" in path}
    top = {path: content for path, content in files.items() if "/" not in path}
    moves = {MANIFEST: _manifest_bytes(during, sidecars), **below, **top}
    changed = {path: content for path, content in moves.items() if not _holds(folder / path, content)}
    for number, (path, content) in enumerate(changed.items()):
        (staging / f"{number}.new").write_bytes(content)
        _make_folders((folder / path).parent, made)
    (staging / MANIFEST).write_bytes(_manifest_bytes(after, sidecars))
    _move(list(changed), folder, staging)
    for path, digest in stale.items():
        _remove_stale(folder, path, digest)
    (staging / MANIFEST).touch()  # the stamp of this run: make compares it with the input
    (staging / MANIFEST).replace(folder / MANIFEST)
    _remove_abandoned(folder, staging)


def _move(paths: list[str], folder: Path, staging: Path) -> None:
    """Move new files to their places; if one fails, put back what was there."""
    moved: list[tuple[Path, Path | None]] = []
    try:
        for number, path in enumerate(paths):
            target, backup = folder / path, staging / f"{number}.old"
            kept = backup if _keep(target, backup) else None
            (staging / f"{number}.new").replace(target)
            moved.append((target, kept))
    except BaseException:
        for target, kept in reversed(moved):
            if kept is None:
                target.unlink(missing_ok=True)
            else:
                kept.replace(target)
        raise


def _keep(target: Path, backup: Path) -> bool:
    """Keep what is at ``target`` under a second name; False where there is nothing."""
    if not os.path.lexists(target):
        return False
    try:
        os.link(target, backup, follow_symlinks=False)
    except (OSError, NotImplementedError):  # no hard links on this file system
        shutil.copy2(target, backup, follow_symlinks=False)
    return True


def _holds(target: Path, content: bytes) -> bool:
    """Whether ``target`` is a plain file with this content already."""
    try:
        return not target.is_symlink() and target.stat().st_size == len(content) and target.read_bytes() == content
    except OSError:
        return False


def _make_folders(folder: Path, made: list[Path]) -> None:
    """Make a folder and those above it; the ones that were missing are added to ``made``, top first."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    for path in reversed(missing):
        path.mkdir(exist_ok=True)
        made.append(path)
    if not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def _remove_if_empty(folder: Path) -> None:
    try:
        folder.rmdir()
    except OSError:  # somebody else put something there: it is theirs now
        return


def _manifest_of(files: Mapping[str, bytes]) -> Manifest:
    digests = {path: hashlib.sha256(content).hexdigest() for path, content in files.items()}
    meshes = {path: digest for path, digest in digests.items() if "/" in path}
    return {path: {path: digest, **meshes} for path, digest in digests.items() if "/" not in path}


def _manifest_bytes(manifest: Manifest, sidecars: Mapping[str, str]) -> bytes:
    known = {name: sidecar for name, sidecar in sidecars.items() if sidecar}
    document = {"version": 1, "files": manifest, **({"sidecars": known} if known else {})}
    return (json.dumps(document, indent=1, sort_keys=True, ensure_ascii=False) + "\n").encode(
        "utf-8", "backslashreplace"
    )


def _read_manifest(folder: Path) -> Manifest:
    """What earlier runs wrote here; empty where there is no list, or none that can be read: then nothing is removed."""
    try:
        files = _listed(folder)["files"]
        return {
            str(name): {str(path): str(digest) for path, digest in needs.items() if _is_below(str(path))}
            for name, needs in files.items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}


def _listed(folder: Path) -> Any:
    """The list of an output folder as it is; empty where it is no file: a pipe or a device would never end."""
    return json.loads((folder / MANIFEST).read_bytes()) if (folder / MANIFEST).is_file() else {}


def _stale(before: Manifest, after: Manifest) -> dict[str, str]:
    """Files that something needed and nothing needs now, with the hash of what was written."""
    needed = {path for needs in after.values() for path in needs}
    return {path: digest for needs in before.values() for path, digest in needs.items() if path not in needed}


def _remove_stale(folder: Path, path: str, digest: str) -> None:
    target = folder / path
    try:
        if (
            target.is_file()
            and _link_in(path, folder) is None
            and hashlib.sha256(target.read_bytes()).hexdigest() == digest
        ):
            target.unlink()
            _remove_if_empty(target.parent)
    except OSError:  # it is gone, or in use: a mesh too many harms nobody
        return


def _remove_abandoned(folder: Path, staging: Path) -> None:
    """Remove what killed runs left."""
    for path in sorted(folder.glob(f"{_STAGING}*")):
        try:
            if path != staging and path.is_dir() and time.time() - path.stat().st_mtime > _ABANDONED_AFTER:
                shutil.rmtree(path, ignore_errors=True)
        except OSError:  # another run removes it at this moment
            continue


def _is_below(path: str) -> bool:
    """Whether a relative path with forward slashes stays below its folder, on every system."""
    never = _NEVER_IN_NAMES | (_NEVER_IN_WINDOWS_NAMES if os.name == "nt" else frozenset())
    parts = path.split("/")
    return (
        bool(path)
        and not PurePosixPath(path).is_absolute()
        and all(part not in ("", ".", "..") and never.isdisjoint(part) for part in parts)
        and parts[0] not in (MANIFEST, LOCK)
        and not parts[0].startswith(_STAGING)
    )


def _check_path(path: str, folder: Path) -> None:
    if not _is_below(path):
        _refuse(folder, f"invalid file name '{path}'", "choose another name in the sidecar")
    parent = path.rpartition("/")[0]
    if parent and (link := _link_in(parent, folder)) is not None:
        _refuse(folder, f"'{link}' is a symbolic link out of the output folder", f"remove '{link}'")


def _link_in(path: str, folder: Path) -> str | None:
    """The part of a path below ``folder`` that is a symbolic link, and so leads elsewhere."""
    parts = PurePosixPath(path).parts
    heads = ("/".join(parts[: number + 1]) for number in range(len(parts)))
    return next((head for head in heads if (folder / head).is_symlink()), None)


def _check_case(files: Mapping[str, bytes], staging: Path, folder: Path) -> None:
    """Where the file system does not tell `A` from `a`, two files must not differ in that alone."""
    (staging / "case").write_bytes(b"")
    if not (staging / "CASE").exists():
        return
    first: dict[str, str] = {}
    for path in files:
        other = first.setdefault(path.casefold(), path)
        if other != path:
            message = f"'{other}' and '{path}' are the same file on this case-insensitive file system"
            _refuse(folder, message, "choose names in the sidecar that differ in more than case")


def _check_others(files: Mapping[str, bytes], before: Manifest, folder: Path) -> None:
    """Two robots may share a folder, and meshes that are alike, but neither may change what the other refers to."""
    digests = _manifest_of(files)
    ours = {_robot_of(name) for name in digests}
    changed = {path: digest for needs in digests.values() for path, digest in needs.items() if "/" in path}
    descriptions = {name: needs for name, needs in before.items() if not name.endswith(".json")}
    for name, needs in descriptions.items():
        lost = [path for path, digest in needs.items() if changed.get(path, digest) != digest]
        if lost and _robot_of(name) not in ours and (folder / name).exists():
            message = f"mesh '{lost[0]}' would overwrite a different mesh of '{name}'"
            _refuse(folder, message, f"give each robot its own folder with -o, or remove '{name}'")


def _robot_of(name: str) -> str:
    """The robot that a file at the top is named after; its formats may have suffixes of two parts."""
    stem, _, _ = name.rpartition(".")
    return stem.removesuffix(".drake")


def _refuse(
    folder: Path, message: str, remedy: str = "choose another folder with -o, or grant write permission"
) -> NoReturn:
    found = Diagnostics()
    found.add("SB004", message, Span(str(folder)), help=(remedy,))
    raise StepbotError(found)
