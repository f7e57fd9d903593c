"""An unreachable scheduler, whether or not the client is installed."""

import pytest

from stepbot.jobs.batch.work import ClusterUnreachable
from stepbot_cli import batch


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""

    def fail(*ignored: object) -> None:
        raise ClusterUnreachable("no scheduler at tcp://127.0.0.1:9")

    patch.setattr(batch, "_executor", fail)
