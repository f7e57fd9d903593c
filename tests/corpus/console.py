"""Runs the commands shown on a documentation page."""

import os
from collections.abc import Sequence
from pathlib import Path

from tests import command_line

COLUMNS = 100
"""Width of the terminal on the pages."""


def printed(arguments: Sequence[str], folder: Path) -> str:
    """Run a command that must succeed, in a folder; returns both output streams.

    Commands share the cache of the test run, as those of a user share one; outside of pytest there is none.
    """
    cache = {} if "STEPBOT_CACHE" in os.environ else {"STEPBOT_NO_CACHE": "1"}
    code, output = command_line.printed(arguments, folder, {"COLUMNS": str(COLUMNS)} | cache)
    assert code == 0, output
    return output
