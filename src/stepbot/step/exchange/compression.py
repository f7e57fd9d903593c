"""Compressed STEP files: gzip (``.stpZ`` of FreeCAD, ``.step.gz`` of KiCad) and zip (``.stpZ`` of ISO 10303-21:2016).

They are recognized by content. The decompressed size is limited: a kilobyte of a decompression bomb can expand to a
megabyte.
"""

import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, cast

from stepbot.diagnostics import listed
from stepbot.robot.step_names import is_step_name
from stepbot.runtime.file import open_regular

if TYPE_CHECKING:
    import zipfile

MOST_BYTES = 4 << 30
"""Size that a file may have after decompression."""
MOST_TIMES = 100
"""How many times larger than compressed; STEP files reach 30."""
ALWAYS = 64 << 20
"""Size [bytes] up to which the ratio does not matter."""
_GZIP, _ZIP = b"\x1f\x8b", b"PK\x03\x04"
ARCHIVES = (_GZIP, _ZIP, b"PK\x05\x06")
"""First bytes of compressed files."""
_CHUNK = 1 << 20
_SHOWN = 3


class ArchiveFault(OSError):
    """A compressed file that cannot be read; the message gives the reason."""

    def __init__(self, reason: str, help: str) -> None:
        super().__init__(reason)
        self.reason, self.help = reason, help


def starts_with(path: Path, beginnings: tuple[bytes, ...]) -> bool:
    """Whether a file has one of several first bytes, of at most four.

    Raises:
        OSError: It cannot be read.
    """
    with open_regular(path) as file:
        return file.read(4).startswith(beginnings)


@contextmanager
def decompressed(path: Path) -> Iterator[IO[bytes]]:
    """A file opened for reading, and its content in a temporary file if it is compressed.

    Raises:
        ArchiveFault: It is a compressed file that cannot be read.
        OSError: It cannot be read.
    """
    if not starts_with(path, ARCHIVES):
        with open_regular(path) as plain:
            yield plain
        return
    with tempfile.TemporaryFile(prefix="stepbot-") as file:
        _decompress(path, file)
        file.seek(0)
        yield file


def _decompress(path: Path, target: IO[bytes]) -> None:
    """Write the STEP file of an archive into another file.

    Raises:
        ArchiveFault: The archive is damaged, encrypted or too large, or holds no STEP file or several.
        OSError: A file cannot be read or written.
    """
    left = min(MOST_BYTES, max(ALWAYS, MOST_TIMES * path.stat().st_size))
    try:
        with _content(path) as source:
            while chunk := source.read(_CHUNK):
                left -= len(chunk)
                if left < 0:
                    raise ArchiveFault(
                        f"its content is more than {MOST_TIMES} times as large, or larger than {MOST_BYTES >> 30} GiB",
                        "if the archive can be trusted, unpack it and pass the STEP file",
                    )
                target.write(chunk)
            target.flush()
    except (EOFError, zlib.error) as error:
        raise _damaged(error) from None


@contextmanager
def _content(path: Path) -> Iterator[IO[bytes]]:
    with open_regular(path) as file:
        is_gzip = file.read(2) == _GZIP
    if is_gzip:
        import gzip

        try:
            with gzip.open(path, "rb") as source:
                yield cast("IO[bytes]", source)
        except gzip.BadGzipFile as error:
            raise _damaged(error) from None
        return
    import lzma
    import zipfile

    try:
        with zipfile.ZipFile(path) as archive, archive.open(_member(archive)) as source:
            yield source
    except (zipfile.BadZipFile, lzma.LZMAError, NotImplementedError, RuntimeError) as error:
        raise _damaged(error) from None


def _member(archive: "zipfile.ZipFile") -> "zipfile.ZipInfo":
    files = [one for one in archive.infolist() if not one.is_dir()]
    steps = [file for file in files if is_step_name(file.filename)]
    if len(steps) != 1 and len(files) != 1:
        shown = listed([step.filename for step in steps], _SHOWN)
        reason = f"it contains {len(steps)} STEP files: {shown}" if steps else "it contains no STEP file"
        raise ArchiveFault(reason, "unpack it and pass the STEP file of the assembly")
    (member,) = steps if len(steps) == 1 else files
    if member.flag_bits & 1:
        raise ArchiveFault("it is encrypted", "unpack it with its password and pass the STEP file")
    return member


def _damaged(error: Exception) -> ArchiveFault:
    return ArchiveFault(f"it is damaged ({error})", "export or copy it again")
