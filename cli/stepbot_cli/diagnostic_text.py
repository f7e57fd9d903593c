"""Diagnostics as text, with code frames or one line each, or as JSON data."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from stepbot.diagnostics import Diagnostic, counted, source_lines
from stepbot.diagnostics.codes import CODES, Severity

from .columns import cells, shortened

FRAME_WIDTH = 120
"""Width of a code frame if the width of the screen is unknown."""
MOST_JUNK = 0.3
"""Share of unprintable characters in a line above which it is not text, and gets no code frame."""
MOST_WARNINGS = 3
"""Number of warnings of one code that the default output shows in full."""
MOST_ERRORS = 5
"""Number of errors of one code that the default output shows in full; of the others it shows the message."""
MOST_NOTES = 6
"""Number of notes of one diagnostic that the default output shows."""
MOST_SUBJECTS = 12
"""Number of further subjects of one finding that the default output names."""
MOST_LIKEWISE = 4
"""Number of further messages with other numbers that the default output shows."""

_MOST: dict[Severity, int] = {"error": MOST_ERRORS, "warning": MOST_WARNINGS}
_COLORS = {"error": "1;31", "warning": "1;33", "note": "1;36"}
_FRAME_COLOR = "34"
_SUBJECT = re.compile(r"(?:^(\w+) )?('[^']+')")
"""The first name in quotes: the subject of a message; a word before it at the beginning is its kind."""
_NAMES = re.compile(rf"((?:'[^']*', ){{{MOST_SUBJECTS}}})((?:'[^']*', )*'[^']*')")
"""A list of more names than the default output shows."""
_NUMBER = re.compile(r"(?<![\w#])[-+]?\d[\d.]*(e[-+]?\d+)?")


def full(
    diagnostics: Sequence[Diagnostic], *, color: bool = False, width: int = FRAME_WIDTH, most_notes: int | None = None
) -> str:
    """Each diagnostic with its source line, notes and help.

    Args:
        width: Width of a code frame.
        most_notes: Number of notes to show of each; None for all.
    """
    lines = source_lines(diagnostics)
    shown = diagnostics if most_notes is None else [_with_notes(d, most_notes) for d in diagnostics]
    return "\n\n".join(_full(d, lines.get((d.span.file, d.span.line)), color, width) for d in shown)


def screen(
    diagnostics: Sequence[Diagnostic],
    *,
    ignored: int = 0,
    color: bool = False,
    width: int | None = None,
    counts: bool = True,
    after_verdict: bool = False,
) -> str:
    """The default output: findings of one cause as one, the first of each code in full, and the counts; no notes.

    Args:
        width: Width of the screen; None if unknown, for lines that are not truncated.
        counts: Whether to end with the number of each severity.
        after_verdict: Whether a verdict has counted errors and warnings already.
    """
    causes = _by_cause(diagnostic for diagnostic in diagnostics if diagnostic.severity != "note")
    in_full, brief, folded = _sorted_out([_with_fewer_names(one) for one in causes])
    lines = [full(in_full, color=color, width=width or FRAME_WIDTH, most_notes=MOST_NOTES), ""] if in_full else []
    lines += [*(_headline(error, color) for error in brief), ""] if brief else []
    lines += [_fold(of_code, color, width) for of_code in folded]
    if counts:
        in_part = brief or folded or any(len(one.notes) > MOST_NOTES or _NAMES.search(one.message) for one in causes)
        all_shown = not in_part and len(causes) == len(diagnostics)
        lines.append(summary(diagnostics, all_shown=all_shown, ignored=ignored, after_verdict=after_verdict))
    return "\n".join(lines).rstrip()


def _by_cause(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """One diagnostic for all whose messages differ in their subject alone, or are warnings that differ in numbers, too.

    It is the first, which names the others.
    """
    causes: dict[tuple[str, ...], list[Diagnostic]] = {}
    for diagnostic in diagnostics:
        cause = _without_subject(diagnostic)
        cause = _NUMBER.sub("0", cause) if diagnostic.severity == "warning" else cause
        causes.setdefault((diagnostic.code, diagnostic.severity, diagnostic.span.file, cause), []).append(diagnostic)
    return [_merged(first, others) if others else first for first, *others in causes.values()]


def _without_subject(diagnostic: Diagnostic) -> str:
    name = _SUBJECT.search(diagnostic.message)
    return diagnostic.message.replace(name[0], "''").replace(name[2], "''") if name else diagnostic.message


def _merged(first: Diagnostic, others: Sequence[Diagnostic]) -> Diagnostic:
    """A diagnostic that names the others, or has their messages where these differ, and the remedies that differ."""
    kind, name = _kind(first), _subject(first)
    shown = {
        f"{'' if _kind(other) == kind else _kind(other)}{_subject(other)}{_line(other)}": other
        for other in others[:MOST_SUBJECTS]
    }
    usual = [text.replace(name, "''") for text in first.help]
    own = [
        f"{place}: {one.help[0]}"
        for place, one in shown.items()
        if one.help and one.help[0].replace(_subject(one), "''") not in usual
    ]
    notes = [f"the same for {', '.join(shown)}{_beyond(others, MOST_SUBJECTS)}"]
    if any(_without_subject(other) != _without_subject(first) for other in others):
        notes = [f"likewise {other.message}{_line(other)}" for other in others[:MOST_LIKEWISE]]
        notes[-1] += _beyond(others, MOST_LIKEWISE)
    return first._replace(notes=(*notes, *first.notes), help=(*first.help, *own))


def _beyond(others: Sequence[Diagnostic], most: int) -> str:
    return f" and {len(others) - most} more" if len(others) > most else ""


def _kind(diagnostic: Diagnostic) -> str:
    """What the subject is, with a blank after it: ``joint``; empty where the message does not begin with it."""
    name = _SUBJECT.search(diagnostic.message)
    return f"{name[1]} " if name and name[1] else ""


def _subject(diagnostic: Diagnostic) -> str:
    """The first name in quotes; the place if there is none."""
    name = _SUBJECT.search(diagnostic.message)
    return name[2] if name else str(diagnostic.span)


def _line(diagnostic: Diagnostic) -> str:
    return f" (line {diagnostic.span.line})" if diagnostic.span.line and _SUBJECT.search(diagnostic.message) else ""


def _with_notes(diagnostic: Diagnostic, most: int) -> Diagnostic:
    """The diagnostic with its first notes, and the number of the others."""
    rest = len(diagnostic.notes) - most
    if rest <= 0:
        return diagnostic
    more = counted(rest, "more note")
    return diagnostic._replace(notes=(*diagnostic.notes[:most], more))


def _with_fewer_names(diagnostic: Diagnostic) -> Diagnostic:
    """The diagnostic with the first of many names in its message, and the number of the others."""
    rest = _NAMES.search(diagnostic.message)
    if rest is None:
        return diagnostic
    number = len(re.findall(r"'[^']*'", rest[2]))
    return diagnostic._replace(
        message=_NAMES.sub(lambda names: f"{names[1][:-2]} and {number} more", diagnostic.message, count=1)
    )


def _sorted_out(diagnostics: Sequence[Diagnostic]) -> tuple[list[Diagnostic], list[Diagnostic], list[list[Diagnostic]]]:
    """Findings to show in full (some of each code), further errors, and further warnings by code."""
    in_full: list[Diagnostic] = []
    brief: list[Diagnostic] = []
    folded: dict[str, list[Diagnostic]] = {}
    counts: Counter[str] = Counter()
    for diagnostic in diagnostics:
        counts[diagnostic.code] += 1
        if counts[diagnostic.code] <= _MOST[diagnostic.severity]:
            in_full.append(diagnostic)
        elif diagnostic.severity == "error":
            brief.append(diagnostic)
        else:
            folded.setdefault(diagnostic.code, []).append(diagnostic)
    return in_full, brief, list(folded.values())


def _fold(diagnostics: Sequence[Diagnostic], color: bool, width: int | None) -> str:
    """One line for further warnings of one code: their number and the code's title."""
    first = diagnostics[0]
    text = f"{len(diagnostics)} more: {CODES[first.code].title}"
    head = f"{first.severity}[{first.code}]"
    room = None if width is None else max(width - len(head) - 2, 1)
    return f"{paint(head, _COLORS[first.severity], color)}: {text if room is None else shortened(text, room)}"


