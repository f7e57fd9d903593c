"""A sidecar without a lock file."""

from pathlib import Path

import pytest

from tests.revisions import write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever()
    Path("lever.lock.json").unlink()
