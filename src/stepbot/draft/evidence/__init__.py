"""Evidence that parts are welded or joined: rules with an order, in modules of this package.

A new rule is one module: it is imported because it is here, and called in its order.
"""

from collections.abc import Callable, Iterator
from functools import partial
from importlib import import_module
from inspect import signature
from pkgutil import iter_modules
from typing import TypeVar

Find = Callable[..., None]
F = TypeVar("F", bound=Find)
_RULES: list[tuple[int, Find]] = []


def rule(order: int, **fixed: object) -> Callable[[F], F]:
    """Register a function that adds evidence.

    Args:
        order: Rules with a lower one come first.
        fixed: Arguments. The others are called ``survey``, ``motors``, ``structure`` (of the subassemblies, once it is
            asked for) and ``evidence``.
    """

    def register(find: F) -> F:
        _RULES.append((order, partial(find, **fixed) if fixed else find))
        return find

    return register


def rules() -> Iterator[tuple[Find, list[str]]]:
    """All rules in their order, each with the names of what it needs, such as ``survey`` and ``evidence``."""
    for module in iter_modules(__path__):
        import_module(f"{__name__}.{module.name}")
    for _, find in sorted(_RULES, key=lambda row: row[0]):
        yield find, [name for name, one in signature(find).parameters.items() if one.default is one.empty]
