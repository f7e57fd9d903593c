"""How much is said about one sidecar: a file of garbage must not take minutes to complain about."""

from collections.abc import Iterable

from stepbot.diagnostics import Diagnostic, Diagnostics, Span

MOST_FAULTS = 100
"""Findings that are reported of one sidecar."""


class TooManyFaultsError(Exception):
    """There are more findings than anyone reads; those up to here are in the collector."""


class BoundedDiagnostics(Diagnostics):
    """Collects up to :data:`MOST_FAULTS` findings.

    Raises:
        TooManyFaultsError: One more was added.
    """

    def extend(self, diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
        """Take over findings, up to the bound."""
        taken = list(diagnostics)
        super().extend(taken[: MOST_FAULTS + 1 - len(self)])
        if len(self) > MOST_FAULTS:
            raise TooManyFaultsError
        return taken

    def hand_over(self, found: Diagnostics, file: str, *, complete: bool) -> None:
        """Give everything to another collector, in the order of the file, and say so where there was more."""
        found.extend(sorted(list(self)[:MOST_FAULTS], key=lambda d: (d.span.line, d.span.column, d.code)))
        if not complete:
            help = ["correct these first"]
            found.add("SB108", f"sidecar: more than {MOST_FAULTS} faults; the rest is not shown", Span(file), help=help)
