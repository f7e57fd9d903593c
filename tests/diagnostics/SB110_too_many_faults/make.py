"""A sidecar with more misspelt keys than are listed."""

from pathlib import Path

import pytest


def make(patch: pytest.MonkeyPatch) -> None:
    """Write it."""
    Path("robot.robot.yaml").write_bytes(b"version: 1\n" + b"".join(b"k%d: 0\n" % n for n in range(5000)))
