"""Diagnostics for YAML syntax errors, and recovery of the remaining text.

The parser stops at the first error. To report further errors, the enclosing top-level section is blanked, which keeps
line numbers, and the text is parsed again.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from msgspec import Struct
from ruamel.yaml.error import MarkedYAMLError, StringMark

from stepbot.diagnostics import Diagnostics, Span

from .compose import STAR, TooMuchError, compose
from .text import BoundedDiagnostics, TooManyFaultsError
from .tree import Tree

MOST_ATTEMPTS = 8
"""Maximum number of syntax errors reported per file."""
MOST_TEXT = 1 << 18
"""Maximum number of characters parsed in all attempts, which bounds the time for large invalid files."""

_OPENERS = {"sequence": ("[", "]"), "mapping": ("{", "}")}
_TOP_LEVEL_KEY = re.compile(r"[^\s#\]})]")


class ParsedText(Struct, frozen=True):
    """The parsed part of a text."""

    tree: Tree | None
    whole: bool
    """Whether all of the text is in the tree; False if sections with syntax errors are missing."""


def compose_around_faults(text: str, file: str, diagnostics: Diagnostics) -> ParsedText:
    """The tree of all valid sections; every syntax error is reported.

    Reports SB104 syntax, SB104 tabs, SB104 unquoted paths, and the errors of :func:`stepbot.sidecar.compose.compose`.
    """
    lines = text.split("\n")
    _quote_starred_keys(lines, file, diagnostics)
    spoiled: set[int] = set()
    whole, budget = True, MOST_TEXT
    for _ in range(MOST_ATTEMPTS):
        attempt = BoundedDiagnostics()
        budget -= len(text)
        try:
            tree = compose("\n".join(lines), file, attempt)
        except (TooMuchError, TooManyFaultsError):
            diagnostics.extend(attempt)
            return ParsedText(None, False)
        except MarkedYAMLError as failure:
            whole = False
            if "'\\t'" in str(failure.problem) and (
                tabbed := _untabbed(lines, failure.problem_mark, file, diagnostics)
            ):
                spoiled |= tabbed
                continue
            fault = _Fault(failure, lines, file)
            section = fault.section()
            diagnostics.extend(d for d in attempt if d.span.line - 1 in section)
            # An unquoted path or a missing colon is reported at its position, not with the parser's error as well.
            reported = any(d.span.line == fault.line and d.code == "SB104" for d in diagnostics)
            if spoiled.isdisjoint(section) and not reported:
                fault.report(diagnostics)
            if budget < len(text) or fault.ends_document or not _blank(lines, section):
                return ParsedText(None, False)
        else:
            diagnostics.extend(attempt)
            return ParsedText(tree, whole)
    return ParsedText(None, False)


_STARRED_KEY = re.compile(r"(?P<indent> *(?:- +)?)(?P<path>\*(?:[^\"'{}\[\],#:]*[^\s\"'{}\[\],#:])?):(?=\s|$)")


def _quote_starred_keys(lines: list[str], file: str, diagnostics: Diagnostics) -> None:
    """Report keys such as ``**/M3*:`` without quotes, and make them keys again.

    (An alias as a key needs a space before its colon, so that this is never one.)
    """
    for number, line in enumerate(lines):
        if match := _STARRED_KEY.match(line):
            path, column = match["path"], match.start("path")
            help = [f'quote paths that start with *: "{path}"']
            span = Span(file, number + 1, column + 1, column + 1 + len(path))
            diagnostics.add("SB104", f"sidecar: undefined alias {path}", span, help=help)
            lines[number] = line[:column] + STAR + line[column + 1 :]


_TAB_BETWEEN = re.compile(r"[^'\"#\t{\[]*[^'\"#\s{\[] *(\t+)")
"""A line up to a tab that is not in its indentation, in a string, in a comment, or in brackets, where it is a space."""


def _untabbed(lines: list[str], mark: StringMark | None, file: str, diagnostics: Diagnostics) -> set[int]:
    """Report tabs used as indentation (SB104), replace them by spaces in ``lines``, and return their lines.

    ``mark`` is the tab that the parser rejected.
    """
    tabbed = set()
    for number, line in enumerate(lines):
        body = line.lstrip()
        indent = line[: len(line) - len(body)]
        if not body or body.startswith("#"):
            continue
        if "\t" in indent:
            column, end, what = indent.index("\t"), len(indent), "tab in indentation"
            help = f"indent with spaces, two per level: `{indent.replace(chr(9), '  ')}{body}`"
            # One space per tab: lines that are indented with tabs only keep their order, and columns stay.
            lines[number] = line.replace("\t", " ", indent.count("\t"))
        elif refused := _refused_tab(line, mark if mark is not None and mark.line == number else None):
            (column, end), what = refused, "tab used as a separator"
            help = f"write `{re.sub(r' *' + chr(9) + r'+ *', ' ', body)}`"
            lines[number] = line.replace("\t", " ")
        else:
            continue
        diagnostics.add("SB104", f"sidecar: {what}", Span(file, number + 1, column + 1, end + 1), help=[help])
        tabbed.add(number)
    return tabbed


def _refused_tab(line: str, mark: StringMark | None) -> tuple[int, int] | None:
    """First column of the tab that a parser rejects in a line, and the one after it."""
    if mark is not None and line[mark.column : mark.column + 1] == "\t":
        return mark.column, mark.column + 1
    between = _TAB_BETWEEN.match(line)
    return between.span(1) if between else None


def _blank(lines: list[str], section: Iterable[int]) -> bool:
    """Blank the lines of a section; False if they are blank already."""
    full = [number for number in section if lines[number].strip()]
    for number in full:
        lines[number] = ""
    return bool(full)


class _Fault:
    """A syntax error with its position and message."""

    def __init__(self, failure: MarkedYAMLError, lines: Sequence[str], file: str) -> None:
        self._lines, self._file = lines, file
        self._problem, self._context = str(failure.problem or ""), str(failure.context or "")
        self._mark = _clipped(failure.problem_mark or failure.context_mark, lines)
        self._start = _clipped(failure.context_mark, lines) if failure.context_mark else self._mark
        self._keyless = _keyless_line(self._problem, self._mark, self._start, lines)
        self.line = self._mark[0] + 1
        self.ends_document = "<document start>" in self._problem and not self._keyless

    def section(self) -> range:
        """Lines, from 0, of the top-level section that the error is in."""
        spoiled = self._start[0] if self._is_unclosed() else self._mark[0]
        if self._keyless:
            spoiled = self._keyless.line
        starts = [n for n, line in enumerate(self._lines) if _TOP_LEVEL_KEY.match(line)]
        first = max((n for n in starts if n <= spoiled), default=0)
        last = min((n for n in starts if n > spoiled), default=len(self._lines))
        return range(first, last)

    def report(self, diagnostics: Diagnostics) -> None:
        """Add the diagnostic."""
        path = self._unquoted_path()
        if path is not None:
            span = self._span(self._mark[0], self._lines[self._mark[0]].index(path), len(path))
            help = [f'quote paths that start with *: "{path}"']
            diagnostics.add("SB104", f"sidecar: undefined alias {path}", span, help=help)
            return
        if self._keyless:
            line, column, message, remedy = self._keyless
            diagnostics.add("SB104", f"sidecar: {message}", self._span(line, column), help=[remedy])
            return
        message, help = self._message()
        place = self._start if self._is_unclosed() else self._mark
        diagnostics.add("SB104", f"sidecar: {message}", self._span(*place), help=help)

    def _is_unclosed(self) -> bool:
        return ("flow" in self._context and "expected ','" in self._problem) or "quoted scalar" in self._context

    def _unquoted_path(self) -> str | None:
        """The unquoted glob that caused the error, if any."""
        line = self._lines[self._mark[0]]
        match = re.search(r"(?:^|[\s\[{,:-])(\*[^\s,\]}]*?):?(?=[\s,\]}]|$)", line)
        return match[1] if match and "<alias>" in self._problem else None

    def _message(self) -> tuple[str, list[str]]:
        problem, line = self._problem, self._lines[self._mark[0]]
        if match := re.search(r"character '(.+)' that cannot start", problem):
            return f"value starts with the reserved character {match[1]}", ["quote the text"]
        if "mapping values are not allowed" in problem:
            return "unexpected colon", [
                "quote text that contains ': '",
                "or the line above lacks a colon, or this line is indented too far",
            ]
        if "sequence entries are not allowed" in problem:
            return "unexpected list item", ["start the list on a new line, or write it as [a, b]"]
        if "unknown escape character" in problem:
            return f"{problem.removeprefix('found ')} in a double-quoted string", [
                _backslash_remedy(line, self._mark[1])
            ]
        if "quoted scalar" in self._context:
            return "unclosed quote", ["close the quote on the same line"]
        if self._is_unclosed():
            kind = "mapping" if "mapping" in self._context else "sequence"
            opened, closing = _OPENERS[kind]
            return f"unclosed '{opened}' or missing comma", [
                *self._cut_off_by_comment(),
                *self._missing_comma(),
                f"add '{closing}', or ',' between values",
            ]
        if "<block end>" in problem and not line[: self._mark[1]].strip():
            return "inconsistent indentation", ["align the keys of a mapping and the items of a list"]
        if re.search("<block end>|<document start>|node content|comment or a line break", problem):
            token = re.search(r"found \(?'([^<>]+?)'", problem)
            what = f"'{token[1]}'" if token else "text"
            return f"unexpected {what}", ["quote text that contains quotes, brackets or commas"]
        return f"invalid YAML: {problem or self._context}", ["quote text that contains special characters"]

    def _cut_off_by_comment(self) -> Iterator[str]:
        """The text with a # in it, if the line ends in a comment that swallows the closing bracket."""
        line = self._lines[self._start[0]]
        if comment := re.search(r"(?P<before>[\[{,:]| \S*)\s+(?P<text>#[^\s,\]}#]+)[^#]*[\]}]", line[self._start[1] :]):
            yield f'# after a space starts a comment; quote the text: "{comment["text"]}"'

    def _missing_comma(self) -> Iterator[str]:
        """The pair of values with the comma that is missing between them."""
        line, column = self._lines[self._mark[0]], self._mark[1]
        before = re.search(r"(?P<value>[^\s,:{}\[\]]+)\s+(?P<key>[\w-]+)$", line[:column])
        if before and line[column : column + 1] == ":" and self._mark[0] == self._start[0]:
            yield f"did you mean `{before['value']}, {before['key']}:`?"

    def _span(self, line: int, column: int, width: int = 1) -> Span:
        return Span(self._file, line + 1, column + 1, column + 1 + width)


