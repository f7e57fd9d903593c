"""Runs the commands shown on a documentation page."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

COLUMNS = 100
"""Width of the terminal on the pages."""


def printed(arguments: Sequence[str], folder: Path) -> str:
    """Run a command that must succeed, in a folder and without a cache; returns both output streams."""
    run = subprocess.run(
        [sys.executable, "-m", "stepbot_cli", *arguments],
        cwd=folder,
        env={**os.environ, "COLUMNS": str(COLUMNS), "STEPBOT_NO_CACHE": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        check=False,
    )
    assert run.returncode == 0, run.stdout
    return run.stdout
