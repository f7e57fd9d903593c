"""Everything that a description states, place by place: for what no engine reports, the text itself is compared."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from ..xml import xml_root
from .mjcf_vocabulary import MJCF
from .sdf_vocabulary import AROUND, MODEL
from .urdf_vocabulary import URDF
from .vocabulary import Vocabulary

_VOCABULARIES = {"urdf": URDF, "sdf": AROUND, "mjcf": MJCF}
_KEYS = ("name", "reference", "filename", "joint", "site", "class")
"""Attributes that identify one of several elements of a tag."""
_LONGEST_PLACE = 1000


@dataclass(frozen=True)
class Statement:
    """One attribute, or the text of one element."""

    place: str
    """Tags down from the root, with names or numbers of elements."""
    value: str
    read: bool
    """Whether it reaches the model, so that engines can be expected to report it."""


def statements(file: Path, written_in: str) -> tuple[Statement, ...]:
    """The statements of a file; none of a format that is not XML.

    Raises:
        EngineRefused: The file is not XML.
    """
    vocabulary = _VOCABULARIES.get(written_in)
    if vocabulary is None:
        return ()
    top = xml_root(file)
    return tuple(_below(top, vocabulary))


def _short(place: str) -> str:
    """A place of bounded length: of elements nested by thousands, each place would name all those above it."""
    if len(place) <= _LONGEST_PLACE:
        return place
    head, tail = place[: -_LONGEST_PLACE // 2], place[-_LONGEST_PLACE // 2 :]
    return f"({sha256(head.encode()).hexdigest()[:12]}){tail}"


def _below(top: Any, vocabulary: Vocabulary) -> Iterator[Statement]:
    """The statements in the order of the file, without recursion: elements may be nested by thousands."""
    waiting = [(top, str(top.tag), str(top.tag), vocabulary, True)]
    while waiting:
        element, path, place, vocabulary, read = waiting.pop()
        for name, value in element.attrib.items():
            yield Statement(f"{place}@{name}", value, read and vocabulary.reads(path, name, str(element.tag)))
        if text := (element.text or "").strip():
            yield Statement(place, text, read)
        children, numbers = [], Counter[str]()
        for child in (child for child in element if isinstance(child.tag, str)):
            words, below = vocabulary, vocabulary.below(path, child)
            if vocabulary is AROUND and child.tag == "model":
                words, below = MODEL, "model"
            key = next((f"'{child.get(name)}'" for name in _KEYS if child.get(name)), "")
            tag = f"{child.tag} {key}".strip()
            numbers[tag] += 1
            numbered = tag if numbers[tag] == 1 else f"{tag} {numbers[tag]}"
            children.append((child, below, _short(f"{place}/{numbered}"), words, read and below in words.read))
        waiting += reversed(children)
