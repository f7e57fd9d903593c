"""Gazebo's own SDFormat parser, libsdformat, through its command: ``gz sdf`` or, in older distributions, ``ign sdf``.

It reports whether the file is valid, and warnings. Its exit code is not sufficient: a file of a newer version of the
format is ``Valid.``, after an error message. https://gazebosim.org/libs/sdformat
"""

import os
import re
import subprocess
import tempfile
from functools import cache
from pathlib import Path

from stepbot.runtime.programs import sdf_programs

from ..observation import EngineCannotRead, EngineRefused, Observation, Quantity, Request
from . import ENGINE

_TOLD = frozenset({Quantity.LOAD, Quantity.WARNINGS})
_ONLY_PARSES = "its command only validates files"
_COLOR = re.compile(r"\x1b\[[0-9;]*m")
_PLACE = re.compile(r"^(Error|Warning) \[[^\]]*\]\s*|^Error Code \d+:\s*(\[[^\]]*\]:\s*)?(Msg:\s*)?")
_LATER = re.compile(r"Unable to convert from SDF version (\S+) to (\S+)")
_SECONDS = 120.0


@cache
def _command() -> tuple[str, str] | None:
    """The command that has ``sdf`` as a subcommand, and its latest version; each run takes a third of a second."""
    for program in sdf_programs():
        if versions := _run(program, "--versions").strip().splitlines():
            return program, versions[-1].strip()
    return None


def _run(program: str, *arguments: str) -> str:
    """The output of ``sdf``, errors included."""
    command = [program, "sdf", *arguments]
    run = subprocess.run(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
        text=True,
        encoding="utf-8",
        errors="replace",
        timeout=_SECONDS,
        env={**os.environ, "HOME": tempfile.gettempdir()},  # libsdformat writes a log into the user's home
    )
    return "" if run.returncode and arguments == ("--versions",) else run.stdout


def prepare() -> None:
    """Nothing to import: the command is a separate program."""


def observe(request: Request) -> Observation:
    """Check the file with libsdformat.

    Raises:
        EngineRefused: It reports an error in the file.
        EngineCannotRead: The file is of a newer version than it supports, or the command is missing.
    """
    command = _command()
    if command is None:
        raise EngineCannotRead("neither `gz sdf` nor `ign sdf` is installed")
    program, version = command
    folder = f"{Path(request.file).parent.as_posix()}/"
    text = _COLOR.sub("", _run(program, "--check", request.file)).replace(folder, "")
    later = _LATER.search(text)
    if later is not None:
        raise EngineCannotRead(f"the file has version {later[1]}; the installed libsdformat reads up to {later[2]}")
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    # A library that only formats backtraces; its absence is not about the file.
    lines = [line for line in lines if "backward.so" not in line]
    if "Valid." not in lines:
        raise EngineRefused("; ".join(dict.fromkeys(_PLACE.sub("", line) for line in lines)))
    return Observation(
        engine=ENGINE.name,
        version=version,
        format=request.format,
        warnings=tuple(dict.fromkeys(_PLACE.sub("", line) for line in lines if line != "Valid.")),
        not_run={quantity: _ONLY_PARSES for quantity in Quantity if quantity not in _TOLD},
    )
