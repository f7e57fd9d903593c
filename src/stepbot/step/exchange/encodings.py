"""Encoding of bytes above 127 in a STEP file: UTF-8, a declared code page, or unknown.

ISO 10303-21 allows only ASCII, and since 2016 UTF-8. Many programs write the code page of their computer, and no file
declares it. To prevent silent mojibake, either the bytes must be UTF-8, or a declared code page must be able to decode
all of them, or a warning shows the names decoded by likely code pages.
"""

import codecs
import mmap
import re
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.file import is_unicode

from .compression import ARCHIVES, decompressed, starts_with

Text = bytes | mmap.mmap

FALLBACK = "cp1252"
"""Replacement for bytes above 127 of unknown encoding."""

LIKELY = ("cp1251", "cp1252", "cp1250", "gb18030", "cp932", "big5", "cp949", "cp1253", "cp1254", "koi8-r")
"""Code pages that a warning tries, and in which names of files are looked for."""
_PLAIN = ("ascii", "utf-8")
"""Encodings that the kernel reads unchanged."""
BYTE_ORDER_MARK = codecs.BOM_UTF8
_NOT_ASCII = re.compile(rb"[\x80-\xff]+")
_TEXT = re.compile(rb"'([^'\x80-\xff]*[\x80-\xff][^']*)'")
_MEANINGLESS = re.compile("[\x80-\x9f\uf8f0-\uf8f3]")
"""Characters that do not occur in names: undefined single bytes of a code page decode to these."""
_CHUNK = 1 << 20
_SAMPLES = 500
"""Maximum number of names with bytes above 127 that are tried with each code page."""
_SHOWN = 40
"""Maximum length of a name in a note."""


def check_encoding(data: Text, declared: str, place: str, diagnostics: Diagnostics) -> str | None:
    """The encoding of a file: ``ascii``, ``utf-8``, the declared one, or empty if unknown.

    Args:
        declared: Code page declared by the user; empty for none.
        diagnostics: Receives SB210 if the encoding is unknown or the file contradicts the declaration.

    Returns:
        None, with the error SB224 in ``diagnostics``, if the declared code page cannot decode the file's bytes.
    """
    first = next(_non_ascii_runs(data), None)
    if first is None:
        return "ascii"
    not_utf8 = next((offset for offset, run in _non_ascii_runs(data) if not _is_utf8(run)), None)
    if declared and declared != "utf-8":
        return _check_declared(data, declared, not_utf8 is None, place, diagnostics)
    if not_utf8 is None:
        return "utf-8"
    span = Span(place, line_of(data, not_utf8), 1)
    if declared:
        _refuse(data, declared, not_utf8, span, diagnostics)
        return None
    diagnostics.add(
        "SB210",
        f"names are neither ASCII nor UTF-8; decoded as Western European ({FALLBACK})",
        span,
        help=[
            f"declare the code page that reads right, {FALLBACK} too: `--encoding CODEPAGE`, or "
            "`step_encoding: CODEPAGE` in the sidecar",
            "or export with UTF-8 or with \\X2\\ escapes",
        ],
        notes=_readings(data),
    )
    return ""


def _check_declared(data: Text, declared: str, is_utf8: bool, place: str, diagnostics: Diagnostics) -> str | None:
    strange = _strange(data, declared)
    if strange is not None:
        _refuse(data, declared, strange, Span(place, line_of(data, strange), 1), diagnostics)
        return None
    if is_utf8:
        offset, _ = next(_non_ascii_runs(data))
        diagnostics.add(
            "SB210",
            f"names are read as {declared}, as declared, but they are valid UTF-8",
            Span(place, line_of(data, offset), 1),
            help=["remove the declaration: UTF-8 is detected"],
            notes=[f"in {encoding} the first reads '{_first(data, encoding)}'" for encoding in (declared, "utf-8")],
        )
    return declared


