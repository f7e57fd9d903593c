"""Loads files in engines and returns observations; for ``verification`` and above. One package per engine.

A package in this one with a module ``observer`` is an engine. Its ``__init__`` has ``ENGINE``, the declaration
(:class:`.engine.Engine`), and imports nothing slow. The observer has ``prepare``, the slow import, and ``observe``.
Nothing else lists the engines. Each engine runs in its own process, and only observes: the comparison is in
``verification``.
"""

from functools import cache
from importlib import import_module
from pathlib import Path
from typing import cast

from .engine import Engine

__all__ = ["Engine", "engine_named", "engine_of", "engines", "engines_for", "optional_engines", "own_parsers"]


@cache
def engines() -> tuple[Engine, ...]:
    """All engines, sorted by the name of their package, whether installed or not."""
    folders = sorted(observer.parent.name for path in __path__ for observer in Path(path).glob("*/observer.py"))
    return tuple(cast(Engine, import_module(f"{__name__}.{name}").ENGINE) for name in folders)


def engine_of(name: str) -> Engine:
    """The engine with a name.

    Raises:
        KeyError: There is no such engine.
    """
    engine = engine_named(name)
    if engine is None:
        raise KeyError(name)
    return engine


def engine_named(name: str) -> Engine | None:
    """The engine with a name, or None, as for the model and for sources."""
    return next((engine for engine in engines() if engine.name == name), None)


def optional_engines() -> frozenset[str]:
    """Names of the engines whose absence is not reported."""
    return frozenset(engine.name for engine in engines() if engine.optional)


def own_parsers() -> tuple[str, ...]:
    """Names of stepbot's own parsers, which confirm the text of a file but simulate nothing."""
    return tuple(engine.name for engine in engines() if engine.own_parser)


def engines_for(format_name: str) -> tuple[Engine, ...]:
    """The engines that read a format."""
    return tuple(engine for engine in engines() if format_name in engine.formats)
