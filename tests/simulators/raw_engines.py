"""Engines without our precautions, for tests to call in workers."""

from importlib import import_module

from stepbot.simulators.observation import Observation, Request


def load_sdf(path: str) -> None:
    """Load an SDFormat file in PyBullet as it is."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    pybullet.loadSDF(path)


def observe_both(engine: str, first: Request, second: Request) -> tuple[Observation, Observation]:
    """Two files, one after the other in the same process."""
    observe = import_module(engine).observe
    return observe(first), observe(second)
