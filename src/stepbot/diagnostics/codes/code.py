"""What a diagnostic code is."""

from dataclasses import dataclass
from typing import Literal

Severity = Literal["error", "warning", "note"]


@dataclass(frozen=True)
class Code:
    """One kind of finding, with the text that ``stepbot explain`` prints."""

    id: str
    """``SB`` and three digits."""
    severity: Severity
    title: str
    """What it says, in one short line."""
    what: str
    """What stepbot saw."""
    why: str
    """Why it matters."""
    fix: str
    """What to do about it."""
    could_not_run: bool = False
    """Whether stepbot could not do its work at all (exit code 2)."""
