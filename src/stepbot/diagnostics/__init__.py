"""Diagnostics: errors, warnings and notes with a code, a position and a remedy.

Invalid input is reported as diagnostics, all of them at once. :class:`StepbotError` is raised only at the end of a
stage with errors; any other exception is a bug and keeps its traceback. All codes are in
:mod:`stepbot.diagnostics.codes`.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Literal, NamedTuple

from .codes import CODES, Severity, current, full_code, selects

LARGEST_SOURCE = 16 * 2**20
"""Size [bytes] of a file above which no lines are read, because reading it again would take too long."""


_LONGEST_COMPARED = 200
"""Maximum length of a name to compare with similar names."""
ExitCode = Literal[0, 1, 2]
NOT_TEXT = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff\ufffe\uffff]")
"""What no sidecar may contain: what YAML does not allow, and three rare characters that it treats as line ends and
editors do not. (Named by what it may contain, the class takes ten times as long to compile, in every process.)"""


class Span(NamedTuple):
    """A place in a file. Lines and columns count from 1; line 0 means the whole file, column 0 the whole line."""

    file: str
    line: int = 0
    column: int = 0
    end_column: int = 0
    """Column after the last character on ``line``; 0 if the extent is unknown."""

    def __str__(self) -> str:
        return ":".join(map(str, filter(None, (self.file, self.line, self.column))))


class Diagnostic(NamedTuple):
    """An error, a warning or a note."""

    code: str
    """One of :data:`CODES`, some with a feature after a colon: ``SB760:armature``."""
    severity: Severity
    message: str
    """``subject: problem``, one line, no full stop."""
    span: Span
    help: tuple[str, ...] = ()
    """Remedies, most useful first; near matches and snippets to paste."""
    notes: tuple[str, ...] = ()
    """Facts that explain the message: candidates, measured values."""

    @property
    def remedies(self) -> tuple[str, ...]:
        """:attr:`help`; for an error without help, the remedy of its code."""
        return self.help or ((CODES[self.code].fix,) if self.severity == "error" else ())

    def after(self, command: str) -> "Diagnostic":
        """The diagnostic with the remedies of its code for one command: ``After `verify`, ...``."""
        if self.help or "After `" not in CODES[self.code].fix:
            return self
        sentences = re.split(r"(?<=\.) (?=[A-Z])", CODES[self.code].fix)
        words = [text.removeprefix(f"After `{command}`, ") for text in sentences]
        return self._replace(help=(" ".join(text[0].upper() + text[1:] for text in words if text[:7] != "After `"),))

    def __str__(self) -> str:
        return f"{self.span}: {self.severity}[{self.code}]: {self.message}"


class Finding(NamedTuple):
    """A diagnostic of a part of a robot, by whom its place in a file is not known."""

    code: str
    message: str
    help: tuple[str, ...] = ()


class Ignore(NamedTuple):
    """A rule that suppresses diagnostics of one code, everywhere or for one subject. Errors are never suppressed."""

    code: str
    span: Span
    subject: str = ""
    """Subject at the start of the messages to suppress; empty for all subjects."""
    first_line: int = 0
    """First line of the subject in the file of ``span``."""
    last_line: int = 0
    """Last line of the subject."""
    pattern: str = ""
    """Glob of component paths whose diagnostics are suppressed, too."""

    def covers(self, diagnostic: Diagnostic) -> bool:
        """Whether a diagnostic is suppressed; a summary of several places only by rules without a subject."""
        if not selects(self.code, diagnostic.code) or diagnostic.severity == "error":
            return False
        if not self.subject or diagnostic.message.startswith(f"{self.subject}: "):
            return True
        named = re.match(r"'(.+?)': ", diagnostic.message)
        if self.pattern and named:
            return _matches(named[1], self.pattern)
        return self.holds_at(diagnostic.span) and not diagnostic.notes

    def holds_at(self, span: Span) -> bool:
        """Whether the rule is about one subject, and a place is within that subject."""
        return span.file == self.span.file and 0 < self.first_line <= span.line <= self.last_line


def _matches(path: str, pattern: str) -> bool:
    """Whether a glob matches a path: ``*`` within a name, ``**/`` any folders; without ``*`` the end of the path."""
    expression = re.escape(pattern).replace(r"\*\*/", "(.+/)?").replace(r"\*\*", ".*").replace(r"\*", "[^/]*")
    return re.fullmatch(expression if "*" in pattern else f"(.+/)?{expression}", path) is not None


class Diagnostics:
    """The diagnostics of one run, in the order in which they were added."""

    def __init__(self) -> None:
        self._reported: dict[Diagnostic, None] = {}
        self._ignores: list[Ignore] = []
        self._ignored: dict[Diagnostic, None] = {}

    def add(
        self, code: str, message: str, span: Span, *, help: Iterable[str] = (), notes: Iterable[str] = ()
    ) -> Diagnostic:
        """Add a diagnostic with the severity of its code.

        Raises:
            KeyError: There is no such code.
        """
        diagnostic = Diagnostic(code, CODES[code].severity, one_line(message), span, tuple(help), tuple(notes))
        return self.extend([diagnostic])[0]

    def extend(self, diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
        """Add diagnostics; duplicates are dropped."""
        taken = list(diagnostics)
        for diagnostic in taken:
            ignored = any(rule.covers(diagnostic) for rule in self._ignores)
            (self._ignored if ignored else self._reported)[diagnostic] = None
        return taken

    def ignore(self, rules: Iterable[Ignore]) -> None:
        """Suppress diagnostics that match these rules, already added ones included."""
        self._ignores += rules
        earlier, self._reported = self._reported, {}
        self.extend(earlier)

    def ignores_at(self, code: str, span: Span) -> bool:
        """Whether a rule of the subject at a place suppresses a code, for summaries, which no such rule covers."""
        return any(selects(rule.code, code) and rule.holds_at(span) for rule in self._ignores)

    def add_ignored(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Add diagnostics that were suppressed in another run."""
        self._ignored.update(dict.fromkeys(diagnostics))

    @property
    def ignored(self) -> tuple[Diagnostic, ...]:
        """Suppressed diagnostics."""
        return tuple(self._ignored)

    @property
    def unused_ignores(self) -> tuple[Ignore, ...]:
        """Rules that match no diagnostic."""
        return tuple(rule for rule in self._ignores if not any(map(rule.covers, self._ignored)))

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self._reported)

    def __len__(self) -> int:
        return len(self._reported)

    @property
    def has_errors(self) -> bool:
        """Whether any diagnostic is an error."""
        return any(d.severity == "error" for d in self._reported)

    @property
    def exit_code(self) -> ExitCode:
        """0 without errors, 1 with errors, 2 if stepbot could not run."""
        errors = [d for d in self._reported if d.severity == "error"]
        if any(CODES[d.code].could_not_run for d in errors):
            return 2
        return 1 if errors else 0

    def make_strict(self) -> None:
        """Turn every warning into an error (``--strict``)."""
        self._reported = {d._replace(severity="error") if d.severity == "warning" else d: None for d in self._reported}

    def raise_if_errors(self) -> None:
        """Raise if any diagnostic is an error.

        Raises:
            StepbotError: At least one diagnostic is an error.
        """
        if self.has_errors:
            raise StepbotError(self)


