"""Imports trimesh, or modules that need it, without its optional dependencies.

scipy and networkx alone take most of a second to import. Other code in the same process would miss them in trimesh, so
this is for processes with a single task.
"""

import importlib
import sys
from collections.abc import Sequence


def import_lightly(module: str, unused: Sequence[str]) -> None:
    """Import a module while some packages appear not to be installed."""
    withheld = [name for name in unused if name not in sys.modules]
    sys.modules.update(dict.fromkeys(withheld))  # type: ignore[arg-type]  # None is how Python marks what is not there
    try:
        importlib.import_module(module)
    finally:
        for name in withheld:
            del sys.modules[name]
