"""Identifies the input that crashed a process, and skips it in the next one: for systems without fork.

Before each input the process writes its number to a file. A timer of the C library ends the process if an input takes
too long, even in native code. The parent reads the file, and starts another process that skips this input.
"""

import contextlib
import faulthandler
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

_AT_HAND, _LATE = "at hand", "late"


@dataclass(frozen=True)
class Attempt:
    """One process's attempt at all inputs."""

    folder: str
    """File for the current input, shared with the parent."""
    seconds: float
    """Time limit [s] of an input."""
    died: tuple[tuple[int, str], ...] = ()
    """Inputs that ended earlier processes, with the reason."""

    def reason(self, number: int) -> str | None:
        """Why an input is skipped; None if it is not."""
        return dict(self.died).get(number)

    @contextlib.contextmanager
    def at(self, number: int) -> Iterator[None]:
        """Process an input; ends the process if it takes too long."""
        at_hand = Path(self.folder, _AT_HAND)
        at_hand.write_text(str(number), encoding="ascii")
        with Path(self.folder, _LATE).open("wb") as late:
            faulthandler.dump_traceback_later(self.seconds, exit=True, file=late)
            try:
                yield
            finally:
                faulthandler.cancel_dump_traceback_later()
        at_hand.unlink()

    def after(self, reason: str) -> "Attempt | None":
        """The next attempt, after a process ended for a reason; None if it was not processing an input."""
        at_hand, late = Path(self.folder, _AT_HAND), Path(self.folder, _LATE)
        try:
            number = int(at_hand.read_text(encoding="ascii"))
        except (FileNotFoundError, ValueError):  # it ended before, between or after the inputs
            return None
        if self.reason(number) is not None:
            return None
        if late.stat().st_size:  # the timer's traceback
            reason = f"time limit of {self.seconds:g} s exceeded"
        at_hand.unlink()
        return replace(self, died=(*self.died, (number, reason)))
