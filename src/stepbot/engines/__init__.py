"""file -> Observation: one module per engine, each run in a process of its own; engines only observe, never judge.

A module of this package that is not private and has an ``observe`` is an engine. It has ``NAME``, ``FORMATS`` (the
formats that it reads), ``available`` (why it cannot run here, or None), ``prepare`` (its slow import) and ``observe``.
None of them imports the engine when it is imported itself. One that most people do without is ``OPTIONAL``, and
``INSTALL`` says how to get one that ``pip install NAME`` does not.
"""

from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:  # to know the engines takes no numpy
    from .observation import Observation, Request


class Engine(Protocol):
    """The module of an engine."""

    NAME: str
    FORMATS: tuple[str, ...]
    __name__: str

    def available(self) -> str | None:
        """Why the engine cannot run here; None where it can."""

    def prepare(self) -> None:
        """Do the slow import."""

    def observe(self, request: "Request") -> "Observation":
        """Say what is in a file; to be called in a worker process."""


@cache
def engines() -> tuple[Engine, ...]:
    """All engines, by name, whether they are installed or not."""
    names = sorted(module.name for module in iter_modules(__path__) if not module.name.startswith("_"))
    modules = [import_module(f"{__name__}.{name}") for name in names]
    return tuple(cast(Engine, module) for module in modules if hasattr(module, "observe"))


def engine_of(name: str) -> Engine:
    """The engine of a name.

    Raises:
        KeyError: There is no such engine.
    """
    for engine in engines():
        if name == engine.NAME:
            return engine
    raise KeyError(name)


def optional_engines() -> frozenset[str]:
    """Names of the engines whose absence is nothing remarkable."""
    return frozenset(engine.NAME for engine in engines() if getattr(engine, "OPTIONAL", False))


def engines_for(format_name: str) -> tuple[Engine, ...]:
    """The engines that read a format."""
    return tuple(engine for engine in engines() if format_name in engine.FORMATS)
