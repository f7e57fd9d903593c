"""MuJoCo's warnings, which it would otherwise write to ``MUJOCO_LOG.TXT`` in the working directory."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def collected_warnings() -> Iterator[list[str]]:
    """Collect the warnings of MuJoCo in this process."""
    import mujoco as engine

    collected: list[str] = []
    former = engine.get_mju_user_warning()
    engine.set_mju_user_warning(collected.append)
    try:
        yield collected
    finally:
        engine.set_mju_user_warning(former)