def concise(diagnostics: Iterable[Diagnostic], *, color: bool = False) -> str:
    """One line per finding: ``file:line:column: severity[CODE]: message``."""
    return "\n".join(_headline(diagnostic, color) for diagnostic in diagnostics)


def plain(diagnostic: Diagnostic) -> dict[str, Any]:
    """A diagnostic as JSON; ``line`` 0 means the file as a whole."""
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity,
        "message": diagnostic.message,
        "file": diagnostic.span.file,
        "line": diagnostic.span.line,
        "column": diagnostic.span.column,
        "end_column": diagnostic.span.end_column,
        "help": list(diagnostic.remedies),
        "notes": list(diagnostic.notes),
    }


def counts_of(diagnostics: Iterable[Diagnostic], *severities: Severity) -> str:
    """``2 errors, 1 warning``: how many diagnostics there are of these severities; empty without any."""
    numbers = Counter(diagnostic.severity for diagnostic in diagnostics)
    return ", ".join(counted(numbers[severity], severity) for severity in severities if numbers[severity])


def count_of_causes(diagnostics: Iterable[Diagnostic]) -> str:
    """``12 errors of 2 causes, 1 warning``: where findings share a cause, how many causes there are, too."""
    findings = list(diagnostics)
    words = []
    for severity in _MOST:
        alike = [diagnostic for diagnostic in findings if diagnostic.severity == severity]
        causes = len(_by_cause(alike))
        words += [counts_of(alike, severity) + (f" of {counted(causes, 'cause')}" if causes < len(alike) else "")]
    return ", ".join(filter(None, words))


