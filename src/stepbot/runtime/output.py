"""The only module that writes results to disk: all files of a run or none.

New files are created in a hidden folder next to their destinations and then moved there one by one, meshes first, the
files that refer to them last; an unchanged file is not touched. If a move fails, the previous ones are reverted. A
killed process leaves every file complete, old or new, and the next run cleans up.

A later run uses the list of an output folder (:mod:`.output_list`) to remove meshes that are no longer needed, and
parts of a description that the robot no longer has, such as MoveIt's settings; files that are not listed, or were
changed since, are never touched. The time stamp of the list marks the last run: newer than all input, even if no other
file changed.
"""

import contextlib
import hashlib
import os
import re
import time
from collections.abc import Collection, Mapping
from pathlib import Path, PurePosixPath
from stat import S_ISDIR, S_ISREG
from typing import NamedTuple, NoReturn

from stepbot.diagnostics import Diagnostics, Span, StepbotError

from .file import exists, is_file, is_folder, read_regular, resolved
from .moves import holds, kept_files, make_folders, move, remove_if_empty
from .output_list import (
    LOCK,
    MANIFEST,
    STAGING,
    FolderInUse,
    Manifest,
    OutputList,
    content_hashes,
    is_below,
    locked,
    manifest_of,
    robot_in,
    robot_of,
    stale_files,
    top_files,
)

_ABANDONED_AFTER = 24 * 3600.0
"""Age [s] from which a staging folder belongs to a killed run."""
_LEFTOVER = re.compile(rf"\d+\.(new|old)|case|{re.escape(MANIFEST)}")
"""Names in a staging folder."""
_EMPTY_STAGING = re.compile(rf"{re.escape(STAGING)}[a-z0-9_]{{8}}")
_PARTS = {".srdf": ".urdf", ".drake.sdf": ".sdf", ".setup_assistant": "CMakeLists.txt"}
"""Ends of files that only some robots have, and of the files that they belong to: they go when those come without."""
_LONGEST_WAIT = 60.0
"""Maximum waiting time [s] for another run that writes into the same folder."""


def failed_output(folder: Path) -> Path:
    """Folder for the files of a run that failed verification: next to ``folder``, whose content is kept."""
    return folder.parent / f"{resolved(folder).name}.failed"


def check_writable(folder: Path) -> None:
    """Check in advance that a folder can be created or written; changes nothing.

    Raises:
        StepbotError: A file is in the way, or write permission is missing (SB004).
    """
    try:
        os.lstat(folder)
    except (FileNotFoundError, NotADirectoryError):
        pass
    except (OSError, ValueError) as error:  # a name that is too long, or a loop of links
        _refuse(folder, f"cannot write {folder}: {getattr(error, 'strerror', None) or error}")
    nearest = next((path for path in (folder, *folder.absolute().parents) if os.path.lexists(path)), folder)
    if not is_folder(nearest):
        _refuse(folder, f"cannot write {folder}: '{nearest}' is not a folder")
    if not os.access(nearest, os.W_OK | os.X_OK):
        _refuse(folder, f"cannot write {folder}: no write permission in '{nearest}'")


def write_atomically(
    files: Mapping[str, bytes],
    folder: Path,
    sidecar: Path | None = None,
    diagnostics: Diagnostics | None = None,
    hashes: Mapping[str, str] | None = None,
) -> None:
    """Write all files, or none.

    Files at the top of the folder are assumed to need all of those in sub-folders; meshes of an earlier run for the
    same files that are no longer needed are removed.

    Args:
        files: Content by path relative to ``folder``, with forward slashes.
        folder: Output folder; created if missing.
        sidecar: The sidecar of the files. The list names it if it and ``folder`` are below the current folder; no path
            outside of a project is written.
        diagnostics: Receives the note SB011 if the file system has no locks.
        hashes: SHA-256 of each file; None to compute them.

    Raises:
        StepbotError: A path leads out of ``folder``, or a file cannot be written (SB004); nothing was changed.
    """
    _check_paths(files, folder)
    made: list[Path] = []
    try:
        make_folders(folder, made)
        with locked(folder, _LONGEST_WAIT) as is_alone:
            if not is_alone and diagnostics is not None:
                message = "file system without locks: concurrent conversions into this folder are not detected"
                diagnostics.add("SB011", message, Span(str(folder)), help=["run one conversion at a time"])
            lists = _listed_after(files, hashes or content_hashes(files), folder, _from_folder(sidecar, folder))
            if _is_current(files, folder, lists):
                stamp(folder)
                _remove_abandoned(folder)
            else:
                _write(files, folder, lists, made)
    except FolderInUse as error:
        _refuse(folder, str(error), "wait until it has finished, or choose another folder with -o")
    except OSError as error:
        _refuse(folder, f"cannot write {error.filename or folder}: {error.strerror or error}")
    finally:
        for path_made in reversed(made):  # after an error they are empty
            remove_if_empty(path_made)


