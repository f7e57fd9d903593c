"""A part with another density."""

from pathlib import Path

import pytest

from tests.diagnostics.step_files import edited
from tests.revisions import write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever()
    edited(Path("lever.step"), (r"4\.(E\+00)?", "8."))
