"""An exception in the check, injected by the test: no input is known to raise one."""

import pytest

from stepbot.jobs import incremental


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""

    def fail(*ignored: object, **options: object) -> None:
        raise ZeroDivisionError("division by zero")

    patch.setattr(incremental, "check", fail)