def discard(folder: Path) -> None:
    """Remove the files of an earlier run from a folder, except changed files and those of others."""
    try:
        with locked(folder, _LONGEST_WAIT):
            for needs in OutputList.read(folder).files.values():
                for path, digest in needs.items():
                    _remove_stale(folder, path, digest)
            if {path.name for path in folder.iterdir()} - {LOCK} == {MANIFEST}:
                (folder / MANIFEST).unlink()
                remove_if_empty(folder)
    except FolderInUse as error:
        _refuse(folder, str(error), "wait until it has finished, or choose another folder with -o")
    except OSError:  # there is no such folder
        return


def beside(files: Mapping[str, bytes], folder: Path) -> tuple[list[str], list[str]]:
    """Other robots in a folder, and files of the same robot from earlier runs beside ``files``, sorted."""
    listed = OutputList.read(folder)
    others = _others(files, listed, folder)
    same = (
        name
        for name in listed.files
        if not (name in files or name in others or name.endswith(".json") or _is_superseded(name, files))
        and exists(folder / name)
    )
    return sorted(set(others.values())), sorted(same)


def _others(files: Mapping[str, bytes], listed: OutputList, folder: Path) -> dict[str, str]:
    """Files at the top of a folder that are those of other robots than the one of ``files``, each with its robot."""
    names = [name for name in listed.files if not name.endswith(".json")]
    if set(names) <= set(files) and not listed.robots:
        return {}
    robot = robot_in(files)
    ours = {robot_of(name) for name in top_files(files)} if robot is None else {robot}
    owners = {name: listed.robots.get(name) or robot_of(name) for name in names}
    return {name: owner for name, owner in owners.items() if owner not in ours and exists(folder / name)}


def _is_superseded(name: str, files: Mapping[str, bytes]) -> bool:
    """Whether a run writes the file that another one of an earlier run belongs to, and not that one."""
    main = next((name.removesuffix(end) + main for end, main in _PARTS.items() if name.endswith(end)), "")
    return main in files and name not in files


def stamp(folder: Path) -> None:
    """Touch the list of an output folder after a run without changes, so that it is newer than all input.

    Raises:
        OSError: The list exists and its time cannot be set.
    """
    with contextlib.suppress(FileNotFoundError):
        os.utime(folder / MANIFEST)


def _from_folder(sidecar: Path | None, folder: Path) -> str:
    """The relative path from an output folder to a sidecar; empty if one of them is outside the current folder."""
    if sidecar is None:
        return ""
    here, source, target = resolved(Path.cwd()), resolved(sidecar), resolved(folder)
    if not (source.is_relative_to(here) and target.is_relative_to(here)):
        return ""
    return Path(os.path.relpath(source, target)).as_posix()


class _Lists(NamedTuple):
    """The list of an output folder before and after a run."""

    before: OutputList
    own: Manifest
    """The part of the list after it that is about the files of this run."""
    after: OutputList


def _listed_after(files: Mapping[str, bytes], hashes: Mapping[str, str], folder: Path, sidecar: str) -> _Lists:
    before, own = OutputList.read(folder), manifest_of(hashes)
    after = {name: needs for name, needs in before.files.items() if not _is_superseded(name, files)} | own
    sidecars = {name: source for name, source in before.sidecars.items() if name in after}
    robots = {name: robot for name, robot in before.robots.items() if name in after}
    robot = robot_in(files)
    if robot is not None:
        robots.update(dict.fromkeys((name for name in own if not name.endswith(".json")), robot))
    return _Lists(before, own, OutputList(after, sidecars | dict.fromkeys(own, sidecar), robots))


def _is_current(files: Mapping[str, bytes], folder: Path, lists: _Lists) -> bool:
    """Whether a folder has all files of a run with their content, the same list of them, and no file to remove."""
    if stale_files(lists.before.files, lists.after.files):
        return False
    return all(holds(folder / path, content) for path, content in {**files, MANIFEST: lists.after.content}.items())


def _write(files: Mapping[str, bytes], folder: Path, lists: _Lists, made: list[Path]) -> None:
    """Write the files that changed, through a hidden folder beside them."""
    import shutil  # both take longer to import than it takes to find that nothing changed
    import tempfile

    staging = Path(tempfile.mkdtemp(prefix=STAGING, dir=folder))
    try:
        _check_case(files, staging, folder)
        _check_others(files, lists, folder)
        _check_kept(files, lists, folder)
        _replace(files, folder, staging, lists, made)
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _replace(files: Mapping[str, bytes], folder: Path, staging: Path, lists: _Lists, made: list[Path]) -> None:
    before, own, after = lists
    stale = stale_files(before.files, after.files)
    # While files are moved, the manifest lists old and new, so that a killed run leaves no unlisted file.
    both = {name: {**before.files.get(name, {}), **needs} for name, needs in own.items()}
    during = after._replace(files={**before.files, **after.files, **both}, replaced=_replaced(before, own))
    below = {path: content for path, content in files.items() if "/" in path}
    top = {path: content for path, content in files.items() if "/" not in path}
    moves = {MANIFEST: during.content, **below, **top}
    changed = {path: content for path, content in moves.items() if not holds(folder / path, content)}
    for number, (path, content) in enumerate(changed.items()):
        (staging / f"{number}.new").write_bytes(content)
        make_folders((folder / path).parent, made)
    (staging / MANIFEST).write_bytes(after.content)
    move(list(changed), folder, staging)
    for path, digest in stale.items():
        _remove_stale(folder, path, digest)
    (staging / MANIFEST).touch()  # the time stamp of this run, which make compares with the input
    (staging / MANIFEST).replace(folder / MANIFEST)
    _remove_abandoned(folder, staging)


