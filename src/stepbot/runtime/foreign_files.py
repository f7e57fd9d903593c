"""Files of others that a run would overwrite: what stepbot did not write, it must not replace."""

from collections.abc import Mapping
from pathlib import Path
from stat import S_ISREG

from .file import open_regular, read_regular
from .output_list import Manifest

_MARK = b"stepbot"
"""In the first lines of every robot file and report that stepbot writes; meshes have no place for it."""
_HEAD = 512
"""Length [bytes] of what is searched for the mark."""


def foreign_files(files: Mapping[str, bytes], folder: Path, before: Manifest) -> list[str]:
    """Files to write that exist with another content and that stepbot has not written, in order.

    An output folder whose list was lost, as in a repository that ignores hidden files, is recognised by marked files.

    Args:
        files: New content by path relative to ``folder``.
        folder: Output folder.
        before: Its list, empty if there is none.
    """
    listed = {path for needs in before.values() for path in needs}
    unlisted = {path: content for path, content in files.items() if path not in listed}
    different = [path for path, content in unlisted.items() if _differs(folder / path, content)]
    unmarked = [path for path in different if not _is_marked(folder / path)]
    if before or not any(_is_marked(folder / path) for path in files if "/" not in path):
        return unmarked
    # The folder is stepbot's, without its list: what never has a mark, such as a mesh, cannot be told apart.
    return [path for path in unmarked if _is_marked_by(files[path])]


def _differs(target: Path, content: bytes) -> bool:
    """Whether a regular file is there, with another content."""
    try:
        status = target.lstat()
        return S_ISREG(status.st_mode) and (status.st_size != len(content) or read_regular(target) != content)
    except OSError:
        return False


def _is_marked(target: Path) -> bool:
    try:
        with open_regular(target) as file:
            return _is_marked_by(file.read(_HEAD))
    except OSError:
        return False


def _is_marked_by(content: bytes) -> bool:
    return _MARK in content[:_HEAD]
