"""SHA-256 of the files that a robot was made from, for its report."""

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path

from stepbot.runtime.file import open_regular, resolved


def input_hashes(files: Mapping[str, Path]) -> dict[str, str]:
    """SHA-256 of each file by its name in the report.

    Empty if one is gone or unreadable by now: then it is unknown which version was read.
    """
    found = {}
    for name, path in files.items():
        try:
            with open_regular(path) as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
        except OSError:
            return {}
        found[name.encode("utf-8", "backslashreplace").decode()] = digest
    return found


def input_names(first: Path, others: Iterable[Path]) -> dict[str, Path]:
    """Each file by its path relative to the folder of the first.

    Those outside of it have their own names, with as many of the folders above them as tell them apart.
    """
    main = resolved(first)
    named: dict[str, Path] = {}
    for path in dict.fromkeys((main, *(resolved(one) for one in others))):
        inside = path.is_relative_to(main.parent)
        name, folders = path.relative_to(main.parent).as_posix() if inside else path.name, 1
        while name in named:
            folders += 1
            name = "/".join(path.parts[-folders:])
        named[name] = path
    return named
