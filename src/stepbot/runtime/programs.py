"""External programs: their paths, and a fingerprint of their version without running them."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from .file import is_file, resolved


def find_program(name: str) -> str | None:
    """Absolute path of a program in ``PATH``, ignoring the current folder and relative entries."""
    for folder in os.environ.get("PATH", "").split(os.pathsep):
        program = Path(folder, name)
        if not program.is_absolute():
            continue
        if os.name == "posix":  # `shutil` takes longer to import than all of this
            if is_file(program) and os.access(program, os.X_OK):
                return str(program)
            continue
        import shutil

        if path := shutil.which(str(program)):  # with the suffixes of programs
            return path
    return None


def sdf_programs() -> Iterator[str]:
    """The programs that may have an ``sdf`` subcommand, the newer one first."""
    for name in ("gz", "ign"):
        if (program := find_program(name)) is not None:
            yield program


def program_fingerprints() -> list[str]:
    """Path, size and modification time of each program that results may depend on, and of the libraries' descriptions.

    ``gz`` and ``ign`` are launchers that do not change when libsdformat is upgraded: the library to load is written in
    ``sdformat*.yaml`` in their configuration folders.
    """
    files: list[Path] = []
    for program in map(Path, sdf_programs()):
        share = resolved(program).parents[1] / "share"
        variable = os.environ.get(f"{program.stem.upper()}_CONFIG_PATH", "")
        folders = [*map(Path, filter(None, variable.split(os.pathsep))), share / "gz", share / "ignition"]
        files += [program, *(file for folder in folders for file in sorted(folder.glob("*sdf*.yaml")))]
    return [_fingerprint(file) for file in files]


def _fingerprint(file: Path) -> str:
    with contextlib.suppress(OSError):  # removed meanwhile
        status = file.stat()
        return f"{file} {status.st_size} {status.st_mtime_ns}"
    return str(file)
