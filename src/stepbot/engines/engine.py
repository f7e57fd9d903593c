"""What is known of an engine before it is imported."""

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:
    from .observation import Observation, Request


class Observer(Protocol):
    """The module ``observer`` of an engine."""

    def prepare(self) -> None:
        """Do the slow import."""

    def observe(self, request: "Request") -> "Observation":
        """Say what is in a file; to be called in a worker process."""


@dataclass(eq=False)
class Engine:
    """The declaration of an engine. It imports neither the engine nor the module that observes with it."""

    package: str
    """Package of the engine, which has a module ``observer``: ``__name__``."""
    name: str
    """What users call it: ``mujoco``."""
    formats: tuple[str, ...]
    """Names of the formats that it reads, those of companion files included."""
    available: Callable[[], str | None]
    """Why the engine cannot run here; None where it can."""
    order: int
    """Least for the engine that reports most of a file: others are compared with it where nothing else is expected."""
    scout: int | None = None
    """Least for the engine that is asked first which joints a file has; None for ``order``."""
    optional: bool = False
    """Whether most people do without it, so that its absence is nothing remarkable."""
    own_parser: bool = False
    """Whether it is a parser of stepbot's own, which confirms the text and no engine."""
    install: str = ""
    """How to get it; empty for ``pip install NAME``."""

    @property
    def observe_function(self) -> str:
        """``module:function`` for a worker."""
        return f"{self.package}.observer:observe"

    @property
    def shared_import(self) -> str:
        """What the fork server imports once for all processes; of an engine for several formats the slow import too."""
        return f"{self.package}.observer:prepare" if len(self.formats) > 1 else f"{self.package}.observer"

    @property
    def scouting_order(self) -> int:
        """Least for the engine that is asked first which joints a file has."""
        return self.order if self.scout is None else self.scout

    @property
    def observer(self) -> Observer:
        """The module that observes; imported now."""
        return cast(Observer, import_module(f"{self.package}.observer"))


def installed(module: str, name: str = "") -> Callable[[], str | None]:
    """What tells whether a module can be imported: the reason why not, or None.

    Args:
        module: Name of a top-level module.
        name: What to call it; empty for the module's name.
    """
    return lambda: None if importlib.util.find_spec(module) is not None else f"{name or module} is not installed"


def always() -> None:
    """For an engine that comes with stepbot: there is no reason why it could not run."""