class StepbotError(Exception):
    """A stage ended with errors; ``diagnostics`` holds all diagnostics so far."""

    def __init__(self, diagnostics: Diagnostics) -> None:
        self.diagnostics = diagnostics
        super().__init__("\n".join(str(d) for d in diagnostics if d.severity == "error"))


def one_line(text: str) -> str:
    """``text`` with line breaks and control characters as escapes: names in files may hold any character."""
    return text if text.isprintable() else "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def counted(number: int, singular: str, plural: str = "") -> str:
    """``1 link``, ``2 links``, ``2 axes`` where ``plural`` is given."""
    return f"{number} {singular if number == 1 else plural or singular + 's'}"


def listed(names: Sequence[str], most: int) -> str:
    """The first names, quoted, and the number of the others: ``'a', 'b' and 3 more``."""
    shown = ", ".join(f"'{name}'" for name in names[:most])
    return f"{shown} and {len(names) - most} more" if len(names) > most else shown


def cut(notes: Sequence[str], most: int) -> list[str]:
    """The first notes, and the number of the others as the last one."""
    return [*notes[:most], *([f"and {len(notes) - most} more"] if len(notes) > most else [])]


def did_you_mean(word: str, candidates: Iterable[str], least: float = 0.6) -> tuple[str, ...]:
    """``help`` for a misspelt name: the same in other case, else the nearest candidates, else nothing.

    Args:
        least: Similarity of a candidate, of at most 1.
    """
    from difflib import get_close_matches  # only some findings need it

    names = list(dict.fromkeys(candidates))
    same = [name for name in names if name.casefold() == word.casefold()]
    comparable = [name for name in names if len(name) <= _LONGEST_COMPARED]  # the comparison takes quadratic time
    near = same or (get_close_matches(word, comparable, n=3, cutoff=least) if len(word) <= _LONGEST_COMPARED else [])
    if not near:
        return ()
    return ("did you mean " + " or ".join(f"'{name}'" for name in near) + "?",)


def code_to_ignore(given: str) -> str:
    """The full code of warnings and notes to suppress.

    Raises:
        ValueError: There is no such code, or it is one of errors.
    """
    code = full_code(given)
    if not (known := current(code)):
        near = "".join(did_you_mean(code, CODES)) or "list all codes with `stepbot explain`"
        raise ValueError(f"unknown code '{code}'; {near}")
    if all(CODES[one].severity == "error" for one in known):
        raise ValueError(f"{code} is an error, which cannot be ignored")
    return code


def source_lines(diagnostics: Iterable[Diagnostic]) -> dict[tuple[str, int], str]:
    """The source lines of diagnostics, each file read once; an unreadable file gives none."""
    wanted: dict[str, set[int]] = {}
    for diagnostic in diagnostics:
        if diagnostic.span.line:
            wanted.setdefault(diagnostic.span.file, set()).add(diagnostic.span.line)
    texts: dict[tuple[str, int], str] = {}
    for file, numbers in wanted.items():
        try:
            if Path(file).stat().st_size > LARGEST_SOURCE:
                continue
            with Path(file).open(encoding="utf-8", errors="replace") as source:
                for number, line in enumerate(source, start=1):
                    if number in numbers:
                        texts[file, number] = line.removeprefix("\ufeff").rstrip("\n")
                    if number >= max(numbers):
                        break
        except OSError:  # missing or unreadable now: the headline is sufficient
            continue
    return texts
