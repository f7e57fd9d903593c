"""An installation without engines."""

import pytest

from stepbot.engines import engines


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    for engine in engines():
        patch.setattr(engine, "available", lambda name=engine.name: f"{name} is not installed")
