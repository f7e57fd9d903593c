"""Names the input over which a process ended, and spares it that one next time: for systems that cannot fork.

Before each input the process writes the number of the input into a file. A timer of the C library ends the process when
an input takes too long, in native code too. Whoever started the process reads the file, and starts another one, which
leaves that input out.
"""

import contextlib
import faulthandler
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

BODY_SECONDS = 120.0
"""Time that a body may take: of the processor in a forked process, else by the clock. Large ones take a few seconds."""

_AT_HAND, _LATE = "at hand", "late"


@dataclass(frozen=True)
class Attempt:
    """One process's turn at all inputs."""

    folder: str
    """Where it says what it is doing; both sides know it."""
    seconds: float
    """Time [s] that an input may take."""
    died: tuple[tuple[int, str], ...] = ()
    """Inputs that ended earlier processes, with the reason."""

    def reason(self, number: int) -> str | None:
        """Why an input is left out; None where it is not."""
        return dict(self.died).get(number)

    @contextlib.contextmanager
    def at(self, number: int) -> Iterator[None]:
        """Work on an input; ends the process if that takes too long."""
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
        """The next attempt, once a process has ended for a reason; None where no input was at hand."""
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
