"""Files and paths that others name: reads that cannot hang, questions that cannot raise, writes of all or nothing.

A name in a sidecar, a description or a command may be longer than the file system allows, or lead to a loop of links, a
pipe or a device. ``Path.exists``, ``is_file``, ``is_dir`` and ``resolve`` raise an exception for some of these, and
reading a pipe or ``/dev/zero`` never ends. The functions below do neither.
"""

import contextlib
import errno
import os
import sys
from io import BufferedReader
from pathlib import Path
from stat import S_IMODE, S_ISREG

from stepbot.diagnostics import Diagnostics, Span

_READ = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
_NO_LINKS = getattr(os, "O_NOFOLLOW", 0)


def exists(path: Path) -> bool:
    """Whether something is at a path; False for an invalid one."""
    return os.path.exists(path)


def is_file(path: Path) -> bool:
    """Whether a path is that of a regular file, or of a link to one."""
    return os.path.isfile(path)


def is_folder(path: Path) -> bool:
    """Whether a path is that of a folder, or of a link to one."""
    return os.path.isdir(path)


def resolved(path: Path) -> Path:
    """An absolute path without symbolic links; from the first link of a loop on, the path as given."""
    try:
        return Path(os.path.realpath(path))
    except (OSError, ValueError):
        return Path(os.path.abspath(path))


def is_unicode(path: Path) -> bool:
    """Whether a path is text; other bytes of it are surrogates, and neither kernel nor engines open such a file."""
    try:
        str(path).encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True


def open_regular(path: Path, *, follow_links: bool = True) -> BufferedReader:
    """Open a regular file for reading, without waiting for a pipe or a device.

    Raises:
        OSError: The file cannot be opened, or is not a regular one.
    """
    flags = _READ if follow_links else _READ | _NO_LINKS
    file = open(path, "rb", opener=lambda name, _: os.open(name, flags))  # noqa: SIM115 - the caller closes it
    try:
        if not S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "not a regular file", str(path))
    except BaseException:
        file.close()
        raise
    return file


def read_regular(path: Path) -> bytes:
    """The content of a regular file.

    Raises:
        OSError: As for :func:`open_regular`.
    """
    with open_regular(path) as file:
        return file.read()


def write_file(path: Path, content: bytes, diagnostics: Diagnostics, *, replaces: bytes | None = None) -> None:
    """Write a file, or keep the previous one and report the error (SB004) in ``diagnostics``.

    The file keeps its mode; where ``path`` is a symbolic link, the file that it leads to is written.

    Args:
        replaces: The content that the new one was made from: a file with another one was saved meanwhile, and is kept.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, content, replaces)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        diagnostics.add("SB004", f"cannot write the file: {reason}", Span(path.as_posix()))


def replace_file(path: Path, content: bytes, replaces: bytes | None = None) -> None:
    """Write a file as :func:`write_file` does, into a folder that exists.

    Raises:
        OSError: It cannot be written; the previous file is as it was.
        ValueError: No file can have this name.
    """
    target = Path(os.path.realpath(path))
    status = target.lstat() if os.path.lexists(target) else None
    if status is not None and not S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "not a regular file")
    part = target.with_name(f".{os.urandom(8).hex()}.part")
    try:
        with part.open("xb") as file:
            file.write(content)
        if status is not None:
            if sys.platform != "win32":
                with contextlib.suppress(OSError):  # who may write a file need not own it
                    os.chown(part, status.st_uid, status.st_gid)
            part.chmod(S_IMODE(status.st_mode))
        if replaces is not None and read_regular(target) != replaces:
            raise OSError(errno.EBUSY, "it was changed elsewhere meanwhile")
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)