@contextmanager
def as_utf8(path: Path, encoding: str) -> Iterator[Path]:
    """The path of a file with the same text in UTF-8; the same file if it is already UTF-8, including its name.

    Args:
        encoding: From :func:`check_encoding`.
    """
    if encoding in _PLAIN and is_unicode(path) and not starts_with(path, (*ARCHIVES, BYTE_ORDER_MARK)):
        yield path
        return
    # The kernel's own tables have few code pages, and interpret the backslash in the second byte of a GBK character as
    # an escape.
    errors = "strict" if encoding else "replace"
    with tempfile.TemporaryDirectory(prefix="stepbot-") as folder:
        copy = Path(folder) / "utf-8.step"
        with decompressed(path) as source, copy.open("wb") as target:
            if source.read(3) != BYTE_ORDER_MARK:
                source.seek(0)
            decoder = codecs.getincrementaldecoder(encoding or FALLBACK)(errors)
            while chunk := source.read(_CHUNK):
                target.write(decoder.decode(chunk).encode())
            target.write(decoder.decode(b"", final=True).encode())
        yield copy


def encoding_fact(encoding: str) -> str:
    """Description for `inspect` of the encoding from :func:`check_encoding`."""
    if encoding in _PLAIN:
        return encoding.upper()
    return f"{encoding}, as declared" if encoding else f"unknown, shown as {FALLBACK}"


def line_of(data: Text, offset: int) -> int:
    """Line, from 1, of a byte of the file."""
    return lines_of(data, (offset,))[offset]


def lines_of(data: Text, offsets: Iterable[int]) -> dict[int, int]:
    """Line, from 1, of each of several bytes of the file, which is read once."""
    lines, line, start = {}, 1, 0
    for offset in sorted(set(offsets)):
        for at in range(start, offset, _CHUNK):
            line += bytes(data[at : min(at + _CHUNK, offset)]).count(b"\n")
        lines[offset], start = line, offset
    return lines


def _refuse(data: Text, declared: str, offset: int, span: Span, diagnostics: Diagnostics) -> None:
    byte = bytes(data[offset : offset + 1]).hex()
    diagnostics.add(
        "SB224",
        f"names are not valid in the declared encoding {declared}: byte 0x{byte}",
        span,
        help=["declare the code page of the file, or remove the declaration: UTF-8 is detected"],
        notes=_readings(data),
    )


def _strange(data: Text, encoding: str) -> int | None:
    """Offset of the first byte that is undefined, or a control character, in a code page."""
    decoder = codecs.getincrementaldecoder(encoding)()
    for start in range(0, len(data), _CHUNK):
        chunk = bytes(data[start : start + _CHUNK])
        end = start + len(chunk)
        try:
            text = decoder.decode(chunk, final=end >= len(data))
        except UnicodeDecodeError as error:
            return end - len(error.object) + error.start
        if character := _MEANINGLESS.search(text):
            return end - len(text[character.start() :].encode(encoding))
    return None


def _readings(data: Text) -> list[str]:
    """A name of the file, decoded by each code page that can decode all names, without duplicates."""
    runs = [match[1] for match, _ in zip(_TEXT.finditer(data), range(_SAMPLES), strict=False)]
    readings: dict[str, list[str]] = {}
    for encoding in LIKELY:
        try:
            texts = [run.decode(encoding) for run in runs]
        except UnicodeDecodeError:
            continue
        if texts and not any(map(_MEANINGLESS.search, texts)):
            readings.setdefault(_shortened(texts[0]), []).append(encoding)
    return [f"in {' and '.join(encodings)} the first reads '{text}'" for text, encodings in readings.items()]


def _first(data: Text, encoding: str) -> str:
    match = _TEXT.search(data)
    return "" if match is None else _shortened(match[1].decode(encoding, "replace"))


def _shortened(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _SHOWN else line[: _SHOWN - 1] + "…"


def _is_utf8(run: bytes) -> bool:
    try:
        run.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _non_ascii_runs(data: Text) -> Iterator[tuple[int, bytes]]:
    """Every run of bytes above 127 with its offset, complete even across chunks."""
    start = 0
    while start < len(data):
        end = min(start + _CHUNK, len(data))
        while end < len(data) and data[end] > 127:
            end += 1
        chunk = bytes(data[start:end])
        if not chunk.isascii():
            for match in _NOT_ASCII.finditer(chunk):
                yield start + match.start(), match[0]
        start = end
