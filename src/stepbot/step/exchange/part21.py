"""Checks of a STEP file without the geometry kernel: whether it is one, and its header.

The kernel takes a second to load and reports most faults as "no shapes". This reads the text itself (ISO 10303-21, the
exchange structure), so that an invalid file is reported at once, with the reason and the line.
"""

import mmap
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from msgspec import Struct

from stepbot.diagnostics import Diagnostics, Span, did_you_mean, listed
from stepbot.robot.step_names import is_step_name
from stepbot.runtime.file import is_folder

from .compression import ArchiveFault, decompressed
from .encodings import BYTE_ORDER_MARK, FALLBACK, Text, check_encoding, line_of
from .part21_values import decode_string
from .references import ExternalReference, external_references

_BLANK = re.compile(rb"\s*")
_START = re.compile(rb"ISO-10303-21\s*;")
_END = b"END-ISO-10303-21"
_DATA = re.compile(rb"\bDATA\s*[;(]")
_FIRST_ENTITY = re.compile(rb"#\s*\d+\s*=")
_HEADER_TOKEN = re.compile(rb"/\*.*?(?:\*/|\Z)|'(?:[^']|'')*'|[A-Z][A-Z0-9_]*|[(),;$*]", re.DOTALL)
_HEADER_LIMIT = 1 << 20

_GEOMETRY = (
    b"ADVANCED_FACE", b"MANIFOLD_SOLID_BREP", b"FACE_SURFACE", b"FACETED_BREP", b"BREP_WITH_VOIDS", b"TESSELLATED_",
    b"TRIANGULATED_", b"SURFACE_MODEL", b"GEOMETRIC_CURVE_SET", b"GEOMETRIC_SET", b"WIREFRAME_MODEL", b"CSG_SOLID",
    b"AREA_SOLID",
)  # fmt: skip
"""Keywords that every geometry contains; the first occurs early in nearly every file."""

_SHOWN = 5
"""Maximum number of files in a remedy."""
_SCHEMAS = (
    ("CONFIG_CONTROL", "AP203"), ("AP203", "AP203"), ("AUTOMOTIVE_DESIGN", "AP214"), ("AP214", "AP214"),
    ("AP242", "AP242"), ("AP209", "AP209"), ("AP238", "AP238"), ("INTEGRATED_CNC", "AP238"),
)  # fmt: skip
_OTHER_FILES = (
    (b"<?xml", "XML, as .stpx files are", "export the assembly as STEP AP242 in its text form (Part 21, .stp)"),
    (b"\xd0\xcf\x11\xe0", "a native CAD file", "export the assembly as STEP (AP214 or AP242)"),
    (b"version https://git-lfs", "a Git LFS pointer", "fetch the file itself: `git lfs pull`"),
    (b"solid ", "an STL mesh", "a mesh has no assembly tree and no exact geometry: export the assembly as STEP"),
    (b"%PDF", "a PDF", "export the assembly as STEP (AP214 or AP242)"),
)

_DESCRIPTIONS = {b"robot": "URDF", b"sdf": "SDFormat", b"mujoco": "MJCF"}
"""Names of formats by the first element of their files."""
_SIDECAR = re.compile(rb"(?:\A\W?|\n)version: *\d.*\n(?:.*\n)*?(?:robot|step|source|modules):")
_DESCRIPTION = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:<\?.*?\?>\s*|<!--.*?-->\s*)*<(robot|sdf|mujoco)\b", re.DOTALL)


class Header(Struct, frozen=True):
    """The header of a STEP file."""

    name: str = ""
    time_stamp: str = ""
    preprocessor: str = ""
    originating_system: str = ""
    """CAD program that wrote the file; if missing, the library that wrote it."""
    schemas: tuple[str, ...] = ()

    @property
    def schema(self) -> str:
        """``AP203``, ``AP214``, ``AP242``, or the schema's own name."""
        first = self.schemas[0].upper() if self.schemas else ""
        return next((label for word, label in _SCHEMAS if word in first), first.split(" ")[0])


