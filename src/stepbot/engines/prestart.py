"""The fork server of the engines, and the modules that it imports for all of them."""

from stepbot.runtime.fork_server import ForkServer, can_serve
from stepbot.runtime.worker import are_spawned

from . import engines


def shared_imports() -> tuple[str, ...]:
    """Modules that most engines import."""
    shared = (engine.shared_import for engine in engines() if not engine.optional)
    return ("lxml.etree", "stepbot.verification.self_collision.shapes", *shared)


def started_engine_server() -> ForkServer | None:
    """A process that starts engines; None if they are started without it."""
    if not can_serve() or not are_spawned():
        return None
    return ForkServer(shared_imports())
