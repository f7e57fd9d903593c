"""Checks the files that a robot description refers to before any engine reads it; runs in its own process.

Engines open every file that a description names. MuJoCo and PyBullet read the content of every ``<include>`` of an
MJCF, wherever it is, and block on a named pipe or a device in place of a mesh until they time out. Meshes and textures
may be anywhere, since descriptions share them.
"""

import re
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from math import prod
from pathlib import Path
from typing import Any

from msgspec import Struct
from msgspec.structs import replace

from stepbot.runtime.file import exists, is_file, is_folder, is_unicode, open_regular, read_regular, resolved
from stepbot.runtime.temporary import run_folder

from .resources import candidates
from .xml import parsed, with_readable_head

_MOST = {
    "hfield": (("nrow", "ncol"), 1 << 24),
    "texture": (("width", "height"), 1 << 26),
    "replicate": (("count",), 1 << 14),
    "composite": (("count",), 1 << 16),
    "flexcomp": (("count",), 1 << 18),
}
"""For each element the attributes whose numbers are multiplied, and the largest product."""
_SIZES = {"nkey": 1 << 12, "njmax": 1 << 20, "nconmax": 1 << 20, "nstack": 1 << 27}
_USER_DATA = 1 << 12
"""Largest number of values that ``<size nuser_...>`` gives to each body, geom, ... of the model."""
_MEMORY = 1 << 30
"""Largest arena [bytes] that ``<size memory>`` asks for."""
_UNITS = {"K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40, "P": 1 << 50, "E": 1 << 60}


def excessive_sizes(root: Any) -> Iterator[tuple[Any, str]]:
    """Elements of an MJCF that declare more than stepbot loads, each with the reason.

    Args:
        root: The root, an ``lxml.etree._Element``.
    """
    for tag, (attributes, most) in _MOST.items():
        for element in root.iter(tag):
            numbers = [number for name in attributes for number in _numbers(element.get(name, ""))]
            if prod(numbers) > most:
                yield element, f"<{tag}> with {prod(numbers):.3g} values; at most {most} are loaded"
    for element in root.iter("size"):
        for name, text in element.attrib.items():
            most = _MEMORY if name == "memory" else _USER_DATA if name.startswith("nuser_") else _SIZES.get(name, 0)
            number = _bytes(text) if name == "memory" else max(_numbers(text), default=0.0)
            if most and number > most:
                yield element, f"<size {name}> of {number:.3g}; at most {most} is loaded"


def _numbers(text: str) -> list[float]:
    """The numbers of a text; MuJoCo reports texts that are no numbers."""
    values = []
    for word in text.split():
        try:
            values.append(abs(float(word)))
        except ValueError:
            continue
    return values


def _bytes(text: str) -> float:
    unit = _UNITS.get(text.strip()[-1:].upper(), 1)
    return max(_numbers(text.strip().rstrip("KMGTPEkmgtpe")), default=0.0) * unit


Element = Any
"""``lxml.etree._Element``; the stubs lack ``sourceline`` and entities."""

UNSAFE = "SB820"
NOT_XML = "SB814"
TOO_LARGE = "SB823"

_MOST_INCLUDES = 1000
_CHUNK = 1 << 16
_SUFFIXED = ("", "right", "left", "up", "down", "front", "back")
_ATTRIBUTES = ("filename", *(f"file{suffix}" for suffix in _SUFFIXED))
"""Attributes that name files; six of them are the sides of a texture in MJCF."""
_FOLDERS = ("meshdir", "texturedir", "assetdir")
"""Attributes of MJCF's ``<compiler>``."""
_XML = ("urdf", "sdf", "mjcf")
_WITH_ASCII = re.compile(r"utf-?8|(us-)?ascii|iso-8859-\d+|(windows-|cp)125\d", re.IGNORECASE)
"""Encodings in which every ASCII character is itself and nothing else is.

Engines ignore what a file declares: in the others, tags that they read may be characters of a comment to our parser.
"""


class Refusal(Struct, frozen=True):
    """Why engines must not read a file."""

    code: str
    message: str
    file: str
    line: int = 0


def refusals(file: str, written_in: str, folders: Iterable[Path] = ()) -> tuple[Refusal, ...]:
    """Why engines must not read a file; empty if they may.

    A file that is no well-formed XML is refused: parsers of engines are more lenient, and would open what it names.

    Args:
        folders: Those, in addition to its own, from which an MJCF may include files.
    """
    given, main = Path(file), resolved(Path(file))  # engines resolve symbolic links
    refused = _layer_refusals(main) if written_in == "usd" else ()
    if written_in in _XML:
        refused = _refusals(main, written_in == "mjcf", [main.parent, *map(resolved, folders)], {main}, (main,))
    return tuple(replace(one, file=_shown(one.file, main, given)) for one in refused)


def _layer_refusals(main: Path) -> Iterator[Refusal]:
    """Layers of a stage that are outside of its folder, or not regular files."""
    for layer, name, path in layer_references(main):
        if not resolved(path).is_relative_to(main.parent):
            yield Refusal(UNSAFE, f"refers to '{name}', which is outside the folder of {main.name}", str(layer))
        elif _is_irregular(path):
            yield Refusal(UNSAFE, f"'{name}' is not a regular file", str(layer))


def _shown(file: str, main: Path, given: Path) -> str:
    """The name of a file for messages."""
    path = Path(file)
    if path == main:
        return str(given)
    return str(given.parent / path.relative_to(main.parent)) if path.is_relative_to(main.parent) else file


def first_element(path: Path) -> Element:
    """The root element of an XML file, without its content, and with its document type.

    Raises:
        XMLSyntaxError: The file is not XML.
        OSError: It cannot be read.
    """
    from lxml import etree

    parser = etree.XMLPullParser(events=("start",), resolve_entities=False, no_network=True)
    with open_regular(path) as file:  # lxml itself opens no file whose name is not UTF-8
        while chunk := file.read(_CHUNK):
            fault = None
            try:
                parser.feed(chunk if file.tell() > _CHUNK else with_readable_head(chunk))
            except etree.XMLSyntaxError as error:  # it may follow the root element
                fault = error
            for _, element in parser.read_events():
                return element
            if fault is not None:
                raise fault
    return parser.close()


def declares_entities(root: Element) -> bool:
    """Whether the document declares entities: engines expand them differently."""
    declared = root.getroottree().docinfo.internalDTD
    return declared is not None and next(iter(declared.iterentities()), None) is not None


def _refusals(
    main: Path, has_includes: bool, allowed: Sequence[Path], seen: set[Path], chain: tuple[Path, ...]
) -> Iterator[Refusal]:
    """Why engines must not read a file, what it includes, or the models that it attaches.

    Args:
        chain: The models that attach each other down to this one, which is the last.
    """
    from lxml import etree

    pending, roots = [main], list[tuple[Path, Element]]()
    while pending:
        path = pending.pop()
        try:
            root = _parsed(path)
        except etree.XMLSyntaxError as error:
            yield Refusal(NOT_XML, f"not XML: {error.msg}", str(path), error.lineno or 0)
            continue
        except OSError:  # engines cannot read it either
            continue
        if declares_entities(root):
            yield Refusal(UNSAFE, "declares XML entities", str(path))
            continue
        encoding = root.getroottree().docinfo.encoding or "UTF-8"
        if not _WITH_ASCII.fullmatch(encoding):
            yield Refusal(NOT_XML, f"encoding {encoding}, which engines do not read; save the file as UTF-8", str(path))
            continue
        roots.append((path, root))
        for element, reason in excessive_sizes(root) if has_includes else ():
            yield Refusal(TOO_LARGE, reason, str(path), element.sourceline or 0)
        for element in root.iter("include", "model") if has_includes else ():
            name, is_model = element.get("file", ""), element.tag == "model"
            if not name:
                continue
            included = main.parent / name
            if not any(map(resolved(included).is_relative_to, allowed)):
                does = "attaches" if is_model else "includes"
                message = f"{does} '{name}', which is outside the folder of {main.name}"
                yield Refusal(UNSAFE, message, str(path), element.sourceline or 0)
            elif _is_irregular(included):
                yield Refusal(UNSAFE, f"'{name}' is not a regular file", str(path), element.sourceline or 0)
            elif is_model and resolved(included) in chain:  # MuJoCo would overflow its stack
                yield Refusal(UNSAFE, f"cycle of attached models: '{name}'", str(path), element.sourceline or 0)
            elif is_file(included) and resolved(included) not in seen and len(seen) < _MOST_INCLUDES:
                seen.add(resolved(included))
                if is_model:
                    model = resolved(included)
                    yield from _refusals(model, has_includes, allowed, seen, (*chain, model))
                else:
                    pending.append(included)
    # The settings of one file apply to all files included together.
    folders = [main.parent / folder for folder in ("", *(name for _, root in roots for name in _folders(root)))]
    for path, root in roots:
        for element in root.iter("*"):
            if not (has_includes and element.tag in ("include", "model")):
                yield from _irregular(element, main, folders, path)


def _parsed(path: Path) -> Element:
    """The root element; without its content if the document declares entities, which may expand to gigabytes.

    Raises:
        XMLSyntaxError: The file is not XML.
        OSError: It cannot be read.
    """
    first = first_element(path)
    if declares_entities(first):
        return first
    return parsed(read_regular(path))


def _folders(root: Element) -> list[str]:
    return [folder for compiler in root.iter("compiler") for name in _FOLDERS if (folder := compiler.get(name))]


def _irregular(element: Element, main: Path, folders: list[Path], path: Path) -> Iterator[Refusal]:
    names = [element.get(attribute) or "" for attribute in _ATTRIBUTES]
    if element.tag == "uri":
        names.append((element.text or "").strip())
    for name in filter(None, names):
        places = [*candidates(name, main), *(folder / one for folder in folders for one in (name, Path(name).name))]
        if any(map(_is_irregular, places)):
            yield Refusal(UNSAFE, f"'{name}' is not a regular file", str(path), element.sourceline or 0)


def _is_irregular(path: Path) -> bool:
    """Whether the path is neither a file nor a folder: a pipe, a device, a socket."""
    try:
        return exists(path) and not is_file(path) and not is_folder(path)
    except (OSError, ValueError):  # not a valid file name
        return False


def openable(path: Path) -> Path:
    """An absolute path of a file, in UTF-8; files beside the file and below its folder have the same way from there.

    Raises:
        OSError: There cannot be a symbolic link.
    """
    absolute = resolved(path)  # not cached: what a relative path refers to changes with the current folder
    return absolute if is_unicode(absolute) else _linked(absolute)


@cache
def _linked(path: Path) -> Path:
    """Another path of a file, by symbolic links; the same one on each call."""
    place = Path(tempfile.mkdtemp(dir=run_folder()))
    if is_unicode(Path(path.name)):
        folder = next(folder for folder in path.parents if not is_unicode(Path(folder.name)))
        (place / "folder").symlink_to(folder, target_is_directory=True)
        return place / "folder" / path.relative_to(folder)
    for beside in path.parent.iterdir():
        if is_unicode(Path(beside.name)):
            (place / beside.name).symlink_to(beside, target_is_directory=is_folder(beside))
    description = place / f"{place.name}{path.suffix if is_unicode(Path(path.suffix)) else ''}"
    description.symlink_to(path)
    return description


_MOST_LAYERS = 1000


def layer_references(main: Path) -> Iterator[tuple[Path, str, Path]]:
    """References to other files, in the main file and in those that it refers to below its folder; no other is opened.

    Each is the file that has it, the name as it is there, and the absolute path of the sublayer, reference or payload.
    A file that USD cannot parse has none; without USD's library there are none, as no engine can read the file.
    """
    try:
        from pxr import Sdf, Tf
    except ImportError:
        return
    pending, seen = [main], {main}
    while pending and len(seen) <= _MOST_LAYERS:
        path = pending.pop()
        try:
            layer = Sdf.Layer.FindOrOpen(str(path))
        except Tf.ErrorException:
            continue
        names = [] if layer is None else layer.GetCompositionAssetDependencies()
        for name in filter(None, names):  # a reference without a file is to a prim of the same one
            target = Path(layer.ComputeAbsolutePath(name.partition("[")[0]))
            yield path, name, target
            inside = resolved(target).is_relative_to(main.parent)
            if inside and is_file(target) and resolved(target) not in seen:
                seen.add(resolved(target))
                pending.append(target)
