"""A lock file in a later version of its format."""

from pathlib import Path

import pytest

from tests.revisions import write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever()
    lock = Path("lever.lock.json")
    text = lock.read_text(encoding="utf-8")
    lock.write_text(text.replace('"version": 1', '"version": 2', 1), encoding="utf-8")
