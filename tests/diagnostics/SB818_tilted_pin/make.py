"""A four-bar linkage with a pin tilted by 0.05 mrad."""

from pathlib import Path

from stepbot.diagnostics import Diagnostics
from stepbot.verification.conversion import Provers, verify
from tests.robots import crooked_four_bar
from tests.simulators.conftest import write


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    folder = write(crooked_four_bar(5e-5), Path())
    written = {"mjcf": folder.written["mjcf"]}
    with Provers(written) as provers:
        verify(folder.robot, written, provers, diagnostics)