def _replaced(before: OutputList, own: Manifest) -> dict[str, list[str]]:
    """What files may hold until they are moved, beside their new content, so that a killed run edits none."""
    possible = before.written
    new = {path: digest for needs in own.values() for path, digest in needs.items()}
    former = {path: sorted(possible.get(path, set()) - {digest}) for path, digest in new.items()}
    return {path: digests for path, digests in former.items() if digests}


def _remove_stale(folder: Path, path: str, digest: str) -> None:
    target = folder / path
    try:
        if (
            is_file(target)
            and _link_in(path, folder) is None
            and hashlib.sha256(read_regular(target)).hexdigest() == digest
        ):
            target.unlink()
            for above in Path(path).parents[:-1]:
                remove_if_empty(folder / above)
    except OSError:  # it is gone, or in use: an unused mesh does no harm
        return


def _remove_abandoned(folder: Path, staging: Path | None = None) -> None:
    """Remove leftovers of killed runs: folders with nothing but the files of a run."""
    for path in sorted(folder.glob(f"{STAGING}*")):
        try:
            status = path.lstat()
            if path == staging or not S_ISDIR(status.st_mode) or time.time() - status.st_mtime <= _ABANDONED_AFTER:
                continue
            leftovers = list(path.iterdir())
            if all(
                _LEFTOVER.fullmatch(leftover.name) and S_ISREG(leftover.lstat().st_mode) for leftover in leftovers
            ) and (leftovers or _EMPTY_STAGING.fullmatch(path.name)):
                for one in leftovers:
                    one.unlink()
                path.rmdir()
        except OSError:  # another run is removing it
            continue


def _check_paths(paths: Collection[str], folder: Path) -> None:
    for path in paths:
        if not is_below(path):
            _refuse(folder, f"invalid file name '{path}'", "choose another name in the sidecar")
    for parent in filter(None, dict.fromkeys(path.rpartition("/")[0] for path in paths)):
        if (link := _link_in(parent, folder)) is not None:
            _refuse(folder, f"'{link}' is a symbolic link out of the output folder", f"remove '{link}'")


def _link_in(path: str, folder: Path) -> str | None:
    """The part of a path below ``folder`` that is a symbolic link, and so leads elsewhere."""
    parts = PurePosixPath(path).parts
    heads = ("/".join(parts[: number + 1]) for number in range(len(parts)))
    return next((head for head in heads if os.path.islink(folder / head)), None)  # noqa: PTH114 - long names


def _check_case(files: Mapping[str, bytes], staging: Path, folder: Path) -> None:
    """Reject files that differ only in case, on a file system that ignores it."""
    (staging / "case").write_bytes(b"")
    if not exists(staging / "CASE"):
        return
    first: dict[str, str] = {}
    for path in files:
        other = first.setdefault(path.casefold(), path)
        if other != path:
            message = f"'{other}' and '{path}' are the same file on this case-insensitive file system"
            _refuse(folder, message, "choose names in the sidecar that differ in more than case")


def _check_others(files: Mapping[str, bytes], lists: _Lists, folder: Path) -> None:
    """Two robots may share a folder and identical files, but must not change files of the other."""
    changed = {path: digest for needs in lists.own.values() for path, digest in needs.items()}
    for name, robot in _others(files, lists.before, folder).items():
        needs = lists.before.files[name]
        lost = next((path for path, digest in needs.items() if changed.get(path, digest) != digest), None)
        if lost is not None:
            what = f"a file of robot '{robot}'" if lost == name else f"a different mesh of '{name}'"
            message = f"{'' if lost == name else 'mesh '}'{lost}' would overwrite {what}"
            _refuse(folder, message, f"give each robot its own folder with -o, or remove '{name}'")


def _check_kept(files: Mapping[str, bytes], lists: _Lists, folder: Path) -> None:
    kept = kept_files(files, folder, lists.before.written)
    if kept:
        path, reason = next(iter(kept.items()))
        more = f"; so do {len(kept) - 1} more that would be overwritten" if len(kept) > 1 else ""
        message = f"'{path}' {reason}{more}"
        _refuse(folder, message, "choose another folder with -o, or move or remove the file")


def _refuse(
    folder: Path, message: str, remedy: str = "choose another folder with -o, or grant write permission"
) -> NoReturn:
    diagnostics = Diagnostics()
    diagnostics.add("SB004", message, Span(str(folder)), help=(remedy,))
    raise StepbotError(diagnostics)
