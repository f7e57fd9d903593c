"""Imports trimesh, or what needs it, without packages that trimesh imports where they are there, and can do without.

scipy and networkx alone take most of a second. Others in the same process would miss them in trimesh, so this is for
processes that do one thing only.
"""

import importlib
import sys
from collections.abc import Sequence


def import_lightly(module: str, unused: Sequence[str]) -> None:
    """Import a module while some packages seem not to be installed."""
    withheld = [name for name in unused if name not in sys.modules]
    sys.modules.update(dict.fromkeys(withheld))  # type: ignore[arg-type]  # None is how Python marks what is not there
    try:
        importlib.import_module(module)
    finally:
        for name in withheld:
            del sys.modules[name]
