"""The valid STEP files that mutants are made of: real ones, robots of the library, drawings of the tests.

python -m tests.fuzz.bases FOLDER        collects them, with the kernel that draws in a separate process
"""

import inspect
import shutil
import sys
from pathlib import Path

from tests.conftest import CORPUS, CORPUS_ABSENT, ROOT

LARGEST = 600_000
"""Size [bytes] above which a file of the corpus is too slow to be read thousands of times."""
_REAL = "real_"
"""Prefix of the names of files of the corpus."""
_REFUSED = ("write_empty", "write_external_reference", "write_without_unit")
"""Drawings that readers reject anyway."""


def collect(folder: Path) -> None:
    """Put all bases into a folder, drawing those that are drawings."""
    from tests import parts

    from .curved import write_curved

    folder.mkdir(parents=True, exist_ok=True)
    for source in _real():
        shutil.copyfile(source, folder / f"{_REAL}{source.name}")
    for source in sorted((ROOT / "robot_library").glob("*/*.step")):
        shutil.copyfile(source, folder / source.name)
    for name, write in sorted(vars(parts).items()):
        if name.startswith("write_") and name not in _REFUSED and _needs_only_a_path(write):
            write(folder / f"{name.removeprefix('write_')}.step")
    parts.write_nested(folder / "nested_inch.step", unit="inch")
    write_curved(folder / "curved.step")


def names(folder: Path, *, real: bool | None = None) -> list[str]:
    """Names of the bases in a folder: all, only those of the corpus, or only the others."""
    found = sorted(path.name for path in folder.glob("*.step"))
    return [name for name in found if real is None or name.startswith(_REAL) == real]


def absent() -> str:
    """What is missing, for messages; empty if nothing is."""
    return "" if CORPUS.is_dir() else CORPUS_ABSENT


def _real() -> list[Path]:
    return sorted(path for path in CORPUS.glob("*.step") if path.stat().st_size <= LARGEST)


def _needs_only_a_path(write: object) -> bool:
    if not callable(write) or inspect.getmodule(write) is not sys.modules["tests.parts"]:
        return False
    required = [p for p in inspect.signature(write).parameters.values() if p.default is inspect.Parameter.empty]
    return [p.name for p in required] == ["path"]


if __name__ == "__main__":
    collect(Path(sys.argv[1]))
