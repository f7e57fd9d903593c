"""An installation without watchfiles, whether it is there or not."""

import pytest

from stepbot.serving import watching


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    patch.setattr(watching, "can_watch", lambda: False)
