"""Paths that every engine can open: those that are UTF-8.

On POSIX a name is bytes, but engines and XML libraries expect text. A path that is not UTF-8 is replaced by another
one, through symbolic links in the temporary folder of the run.
"""

import tempfile
from functools import cache
from pathlib import Path

from stepbot.runtime.file import is_folder, resolved
from stepbot.runtime.temporary import run_folder


def openable(path: Path) -> Path:
    """An absolute path of a file, in UTF-8; files beside the file and below its folder have the same way from there.

    Raises:
        OSError: There cannot be a symbolic link.
    """
    absolute = resolved(path)  # not cached: what a relative path refers to changes with the current folder
    return absolute if _is_utf8(absolute) else _linked(absolute)


@cache
def _linked(path: Path) -> Path:
    """Another path of a file, by symbolic links; the same one on each call."""
    place = Path(tempfile.mkdtemp(dir=run_folder()))
    if _is_utf8(Path(path.name)):
        folder = next(folder for folder in path.parents if not _is_utf8(Path(folder.name)))
        (place / "folder").symlink_to(folder, target_is_directory=True)
        return place / "folder" / path.relative_to(folder)
    for beside in path.parent.iterdir():
        if _is_utf8(Path(beside.name)):
            (place / beside.name).symlink_to(beside, target_is_directory=is_folder(beside))
    description = place / f"{place.name}{path.suffix if _is_utf8(Path(path.suffix)) else ''}"
    description.symlink_to(path)
    return description


def _is_utf8(path: Path) -> bool:
    try:
        str(path).encode("utf-8")
    except UnicodeEncodeError:  # it has bytes that are not, as surrogates
        return False
    return True
