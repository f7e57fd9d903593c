"""Reads the text of a sidecar: bounded, as UTF-8."""

import codecs
from collections.abc import Iterable
from encodings.aliases import aliases
from pathlib import Path

from stepbot.diagnostics import NOT_TEXT, Diagnostic, Diagnostics, Span, did_you_mean
from stepbot.runtime.file import is_folder, open_regular
from stepbot.runtime.robot_library import export_hint

LARGEST_FILE = 1 << 22
"""Maximum size [bytes] of a file."""

_BYTE_ORDER_MARKS = {b"\xff\xfe": "UTF-16", b"\xfe\xff": "UTF-16"}


def is_number(text: str) -> bool:
    """Whether Python reads a text as a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_text(
    path: Path, diagnostics: Diagnostics, start: str = "start with `version: 1`; see `stepbot docs sidecar`"
) -> str | None:
    """The text of a file with line feeds at line ends, or None if it cannot be read.

    Reports SB001 not found, SB102 too large, not UTF-8, empty (with the remedy ``start``), or a STEP file.
    """
    whole = Span(path.as_posix())
    try:
        with open_regular(path) as stream:
            content = stream.read(LARGEST_FILE + 1)
    except OSError as failure:
        diagnostics.add("SB001", _reason(path, failure), whole, help=_meant(path))
        return None
    if content.lstrip()[:12] == b"ISO-10303-21":
        help = [
            f"`stepbot init {path.as_posix()}` drafts a sidecar from it; pass that sidecar instead",
            f"`stepbot inspect {path.as_posix()}` lists its components; `stepbot docs sidecar` describes all keys",
        ]
        diagnostics.add("SB102", "sidecar: file is a STEP file", whole, help=help)
        return None
    if len(content) > LARGEST_FILE:
        help = ["check that the path names the sidecar; shorten lists of parts with globs and `rest: true`"]
        diagnostics.add("SB102", f"sidecar: file exceeds the limit of {LARGEST_FILE // 1024} KiB", whole, help=help)
        return None
    text = _decoded(content, whole.file, diagnostics)
    if text is not None and not text.strip("\ufeff \t\n"):
        diagnostics.add("SB102", "sidecar: empty file", whole, help=[start])
        return None
    return text


def _decoded(content: bytes, file: str, diagnostics: Diagnostics) -> str | None:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as failure:
        before = content[: failure.start].decode("utf-8", "replace")
        encoding = _BYTE_ORDER_MARKS.get(content[:2])
        is_bytes = (
            f"file is {encoding}, not UTF-8" if encoding else f"invalid UTF-8: byte 0x{content[failure.start]:02x}"
        )
        diagnostics.add("SB102", f"sidecar: {is_bytes}", _place(file, before), help=["save the file as UTF-8"])
        return None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def is_text(text: str, file: str, diagnostics: Diagnostics) -> bool:
    """Whether the text has no control characters; reports the first one, SB102."""
    match = NOT_TEXT.search(text)
    if match is not None:
        place = _place(file, text[: match.start()])
        message = f"sidecar: control character U+{ord(match[0]):04X}"
        diagnostics.add("SB102", message, place, help=["remove it; save the file as UTF-8"])
    return match is None


def _place(file: str, before: str) -> Span:
    line = before.count("\n") + 1
    column = len(before) - (before.rfind("\n") + 1) + 1
    return Span(file, line, column, column + 1)


def _meant(path: Path) -> tuple[str, ...]:
    """Suggestions of existing sidecars, and how to get a robot that is known as a module."""
    if hint := export_hint(path.as_posix()):
        return hint
    folder = path if is_folder(path) else path.parent
    near = [one.name for one in folder.glob("*.yaml")] + [one.name for one in folder.glob("*.yml")]
    if is_folder(path) and near:
        return (f"use a file in it: {', '.join(sorted(near)[:3])}",)
    return did_you_mean(path.name, sorted(near)) or ("sidecars are usually named `<robot>.robot.yaml`",)


def _reason(path: Path, failure: OSError) -> str:
    if isinstance(failure, FileNotFoundError):
        return "file not found"
    if isinstance(failure, IsADirectoryError) or is_folder(path):
        return "is a folder, not a file"
    return f"cannot be read: {failure.strerror or failure}"


_ASCII = b"\t\r\n" + bytes(range(32, 92)) + bytes(range(93, 127)) + rb"\n\x41" + b"\x1b$B!!\x1b(B"
"""Text that encodings which are not supersets of ASCII decode differently: escapes, shifts, other letters."""
_COMMON = ("cp1250", "cp1251", "cp1252", "gbk", "gb18030", "cp932", "big5", "cp949", "koi8-r", "latin1", "utf-8")


class UnknownCodePage(ValueError):
    """No code page has this name, or it is not a superset of ASCII; ``hints`` are suggestions."""

    def __init__(self, message: str, *hints: str) -> None:
        self.hints = hints
        super().__init__(message)


def code_page(name: str) -> str:
    """The usual name of a code page: ``windows-1251`` is ``cp1251``.

    Raises:
        UnknownCodePage: There is none of this name, or it is not a superset of ASCII.
    """
    possible = f"examples: {', '.join(_COMMON)}"
    try:
        codec = codecs.lookup(name.strip())
    except (LookupError, ValueError):  # ValueError: a name with a null character
        near = did_you_mean(name.strip().lower(), [*_COMMON, *aliases.values(), *aliases])
        raise UnknownCodePage(f"unknown code page '{name}'", *near, possible) from None
    try:
        is_superset = _ASCII.decode(codec.name) == _ASCII.decode("ascii")
    except (LookupError, ValueError):  # LookupError: not a text encoding, such as base64
        is_superset = False
    if not is_superset:
        raise UnknownCodePage(f"code page '{name}' is not ASCII-compatible, but STEP files are", possible)
    return "utf-8" if codec.name == "utf-8-sig" else codec.name


MOST_FAULTS = 100
"""Maximum number of errors reported for one sidecar. Warnings are as many as its text has reasons for."""


class TooManyFaultsError(Exception):
    """The limit was exceeded; the collector has the diagnostics so far."""


class BoundedDiagnostics(Diagnostics):
    """Collects diagnostics, up to :data:`MOST_FAULTS` errors; one more raises :class:`TooManyFaultsError`."""

    def __init__(self) -> None:
        super().__init__()
        self._errors: dict[Diagnostic, None] = {}

    def extend(self, diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
        """Add diagnostics, up to the limit."""
        taken = list(diagnostics)
        for one in taken:
            super().extend([one])
            if one.severity == "error":
                self._errors[one] = None
                if len(self._errors) > MOST_FAULTS:
                    raise TooManyFaultsError
        return taken

    def hand_over(self, diagnostics: Diagnostics, file: str, *, complete: bool, varied: bool = False) -> None:
        """Add all diagnostics to another collector, in file order, and report if there were more.

        Args:
            varied: Whether the sidecar is a variant, or has values of another file, which can drop keys.
        """
        beyond = list(self._errors)[MOST_FAULTS:]
        shown = [one for one in self if one not in beyond]
        if varied:
            drop = "or drop the key where the other values are: `KEY: null`"
            shown = [one._replace(help=(*one.remedies, drop)) if one.code == "SB137" else one for one in shown]
        diagnostics.extend(sorted(shown, key=lambda d: (d.span.line, d.span.column, d.code)))
        if not complete:
            help = ["correct these errors first"]
            message = f"sidecar: more than {MOST_FAULTS} errors; the remaining ones are not shown"
            diagnostics.add("SB110", message, Span(file), help=help)