def summary(
    diagnostics: Iterable[Diagnostic],
    *,
    all_shown: bool = True,
    ignored: int = 0,
    explain: bool = True,
    after_verdict: bool = False,
) -> str:
    """``2 errors, 1 warning``, and how to learn more, or see all of them; after a verdict, what to do next."""
    shown = list(diagnostics)
    text = counts_of(shown, *(("note",) if after_verdict else ("error", "warning", "note")))
    text = ", ".join(filter(None, (text, f"{ignored} ignored" if ignored else "")))
    codes = [CODES[d.code].id for severity in ("error", "warning") for d in shown if d.severity == severity]
    more = f"stepbot explain {codes[0]}" if codes and explain else ""
    hidden = "" if all_shown else "-v shows all"
    if after_verdict:
        rest = f"{text} ({hidden})" if text and hidden else text or hidden
        return "    ".join(filter(None, (f"next: {more}" if more else "", rest)))
    ways = [*([f"more: {more}"] if more else []), *([hidden] if hidden else [])]
    return f"{text} ({'; '.join(ways)})" if ways else text


def printable(text: str) -> str:
    """``text`` without control characters: names from a file must not control the terminal."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in "\n " else repr(c)[1:-1] for c in text.replace("\t", " "))


def _full(diagnostic: Diagnostic, source_line: str | None, color: bool, width: int) -> str:
    gutter = " " * len(str(diagnostic.span.line))
    parts = [_headline(diagnostic, color)]
    if source_line is not None:
        parts += _frame(diagnostic, source_line, gutter, color, width)
    for word, texts in (("note", diagnostic.notes), ("help", diagnostic.remedies)):
        for text in texts:
            first, *rest = printable(text).split("\n")
            parts.append(f"{gutter} {paint('=', _FRAME_COLOR, color)} {paint(word, '1', color)}: {first}")
            parts += [f"{gutter}   {' ' * len(word)}  {line}" for line in rest]
    return "\n".join(part.rstrip() for part in parts)


def _headline(diagnostic: Diagnostic, color: bool) -> str:
    place = paint(printable(str(diagnostic.span)), "1", color)
    kind = paint(f"{diagnostic.severity}[{diagnostic.code}]", _COLORS[diagnostic.severity], color)
    return f"{place}: {kind}: {printable(diagnostic.message)}"


def _frame(diagnostic: Diagnostic, source_line: str, gutter: str, color: bool, width: int) -> list[str]:
    """The source line, with the place marked below it; empty if the line is not text."""
    span = diagnostic.span
    start = max(span.column - 1, 0)
    end = max(span.end_column - 1, start + 1)
    room = max(width - len(gutter) - len(" | "), 1)
    cut, stop = _window(source_line, start, room)
    if _is_binary(source_line[cut:stop]):
        return []
    before = ("…" if cut else "") + _one_cell_controls(source_line[cut:start])
    marked = _one_cell_controls(source_line[start : min(end, stop)])
    after = _one_cell_controls(source_line[max(min(end, stop), start) : stop])
    after += "…" if stop < len(source_line) else ""
    bar = paint("|", _FRAME_COLOR, color)
    mark = paint("^" * max(cells(marked), 1), _COLORS[diagnostic.severity], color)
    frame = [f"{gutter} {bar}", f"{paint(str(span.line), _FRAME_COLOR, color)} {bar} {before}{marked}{after}"]
    return [*frame, f"{gutter} {bar} {' ' * cells(before)}{mark}"] if span.column else frame


def _window(line: str, start: int, room: int) -> tuple[int, int]:
    """Start and end of the displayed part of a line: around ``start``, with ellipses no wider than ``room``."""
    if len(line) <= 2 * room and cells(line) <= room:
        return 0, len(line)
    cut = stop = min(start, len(line))
    while cut > 0 and cells(line[cut - 1 : start]) <= room // 2:
        cut -= 1
    while stop < len(line) and cells(line[cut : stop + 1]) <= room - 2:
        stop += 1
    return cut, stop


def _is_binary(text: str) -> bool:
    """Whether a text is the content of a binary file, or in another encoding."""
    junk = sum(c == "\ufffd" or not (c.isprintable() or c.isspace()) for c in text)
    return "\0" in text or junk > MOST_JUNK * len(text)


def _one_cell_controls(text: str) -> str:
    """Each control character replaced by one space or replacement character, so that the mark below stays in place."""
    return "".join(c if c.isprintable() else " " if c.isspace() else "\ufffd" for c in text)


def paint(text: str, codes: str, color: bool) -> str:
    """``text`` in a colour of the terminal, if colours are enabled."""
    return f"\x1b[{codes}m{text}\x1b[0m" if color else text
