"""A part renamed in a subassembly that its link has as a whole."""

from pathlib import Path

import pytest

from tests.revisions import LEVER, write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever(sidecar=LEVER.replace("[beam, motor]", "[arm]")).rename(
        {"motor": "XL430", "motor:1": "XL430:1"}
    ).write(Path("lever.step"))
