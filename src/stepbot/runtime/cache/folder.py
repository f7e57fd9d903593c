"""Default folder of the cache on this system."""

import os
import sys
from pathlib import Path

_NAME = "stepbot"


def default_folder() -> Path:
    r"""stepbot's cache folder, whether it exists or not.

    ``$XDG_CACHE_HOME/stepbot``, else ``~/.cache/stepbot`` (https://specifications.freedesktop.org/basedir-spec);
    ``~/Library/Caches/stepbot`` on macOS, ``%LOCALAPPDATA%\stepbot\Cache`` on Windows.
    """
    if sys.platform == "win32":
        return _set("LOCALAPPDATA", Path.home() / "AppData" / "Local") / _NAME / "Cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / _NAME
    return _set("XDG_CACHE_HOME", Path.home() / ".cache") / _NAME


def _set(variable: str, otherwise: Path) -> Path:
    """The folder in an environment variable; a relative path counts as unset, as the XDG specification requires."""
    value = os.environ.get(variable, "")
    return Path(value) if value and Path(value).is_absolute() else otherwise
