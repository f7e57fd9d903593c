"""The fork server of the engines, and what it imports for all of them."""

from stepbot.runtime.fork_server import ForkServer, can_serve

_SHARED = (
    "lxml.etree",
    "stepbot.verification.self_collision",
    *(f"stepbot.engines.{name}" for name in ("libsdformat", "sdformat_reader", "urdf_extensions", "yourdfpy")),
    *(f"stepbot.engines.{name}:prepare" for name in ("mujoco", "pybullet")),
)
"""What is imported once for all engines; two of them read several formats each."""


def started_engine_server() -> ForkServer | None:
    """A process that will start engines; None where it cannot, so that each starts on its own."""
    return ForkServer(_SHARED) if can_serve() else None
