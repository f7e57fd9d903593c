"""A written file that is changed before the engines load it."""

import re
from pathlib import Path

from stepbot.diagnostics import Diagnostics
from stepbot.verification.conversion import Provers, verify
from tests import robots
from tests.simulators.conftest import write


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    folder = write(robots.pendulum(), Path())
    written = {"urdf": folder.written["urdf"]}
    path = written["urdf"].path
    text = path.read_text(encoding="utf-8")
    path.write_text(re.sub(r"<inertial>.*?</inertial>", "", text, count=1, flags=re.DOTALL), encoding="utf-8")
    with Provers(written) as provers:
        verify(folder.robot, written, provers, diagnostics)
