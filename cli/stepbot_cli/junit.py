"""The option ``--junit``: results as JUnit XML, for CI servers."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics

if TYPE_CHECKING:
    from stepbot.report.junit import Suite

junit_option = click.option(
    "--junit", type=click.Path(path_type=Path), metavar="FILE", help="Also write the results as JUnit XML."
)


def write_junit(path: Path, suites: "Sequence[Suite]") -> None:
    """Write the results of robots to a file, creating its folder if necessary.

    Raises:
        StepbotError: It cannot be written (SB004).
    """
    from stepbot.report.junit import junit_bytes
    from stepbot.runtime.file import write_file

    write_file(path, junit_bytes(suites), found := Diagnostics())
    found.raise_if_errors()
