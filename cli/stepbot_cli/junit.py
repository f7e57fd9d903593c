"""The option ``--junit``: results as JUnit XML, for CI servers."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from stepbot.report.junit import Suite

junit_option = click.option(
    "--junit", type=click.Path(path_type=Path), metavar="FILE", help="Also write the results as JUnit XML."
)


def write_junit(path: Path, suites: "Sequence[Suite]") -> None:
    """Write the results of robots to a file, creating its folder if necessary."""
    from stepbot.report.junit import junit_bytes

    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(junit_bytes(suites))
