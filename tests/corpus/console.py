"""Runs the commands shown on a documentation page."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

COLUMNS = 100
"""Width of the terminal on the pages."""


def printed(arguments: Sequence[str], folder: Path) -> str:
    """Run a command that must succeed, in a folder; returns both output streams.

    Commands share the cache of the test run, as those of a user share one; outside of pytest there is none.
    """
    cache = {} if "STEPBOT_CACHE" in os.environ else {"STEPBOT_NO_CACHE": "1"}
    run = subprocess.run(
        [sys.executable, "-m", "stepbot_cli", *arguments],
        cwd=folder,
        env={**os.environ, "COLUMNS": str(COLUMNS)} | cache,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        check=False,
    )
    assert run.returncode == 0, run.stdout
    return run.stdout
