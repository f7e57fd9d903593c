"""Limit on the number of diagnostics of one sidecar."""

from collections.abc import Iterable

from stepbot.diagnostics import Diagnostic, Diagnostics, Span

MOST_FAULTS = 100
"""Maximum number of diagnostics reported for one sidecar."""


class TooManyFaultsError(Exception):
    """The limit was exceeded; the collector has the diagnostics so far."""


class BoundedDiagnostics(Diagnostics):
    """Collects up to :data:`MOST_FAULTS` diagnostics.

    Raises:
        TooManyFaultsError: One more was added.
    """

    def extend(self, diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
        """Add diagnostics, up to the limit."""
        taken = list(diagnostics)
        super().extend(taken[: MOST_FAULTS + 1 - len(self)])
        if len(self) > MOST_FAULTS:
            raise TooManyFaultsError
        return taken

    def hand_over(self, found: Diagnostics, file: str, *, complete: bool) -> None:
        """Add all diagnostics to another collector, in file order, and report if there were more."""
        found.extend(sorted(list(self)[:MOST_FAULTS], key=lambda d: (d.span.line, d.span.column, d.code)))
        if not complete:
            help = ["correct these errors first"]
            found.add(
                "SB110",
                f"sidecar: more than {MOST_FAULTS} errors; the remaining ones are not shown",
                Span(file),
                help=help,
            )
