"""A cluster that does not answer, whether the client is installed or not."""

import pytest

from stepbot.jobs.batch import ClusterUnreachable
from stepbot_cli import batch


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""

    def fail(*ignored: object) -> None:
        raise ClusterUnreachable("no scheduler at tcp://127.0.0.1:9")

    patch.setattr(batch, "_executor", fail)
