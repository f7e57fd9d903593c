"""Removes the current folder from the import path, since it may contain untrusted files.

``python -c`` and ``python -m`` put the current folder first on ``sys.path``, and so does an empty entry of
``PYTHONPATH``: a ``random.py`` in that folder would run. Decision 0018 lists the exceptions. This module imports only
modules that Python loads at startup.
"""

import importlib
import os
import sys
from collections.abc import Sequence

_STANDARD_LIBRARY = os.path.dirname(os.__file__)
_OWN_ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def safe_import_path(path: list[str], python_path: str) -> list[str]:
    """The absolute entries of an import path, without the current folder if it precedes the standard library.

    Args:
        path: As ``sys.path``: entries after the standard library come from the installation.
        python_path: Value of ``PYTHONPATH``. The current folder is kept if its absolute path is an entry of it, or if
            stepbot itself is installed in it.
    """
    absolute = [entry for entry in path if os.path.isabs(entry)]
    first_installed = absolute.index(_STANDARD_LIBRARY) if _STANDARD_LIBRARY in absolute else len(absolute)
    requested = [entry for entry in python_path.split(os.pathsep) if os.path.isabs(entry)]
    kept = {_resolved(folder) for folder in (_OWN_ROOT, *requested)}
    here = _current_folder()
    return [
        entry
        for number, entry in enumerate(absolute)
        if number >= first_installed or _resolved(entry) != here or here in kept
    ]


def restrict_import_path() -> None:
    """Remove the current folder and relative entries from ``sys.path``."""
    sys.path[:] = safe_import_path(sys.path, os.environ.get("PYTHONPATH", ""))


def _current_folder() -> str:
    try:
        return _resolved(os.getcwd())
    except OSError:  # the folder was removed
        return ""


def _resolved(folder: str) -> str:
    return os.path.normcase(os.path.realpath(folder))


def import_lightly(module: str, unused: Sequence[str]) -> None:
    """Import a module while some packages appear not to be installed."""
    withheld = [name for name in unused if name not in sys.modules]
    sys.modules.update(dict.fromkeys(withheld))  # type: ignore[arg-type]  # None is how Python marks what is not there
    try:
        importlib.import_module(module)
    finally:
        for name in withheld:
            del sys.modules[name]
