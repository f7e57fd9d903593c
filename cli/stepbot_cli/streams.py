"""Standard streams that are closed, or lead to something that is full."""

import contextlib
import os
import sys
from typing import TextIO


class CannotPrint(Exception):
    """Standard output takes no more; the message is the system's reason."""


def open_closed_streams() -> None:
    """Let closed standard streams, as those of daemons, lead nowhere: files opened later must not take their place."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            with contextlib.suppress(OSError):
                while (opened := os.open(os.devnull, os.O_RDWR)) < number:
                    pass
                if opened != number:
                    os.close(opened)
            setattr(sys, name, open(os.devnull, "w" if number else "r", encoding="utf-8"))  # noqa: PTH123, SIM115


def discard(stream: TextIO) -> None:
    """Let what a stream still holds, and gets, lead nowhere: Python writes it again when it ends."""
    with contextlib.suppress(OSError, ValueError):  # not a stream of the system
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
