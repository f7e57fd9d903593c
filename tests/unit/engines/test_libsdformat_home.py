"""libsdformat writes nothing into the user's home, and its command runs no more often than needed."""

import os
from pathlib import Path

import pytest

from stepbot.engines.libsdformat import observer
from stepbot.engines.observation import Request

_PROGRAM = """#!/bin/sh
mkdir -p "$HOME/.sdformat" && echo log > "$HOME/.sdformat/sdformat.log"
echo "$2" >> "$(dirname "$0")/calls"
case "$2" in --versions) printf '12.7.2\\n';; *) echo Valid.;; esac
"""


@pytest.mark.skipif(os.name != "posix", reason="the program is a shell script")
def test_log_of_libsdformat_is_a_temporary_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its library opens a log below $HOME when it is loaded; the version is read once, since a run takes a while."""
    home, programs = tmp_path / "home", tmp_path / "bin"
    home.mkdir()
    programs.mkdir()
    (programs / "gz").write_text(_PROGRAM)
    (programs / "gz").chmod(0o755)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("PATH", str(programs), prepend=os.pathsep)
    observer._command.cache_clear()
    try:
        seen = observer.observe(Request(str(tmp_path / "a.sdf"), "sdf", configurations=({},)))
    finally:
        observer._command.cache_clear()
    assert seen.version == "12.7.2"
    assert not list(home.iterdir())
    assert (programs / "calls").read_text().split() == ["--versions", "--check"]
