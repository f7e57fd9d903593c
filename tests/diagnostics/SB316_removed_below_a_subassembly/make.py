"""A part removed from a subassembly that its link has as a whole."""

from pathlib import Path

import pytest

from tests.revisions import LEVER, write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever(sidecar=LEVER.replace("[beam, motor]", "[arm]")).remove("motor:1").write(Path("lever.step"))
