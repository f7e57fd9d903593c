"""A part in a path was removed."""

from pathlib import Path

import pytest

from tests.revisions import write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever().remove("motor:1").write(Path("lever.step"))
