"""Find the supported Pythons of this machine: on PATH, and those of pyenv, which often are not on PATH."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

SUPPORTED = ((3, 11), (3, 12), (3, 13), (3, 14))
_ASK = "import ensurepip, sys, venv; print(*sys.version_info[:3], sys.executable)"
"""Required of an interpreter: creating virtual environments with pip."""


def found_pythons() -> dict[tuple[int, int], tuple[Path, str]]:
    """For each supported Python version the interpreter and full version of the newest one, in order."""
    newest: dict[tuple[int, int], tuple[tuple[int, ...], Path]] = {}
    for path in _candidates():
        version, path = _asked(path)
        if version[:2] in SUPPORTED and version > newest.get(version[:2], ((), path))[0]:
            newest[version[0], version[1]] = version, path
    return {short: (path, ".".join(map(str, version))) for short, (version, path) in sorted(newest.items())}


def _candidates() -> Iterator[Path]:
    for major, minor in SUPPORTED:
        if on_path := shutil.which(f"python{major}.{minor}"):
            yield Path(on_path)
    for name in ("python3", "python"):
        if on_path := shutil.which(name):
            yield Path(on_path)
    for root in dict.fromkeys(_pyenv_roots()):
        yield from sorted(root.glob("versions/*/bin/python"))


def _pyenv_roots() -> Iterator[Path]:
    if root := os.environ.get("PYENV_ROOT"):
        yield Path(root)
    if pyenv := shutil.which("pyenv"):
        run = subprocess.run([pyenv, "root"], capture_output=True, text=True, check=False)
        if run.returncode == 0:
            yield Path(run.stdout.strip())
    yield Path.home() / ".pyenv"


def _asked(python: Path) -> tuple[tuple[int, ...], Path]:
    """Its version and real path; no version if it does not run, like a shim that is not selected."""
    try:
        run = subprocess.run([python, "-c", _ASK], capture_output=True, text=True, check=False, timeout=60)
    except OSError:
        return (), python
    if run.returncode != 0:
        return (), python
    *version, executable = run.stdout.strip().split(" ", 3)
    return tuple(map(int, version)), Path(executable)
