"""MuJoCo's warnings, which it would otherwise write to ``MUJOCO_LOG.TXT`` in the working directory."""

from collections.abc import Iterator
from contextlib import contextmanager

from ..observation import EngineRefused


@contextmanager
def collected_warnings() -> Iterator[list[str]]:
    """Collect the warnings of MuJoCo in this process.

    Raises:
        EngineRefused: MuJoCo gave up, as on a chain of hundreds of bodies, which exceeds its stack.
    """
    import mujoco as engine

    collected: list[str] = []
    former = engine.get_mju_user_warning()
    engine.set_mju_user_warning(collected.append)
    try:
        yield collected
    except engine.FatalError as error:
        raise EngineRefused(str(error).strip()) from error
    finally:
        engine.set_mju_user_warning(former)
