"""A zip archive of two STEP files."""

import zipfile
from pathlib import Path

import pytest


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    with zipfile.ZipFile(Path("robot.stpz"), "w") as archive:
        for name in ("robot.stp", "arm.stp"):
            archive.writestr(name, "ISO-10303-21;\n")
