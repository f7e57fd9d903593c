"""The cache folder of each system."""

import sys
from pathlib import Path

import pytest

from stepbot.runtime.cache import default_folder

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="paths of POSIX systems")


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home folder, with the related environment variables unset."""
    monkeypatch.setenv("HOME", str(tmp_path))
    for variable in ("XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(variable, raising=False)
    return tmp_path


def test_linux(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On Linux the cache is in an absolute ``XDG_CACHE_HOME``, else in ``~/.cache``."""
    monkeypatch.setattr(sys, "platform", "linux")
    assert default_folder() == home / ".cache" / "stepbot"
    monkeypatch.setenv("XDG_CACHE_HOME", "/var/cache/me")
    assert default_folder() == Path("/var/cache/me/stepbot")
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert default_folder() == home / ".cache" / "stepbot"


def test_macos(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On macOS the cache is in ``~/Library/Caches``."""
    monkeypatch.setattr(sys, "platform", "darwin")
    assert default_folder() == home / "Library" / "Caches" / "stepbot"


def test_windows(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On Windows the cache is in ``%LOCALAPPDATA%``, else in its default location."""
    monkeypatch.setattr(sys, "platform", "win32")
    assert default_folder() == home / "AppData" / "Local" / "stepbot" / "Cache"
    monkeypatch.setenv("LOCALAPPDATA", "/c/local")
    assert default_folder() == Path("/c/local/stepbot/Cache")
