"""Imports trimesh, or what needs it, without two packages that trimesh imports and that are not needed here.

scipy and networkx take most of a second. Others in the same process would miss them in trimesh, so this is for
processes that do one thing only.
"""

import importlib
import sys

_UNUSED = ("networkx", "scipy")


def import_lightly(module: str) -> None:
    """Import a module while the two packages seem not to be installed."""
    withheld = [name for name in _UNUSED if name not in sys.modules]
    sys.modules.update(dict.fromkeys(withheld))  # type: ignore[arg-type]  # None is how Python marks what is not there
    try:
        importlib.import_module(module)
    finally:
        for name in withheld:
            del sys.modules[name]