class Part21(Struct, frozen=True):
    """A STEP file, as far as its text was read."""

    header: Header
    encoding: str
    """``ascii``, ``utf-8``, or a declared code page; empty if unknown."""
    size: int
    """Number of bytes, decompressed."""
    references: tuple[ExternalReference, ...] = ()
    """STEP files that hold the shapes of some products."""


def check_step(path: Path, place: str, diagnostics: Diagnostics, encoding: str = "") -> Part21 | None:
    """Check a STEP file; None, with the reason in ``diagnostics``, if the kernel cannot read it.

    Args:
        encoding: Declared code page of names; empty for none.
    """
    span = Span(place)
    try:
        with opened(path) as data:
            return _check(data, encoding, place, diagnostics)
    except IsADirectoryError:
        diagnostics.add("SB001", "is a folder, not a STEP file", span, help=_meant(path))
    except FileNotFoundError:
        diagnostics.add("SB001", "file not found", span, help=_meant(path))
    except ArchiveFault as fault:
        diagnostics.add("SB201", f"the compressed file cannot be read: {fault.reason}", span, help=[fault.help])
    except OSError as error:
        diagnostics.add("SB001", f"cannot be read: {error.strerror or error}", span)
    return None


def _meant(path: Path) -> tuple[str, ...]:
    """The STEP files in the folder of a missing one, the likeliest first."""
    folder = path if is_folder(path) else path.parent
    try:
        beside = sorted(file.name for file in folder.iterdir() if is_step_name(file.name))
    except OSError:  # the folder does not exist, or is not readable
        beside = []
    if not beside:
        return ("give the path of a STEP file (.step, .stp)",)
    shown = ", ".join(f"'{name}'" for name in beside[:_SHOWN])
    return (*did_you_mean(path.name, beside), f"STEP files in {folder}: {shown}{', ...' if beside[_SHOWN:] else ''}")


@contextmanager
def opened(path: Path) -> Iterator[Text]:
    """The file's bytes, decompressed, and memory-mapped: a large assembly has hundreds of megabytes.

    Raises:
        ArchiveFault: It is a compressed file that cannot be read.
        OSError: It cannot be read.
    """
    if is_folder(path):
        raise IsADirectoryError(path)
    with decompressed(path) as file:
        if file.seek(0, 2) == 0:
            yield b""
            return
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            yield data


def _check(data: Text, declared: str, place: str, diagnostics: Diagnostics) -> Part21 | None:
    beginning = data[:_HEADER_LIMIT]
    start = _START.match(beginning, _end_of_comments(beginning))
    if start is None:
        _report_not_step(bytes(data[:8192]), place, diagnostics)
        return None
    section = _DATA.search(data, start.end())
    end_mark = data.rfind(_END, section.end() if section else start.end())
    if section is None or end_mark < 0 or data.find(b";", end_mark) < 0:
        end = Span(place, line_of(data, len(data)), 1)
        diagnostics.add("SB201", "unexpected end of file", end, help=["export or copy it again"])
        return None
    encoding = check_encoding(data, declared, place, diagnostics)
    if encoding is None:
        return None
    header = _read_header(bytes(data[start.end() : min(section.start(), start.end() + _HEADER_LIMIT)]), encoding)
    if header.schema.startswith("IFC"):
        message = f"is a building model ({header.schema}), not a product"
        diagnostics.add("SB201", message, Span(place), help=["export the assembly as STEP AP214 or AP242"])
        return None
    if _FIRST_ENTITY.search(data, section.end()) is None:
        span = Span(place, line_of(data, section.start()), 1)
        diagnostics.add("SB201", "the DATA section is empty", span, help=["export the assembly again"])
        return None
    references = external_references(data, encoding)
    if not _has_geometry(data, section.end(), references, place, diagnostics):
        return None
    return Part21(header, encoding, len(data), tuple(reference for reference in references if reference.is_step))


def _end_of_comments(data: bytes) -> int:
    """Offset of the text after a byte order mark, white space and comments."""
    position = len(BYTE_ORDER_MARK) if data.startswith(BYTE_ORDER_MARK) else 0
    while True:
        match = _BLANK.match(data, position)
        position = match.end() if match is not None else position
        end = data.find(b"*/", position + 2) if data.startswith(b"/*", position) else -1
        if end < 0:
            return position
        position = end + 2


