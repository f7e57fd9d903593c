"""A part renamed to a name that matches a glob of another link."""

from pathlib import Path

import pytest

from tests.revisions import LEVER, write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    sidecar = LEVER.replace("[base]", '["**/plate*", M3]').replace("[beam, motor]", "[beam], rest: true")
    write_locked_lever(sidecar=sidecar).rename({"motor": "plate 2", "motor:1": "plate 2:1"}).write(Path("lever.step"))
