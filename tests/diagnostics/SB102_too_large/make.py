"""A sidecar of five megabytes."""

from pathlib import Path

import pytest


def make(patch: pytest.MonkeyPatch) -> None:
    """Write it."""
    Path("robot.robot.yaml").write_bytes(b"version: 1\n" + b"# padding\n" * 500_000)
