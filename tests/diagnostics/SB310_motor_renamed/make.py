"""A part renamed, with the same shape and pose."""

from pathlib import Path

import pytest

from tests.revisions import write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever().rename({"motor": "XL430", "motor:1": "XL430:1"}).write(Path("lever.step"))