def _report_not_step(beginning: bytes, place: str, diagnostics: Diagnostics) -> None:
    if not beginning.strip(b"\0 \t\r\n"):
        diagnostics.add("SB201", "the file is empty", Span(place), help=["export the assembly again"])
        return
    kind, remedy = next(
        ((kind, remedy) for magic, kind, remedy in _OTHER_FILES if beginning.startswith(magic)),
        ("", "a STEP file begins with the line `ISO-10303-21;`"),
    )
    if root := _DESCRIPTION.match(beginning):
        kind = f"a robot description ({_DESCRIPTIONS[root[1]]})"
        remedy = f"`stepbot view {place}` shows it, `stepbot verify {place}` loads it in engines"
    if _SIDECAR.search(beginning):
        kind = "a sidecar"
        remedy = f"`stepbot view --edit {place}` edits it, `stepbot convert {place}` converts it"
    if len(beginning) > 80 and beginning[72:73] == b"S" and b"\n" in beginning[79:83]:
        kind, remedy = "IGES", "IGES has no assembly tree: export the assembly as STEP (AP214 or AP242)"
    what = f"is {kind}, not a STEP file" if kind else "is not a STEP file"
    diagnostics.add("SB201", what, Span(place, 1, 1), help=[remedy])


def _has_geometry(
    data: Text, start: int, references: tuple[ExternalReference, ...], place: str, diagnostics: Diagnostics
) -> bool:
    """Whether shapes are in the file itself or in other STEP files, and all of them."""
    geometry = any(data.find(word, start) >= 0 for word in _GEOMETRY)
    is_complete = geometry or any(reference.is_step for reference in references)
    elsewhere = [reference for reference in references if not is_complete or reference.is_cad]
    if not elsewhere:
        if not is_complete:
            remedy = "export it with its geometry, as a B-rep (AP203, AP214 or AP242)"
            diagnostics.add("SB205", "the file has no geometry", Span(place), help=[remedy])
        return is_complete
    names = list(dict.fromkeys(reference.name for reference in elsewhere))
    diagnostics.add(
        "SB203",
        f"{'parts of the' if is_complete else 'all'} geometry is in files that are not STEP: {listed(names, 5)}",
        Span(place, elsewhere[0].line, 1),
        help=["export the assembly as one STEP file, or its parts as STEP files beside it"],
    )
    return False


def _read_header(text: bytes, encoding: str) -> Header:
    """The header's three entities; missing or malformed ones stay empty."""
    values: dict[str, list[bytes | list[bytes]]] = {}
    arguments: list[bytes | list[bytes]] | None = None
    inner: list[bytes] | None = None
    keyword, depth = "", 0
    for match in _HEADER_TOKEN.finditer(text):
        token = match[0]
        if token.startswith(b"/*"):
            continue
        if token == b"(":
            depth += 1
            if depth == 1:
                arguments = values.setdefault(keyword, [])
            elif arguments is not None and depth == 2:
                inner = []
                arguments.append(inner)
        elif token == b")":
            depth -= 1
            inner = None
        elif depth == 0 and token.isascii():  # else a text outside of any record
            keyword = token.decode("ascii")
        elif token[:1] in (b"'", b"$") and arguments is not None:
            (arguments if inner is None else inner).append(token)
    name, schema = values.get("FILE_NAME", []), values.get("FILE_SCHEMA", [])
    texts = [_text(argument, encoding) for argument in name] + [""] * 7
    listed = schema[0] if schema and isinstance(schema[0], list) else []
    schemas = tuple(_text(argument, encoding) for argument in listed)
    return Header(texts[0], texts[1], texts[4], texts[5].strip() or texts[4].strip(), schemas)


def _text(argument: bytes | list[bytes], encoding: str) -> str:
    if isinstance(argument, list) or argument == b"$":
        return ""
    return decode_string(argument[1:-1], encoding or FALLBACK, "strict" if encoding else "replace")
