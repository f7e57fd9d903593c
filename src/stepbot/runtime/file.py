"""Writes one file: all of it or nothing."""

import os
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span


def write_file(path: Path, content: bytes, found: Diagnostics) -> None:
    """Write a file, or keep the previous one and report the error (SB004) in ``found``."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with part.open("xb") as file:
                file.write(content)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        found.add("SB004", f"cannot write the file: {error.strerror or error}", Span(path.as_posix()))