class _Keyless(NamedTuple):
    """A line that YAML takes for text, because its colon or the space after it is missing."""

    line: int
    column: int
    message: str
    remedy: str


_GLUED = re.compile(r"(?P<indent> *)(?P<key>[^\W\d][\w-]*):(?P<value>[^\s:/].*?)(\s+#.*)?")
_NO_COLON = re.compile(r"(?P<indent> *)(?P<key>[^\W\d][\w-]*) +(?P<value>[\[{].*?|[^\s:#]+)(\s+#.*)?")


def _keyless_line(problem: str, mark: tuple[int, int], start: tuple[int, int], lines: Sequence[str]) -> _Keyless | None:
    """The line that causes an error at a mark, if it lacks a colon or the space after it.

    The error is at the colon of the next key, because the text continues there, or at a bracket in the line itself.
    """
    above = [n for n in range(mark[0]) if lines[n].strip() and not lines[n].lstrip().startswith("#")][-1:]
    if "could not find expected ':'" in problem:
        suspects = [start[0]]
    elif "mapping values are not allowed" in problem:
        is_first_colon = ":" not in lines[mark[0]][: mark[1]]
        suspects = [mark[0], *(above if is_first_colon else [])]
    elif "<document start>" in problem:
        suspects = [mark[0], *above]
    elif "<block end>" in problem:
        suspects = [mark[0]]
    else:
        return None
    for number in suspects:
        if glued := _GLUED.fullmatch(lines[number]):
            remedy = f"write `{glued['key']}: {glued['value']}`"
            return _Keyless(number, glued.start("value"), f"missing space after the colon of '{glued['key']}'", remedy)
        if bare := _NO_COLON.fullmatch(lines[number]):
            remedy = f"write `{bare['key']}: {bare['value']}`"
            return _Keyless(number, bare.end("key"), f"missing colon of '{bare['key']}'", remedy)
    return None


def _backslash_remedy(line: str, column: int) -> str:
    """The string in double or single quotes around a column."""
    for text in re.finditer(r'"(?P<text>[^"]*)"', line):
        if text.start() <= column < text.end() and "'" not in text["text"]:
            return f"escape the backslash as \\\\, or use single quotes: '{text['text']}'"
    return "escape the backslash as \\\\, or use single quotes"


def _clipped(mark: StringMark, lines: Sequence[str]) -> tuple[int, int]:
    """Line and column from 0, within the text; the end of the text is the end of its last line."""
    if mark.line < len(lines) and (mark.column < len(lines[mark.line]) or mark.line + 1 < len(lines)):
        return mark.line, mark.column
    last = max((n for n, line in enumerate(lines) if line.strip()), default=0)
    return last, max(len(lines[last]) - 1, 0)
