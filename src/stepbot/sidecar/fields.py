"""Reflection on the sidecar's classes: the keys of a section, their descriptions, other sections with a key."""

import ast
import inspect
import sys
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import Tag

from .document import Document
from .origins import Origin
from .section import Section

Loc = tuple[str | int, ...]
"""A place as reported by pydantic: keys, indices, and the tags of unions."""


def sections_at(loc: Loc) -> tuple[type[Section], ...]:
    """The sections possible at a place; several for a union whose form is not determined by ``loc``."""
    annotation: Any = Document
    for part in loc:
        annotation = _step(annotation, part)
    return tuple(_sections(annotation))


def section_classes() -> tuple[type[Section], ...]:
    """Every type of section in the document, the document first."""
    classes: dict[type[Section], None] = {Document: None}
    waiting: list[type[Section]] = [Document]
    while waiting:
        for field in waiting.pop().model_fields.values():
            new = [section for section in _sections(field.annotation, of_values=True) if section not in classes]
            classes.update(dict.fromkeys(new))
            waiting += new
    return tuple(classes)


def keys_of(sections: tuple[type[Section], ...]) -> tuple[str, ...]:
    """The keys of one section, or of all forms of an origin for any of them."""
    if is_origin(sections):
        sections = tuple(_sections(Origin))
    return tuple(dict.fromkeys(key_of(name) for section in sections for name in section.model_fields))


def key_of(name: str) -> str:
    """The key of a field: its name, where this is no word of Python; ``for`` of ``for_``."""
    return name.removesuffix("_")


def is_origin(sections: tuple[type[Section], ...]) -> bool:
    """Whether these are forms of an origin."""
    origins = tuple(_sections(Origin))
    return bool(sections) and all(section in origins for section in sections)


def keys_below(sections: tuple[type[Section], ...], key: str) -> tuple[str, ...]:
    """The keys of these sections whose own sections have ``key``."""
    names = {
        name: None
        for section in sections
        for name, field in section.model_fields.items()
        if any(key in inner.model_fields for inner in _sections(field.annotation))
    }
    return tuple(names)


@cache
def top_level_keys_with(key: str) -> tuple[str, ...]:
    """The top-level keys that have ``key`` in their own section, or in the section of each of their names."""
    keys = []
    for name, field in Document.model_fields.items():
        annotation = field.annotation
        if get_origin(annotation) is dict:
            annotation = get_args(annotation)[1]
        if any(key in section.model_fields for section in _sections(annotation)):
            keys.append(name)
    return tuple(keys)


@cache
def descriptions(section: type[Section]) -> dict[str, str]:
    """Descriptions of a section's keys: the docstrings below its fields, and below those of the section it extends."""
    inherited = (base for base in section.__bases__ if issubclass(base, Section) and base is not Section)
    texts = {name: text for base in inherited for name, text in descriptions(base).items()}
    classes = ast.parse(inspect.getsource(sys.modules[section.__module__])).body
    body = next(c.body for c in classes if isinstance(c, ast.ClassDef) and c.name == section.__name__)
    for field, text in pairwise(body):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(text, ast.Expr):
            assert isinstance(text.value, ast.Constant)
            texts[key_of(field.target.id)] = inspect.cleandoc(str(text.value.value))
    return texts


def _step(annotation: Any, part: str | int) -> Any:
    """The annotation one level down."""
    for member in _members(annotation):
        if any(isinstance(extra, Tag) and extra.tag == part for extra in get_args(member)):
            return member
        plain = _plain(member)
        if isinstance(plain, type) and issubclass(plain, Section):
            for name, field in plain.model_fields.items():
                if key_of(name) == part:
                    return field.annotation
        if get_origin(plain) is dict and isinstance(part, str):
            return get_args(plain)[1]
        if get_origin(plain) is tuple and isinstance(part, int):
            return get_args(plain)[0]
    return NoneType


def _members(annotation: Any) -> Iterator[Any]:
    """The members of a union, including nested unions; anything else is its own only member."""
    plain = _plain(annotation)
    if get_origin(plain) in (Union, UnionType):
        for member in get_args(plain):
            yield from _members(member)
    else:
        yield annotation


def _sections(annotation: Any, *, of_values: bool = False) -> Iterator[type[Section]]:
    """The sections of a type, and those of its values."""
    for plain in map(_plain, _members(annotation)):
        if isinstance(plain, type) and issubclass(plain, Section):
            yield plain
        for argument in get_args(plain) if of_values else ():
            yield from _sections(argument, of_values=True)


def _plain(annotation: Any) -> Any:
    return get_args(annotation)[0] if get_origin(annotation) is Annotated else annotation
