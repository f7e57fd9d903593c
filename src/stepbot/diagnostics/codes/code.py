"""One diagnostic code with its explanation."""

from typing import Literal, NamedTuple

Severity = Literal["error", "warning", "note"]


class Code(NamedTuple):
    """One kind of diagnostic, with the text that ``stepbot explain`` prints."""

    id: str
    """``SB`` and three digits."""
    severity: Severity
    title: str
    """Noun phrase, without a full stop."""
    explanation: str
    """The condition that is reported, and its consequence for the robot or the run."""
    fix: str
    """Remedy."""
    could_not_run: bool = False
    """Whether the run could not start (exit code 2)."""
    features: str = ""
    """Words after a colon that tell the diagnostics of the code apart, as in ``SB760:armature``; separated by spaces."""
