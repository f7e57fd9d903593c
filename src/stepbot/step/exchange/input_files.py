"""The files of an assembly by name and hash; the modules that parse STEP are imported only for external references."""

import mmap
from collections.abc import Mapping
from pathlib import Path

from stepbot.runtime.cache import Digest, file_digest
from stepbot.runtime.file import open_regular

from . import DOCUMENT_FILE

_STARTS_OF_ARCHIVES = (b"\x1f\x8b", b"PK")
"""First bytes of compressed files, whose text is not searched here."""


def input_files(step: Path) -> dict[str, Path]:
    """The files of an assembly by their names relative to its folder, the main one first; reports nothing."""
    if not _may_refer(step):
        return {step.name: step}
    from .file_set import reached_files

    return reached_files(step)


def input_digest(step: Path) -> str | None:
    """Hash of all files of an assembly; None if the main one cannot be read."""
    digests = {name: file_digest(path) for name, path in input_files(step).items()}
    return combined_digest(digests)


def combined_digest(digests: Mapping[str, str | None]) -> str | None:
    """Hash of all files of an assembly from the hash of each, the main one first; None if that has none."""
    (_, root), *others = digests.items()
    if root is None or not others:
        return root
    digest = Digest("files of an assembly").add(root)
    for name, own in others:
        digest.add(name, own or "")
    return digest.key


def _may_refer(step: Path) -> bool:
    """Whether a file may refer to others; False if it cannot be read."""
    try:
        with open_regular(step) as file:
            if file.read(2) in _STARTS_OF_ARCHIVES:
                return True
            if file.seek(0, 2) == 0:
                return False
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
                return data.find(DOCUMENT_FILE) >= 0
    except (OSError, ValueError):  # unreadable, or a device or pipe without a size
        return False
