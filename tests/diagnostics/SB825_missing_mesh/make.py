"""A URDF with a mesh of a type that is not read, as a page shows it: the command would serve it until it is ended."""

from pathlib import Path

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.scenes import show


def find(diagnostics: Diagnostics) -> None:
    """Show it."""
    diagnostics.extend(show(Path("arm.urdf"), Options(output=Path())).diagnostics)
