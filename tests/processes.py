"""Processes other than this one: whether they ended, and interpreters with other packages."""

import subprocess
import time
import venv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import Workers


def call_isolated(
    function: str, *arguments: Any, timeout: float = DEFAULT_TIMEOUT, memory_limit: int | None = None
) -> Any:
    """Call ``package.module:function`` in a separate process; see :class:`.worker.Worker`.

    Raises:
        WorkerDied: The process ended without a result.
        RemoteError: The function raised.
    """
    return Workers(timeout, memory_limit).call(function, *arguments)


def ended(pid: int) -> bool:
    """Whether a process ends within some seconds."""
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        try:
            state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
        except OSError:
            return True
        if state == "Z":
            return True
        time.sleep(0.01)
    return False


def python_with(packages: Sequence[str], folder: Path) -> Path:
    """The interpreter of a new environment with some packages; the test is skipped if they cannot be installed."""
    venv.create(folder, with_pip=True, symlinks=True)
    python = folder / "bin" / "python"
    command = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    if run.returncode:
        pytest.skip(f"cannot be installed here: {', '.join(packages)}: {run.stderr.strip().splitlines()[-1:]}")
    return python
