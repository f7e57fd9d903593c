"""Runs the commands shown on a documentation page."""

import os
import re
from collections.abc import Sequence
from pathlib import Path

from tests import command_line

COLUMNS = 100
"""Width of the terminal on the pages."""
PROGRESS = re.compile(r"^stepbot: .*, \d+ s(?:, .*)?\n", re.MULTILINE)
"""What a command prints after ten seconds, on a slow machine."""


def printed(arguments: Sequence[str], folder: Path) -> str:
    """Run a command that must succeed, in a folder; returns both output streams, without lines of progress.

    Commands share the cache of the test run, as those of a user share one; outside of pytest there is none.
    """
    cache = {} if "STEPBOT_CACHE" in os.environ else {"STEPBOT_NO_CACHE": "1"}
    code, output = command_line.printed(arguments, folder, {"COLUMNS": str(COLUMNS)} | cache)
    assert code == 0, output
    return PROGRESS.sub("", output)
