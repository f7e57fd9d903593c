"""The fork server of the engines, and what it imports for all of them."""

from .forkserver import ForkServer, can_serve

_SHARED = (
    "lxml.etree",
    "stepbot.selfcollision",
    *(f"stepbot.simulators.{name}" for name in ("extensions", "libsdformat", "reader", "yourdfpy")),
    *(f"stepbot.simulators.{name}:prepare" for name in ("mujoco", "pybullet")),
)
"""What is imported once for all engines; two of them read several formats each."""


def started_engine_server() -> ForkServer | None:
    """A process that will start engines; None where it cannot, so that each starts on its own."""
    return ForkServer(_SHARED) if can_serve() else None
