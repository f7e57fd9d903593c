"""Compose YAML 1.2 text into a tree of values with positions; every error is reported, alias expansion is bounded.

ruamel.yaml parses the text. Its composer is not used: it stops at the first error, drops the positions of duplicate
keys, and expands aliases without a limit. Plain scalars follow the core schema of YAML 1.2.2, section
10.3.2: ``010`` is ten, ``yes`` and ``1_000`` are strings. https://yaml.org/spec/1.2.2/
"""

import re
from collections.abc import Iterator, Sequence
from typing import Any, Never

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    MappingEndEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
    StreamEndEvent,
)

from stepbot.diagnostics import NOT_TEXT, Diagnostics, Span, did_you_mean

from .tree import Entry, Listing, Mapping, Scalar, Tree, subject

LARGEST_SIZE = 50_000
"""Maximum number of values after alias expansion."""
DEEPEST = 24
"""Maximum nesting depth; a sidecar needs eight."""

STAR = "\ue000"
"""Placeholder for the first ``*`` of a key whose missing quotes have been reported."""

_TEXT_TAGS = ("!", "tag:yaml.org,2002:str")
_INTEGER = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_OPENED_IN_KEY = re.compile(r"(?P<key>[^\W\d][\w-]*)(?P<between> +|:)(?P<value>\{[^}]*|\[[^\]]*)")
"""A key such as ``base {rest`` of ``base {rest: true}``, which is YAML, and not what is meant."""
_WORDS: dict[str, bool | float | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".inf", ".Inf", ".INF", "+.inf", "+.Inf", "+.INF"), float("inf")),
    **dict.fromkeys(("-.inf", "-.Inf", "-.INF"), float("-inf")),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
}


class TooMuchError(Exception):
    """Composing ended at the size or depth limit; the error has been reported."""


def compose(text: str, file: str, diagnostics: Diagnostics) -> Tree | None:
    """The root value of the text, or None if it is empty.

    Reports SB104 unknown aliases, SB107 duplicate keys, SB110 bounds, SB102 several documents, SB110 tags, directives
    and keys that a sidecar does not have, SB110 merges, SB110 empty values.

    Raises:
        MarkedYAMLError: The text is not YAML; errors reported before remain valid.
        TooMuchError: A limit was exceeded.
    """
    return _Composer(text, file, diagnostics).document()


class _Composer:
    def __init__(self, text: str, file: str, diagnostics: Diagnostics) -> None:
        self._events = _events(text)
        self._lines = text.split("\n")
        self._file, self._diagnostics = file, diagnostics
        self._anchors: dict[str, Tree | None] = {}
        """The value of each anchor; None while it is being composed."""
        self._keys: list[str | int] = []
        self._values = 0

    def document(self) -> Tree | None:
        root: Tree | None = None
        for event in self._events:
            if isinstance(event, DocumentStartEvent):
                self._check_start(event, root)
                if root is not None:
                    break
                root = self._value(next(self._events))
            elif isinstance(event, StreamEndEvent):
                break
        return root

    def _check_start(self, event: Any, root: Tree | None) -> None:
        if root is not None:
            help = ["remove the `---` or move the second document to its own file: each file describes one robot"]
            self._diagnostics.add("SB102", "sidecar: second YAML document in one file", self._span(event), help=help)
        elif event.version not in (None, (1, 2), [1, 2]):
            version = ".".join(map(str, event.version))
            help = ["remove the directive: sidecars use YAML 1.2"]
            self._diagnostics.add(
                "SB110", f"sidecar: unsupported directive %YAML {version}", self._span(event), help=help
            )

    def _value(self, event: Any) -> Tree:
        """The value that starts with ``event``."""
        self._values += 1
        if self._values > LARGEST_SIZE:
            self._too_much(event, f"more than {LARGEST_SIZE} values")
        if len(self._keys) >= DEEPEST:
            self._too_much(event, f"nesting exceeds {DEEPEST} levels")
        if isinstance(event, AliasEvent):
            return self._alias(event)
        tag_is_known = event.tag is None or (isinstance(event, ScalarEvent) and str(event.tag) in _TEXT_TAGS)
        if not tag_is_known:
            message = f"unsupported YAML tag '{event.tag}'"
            self._fault("SB110", message, self._span(event), ["write the value without the tag"])
        anchor = event.anchor
        if anchor is not None:
            self._anchors[anchor] = None
        value: Tree
        if isinstance(event, ScalarEvent):
            value = self._scalar(event)
        else:
            value = self._listing(event) if isinstance(event, SequenceStartEvent) else self._mapping(event)
        if not tag_is_known:
            value = Scalar(value.span, "", "", faulty=True)
        if anchor is not None:
            self._anchors[anchor] = value
        if value.size > LARGEST_SIZE:
            self._too_much(event, f"more than {LARGEST_SIZE} values after alias expansion")
        if value.depth > DEEPEST:
            self._too_much(event, f"nesting exceeds {DEEPEST} levels after alias expansion")
        return value

    def _scalar(self, event: Any) -> Scalar:
        span, text = self._span(event), str(event.value)
        if not event.style and event.tag is None:
            return Scalar(span, _core_value(text), text)
        if NOT_TEXT.search(text):
            self._fault("SB102", "escape sequence of a control character", span, ["remove it"])
            return Scalar(span, "", "", plain=False, faulty=True)
        return Scalar(span, text, text, plain=False)

    def _listing(self, event: Any) -> Listing:
        values: list[Tree] = []
        while not isinstance(item := next(self._events), SequenceEndEvent):
            self._keys.append(len(values))
            values.append(self._filled(self._value(item)))
            self._keys.pop()
        size, depth = 1 + sum(v.size for v in values), 1 + max((v.depth for v in values), default=0)
        return Listing(self._span(event, item), tuple(values), size, depth, bool(event.flow_style))

    def _mapping(self, event: Any) -> Mapping:
        entries: dict[str, Entry] = {}
        merged: list[Mapping] = []
        while not isinstance(item := next(self._events), MappingEndEvent):
            key, key_span = self._key(item)
            opened = _OPENED_IN_KEY.fullmatch(key or "") if isinstance(item, ScalarEvent) and not item.style else None
            key = opened["key"] if opened else key
            self._keys.append(key if key is not None else "?")
            value = self._value(next(self._events))
            if opened:
                value = self._without_colon(opened, key_span)
            if key == "<<" and isinstance(item, ScalarEvent) and not item.style:
                merged += self._merged(value)
            elif key is None:
                pass
            elif key in entries:
                self._keys.pop()
                first = entries[key].key_span
                what = f"duplicate key '{key}' (first defined on line {first.line})"
                help = ["remove or rename one of the keys"]
                self._fault("SB107", what, key_span, help, [f"first defined at {first}"])
                continue
            else:
                entries[key] = Entry(key_span, self._filled(value, key_span))
            self._keys.pop()
        own = list(entries.values())
        for source in merged:  # own keys override merged ones, earlier sources override later ones
            entries.update({key: entry for key, entry in source.entries.items() if key not in entries})
        size = 1 + sum(entry.value.size for entry in own) + sum(source.size for source in merged)
        depth = 1 + max((entry.value.depth for entry in entries.values()), default=0)
        return Mapping(self._span(event, item), entries, size, depth)

    def _without_colon(self, key: re.Match[str], span: Span) -> Scalar:
        """Report a key that contains the bracket of its value; the value is unknown."""
        what = "missing colon" if key["between"].isspace() else "missing space after the colon"
        line = self._lines[span.line - 1][span.column - 1 + key.start("value") :]
        self._fault("SB104", what, span, [f"write `{key['key']}: {line}`"])
        return Scalar(span, "", "", faulty=True)

    def _key(self, event: Any) -> tuple[str | None, Span]:
        """A key verbatim, so that ``1`` and ``on`` can be names; None if it cannot be a key."""
        key = self._value(event)
        if isinstance(key, Scalar) and not key.faulty:
            return key.text.replace(STAR, "*"), self._span(event)
        if not isinstance(key, Scalar):
            help = ["quote text that starts with [ or {"]
            self._fault("SB110", "key is a list or a mapping", key.span, help)
        return None, key.span

    def _alias(self, event: Any) -> Tree:
        name, span = str(event.anchor), self._span(event)
        if name not in self._anchors:
            help = [f'quote paths that start with *: "*{name.rstrip(":")}"', *did_you_mean(name, self._anchors)]
            self._fault("SB104", f"undefined alias *{name}", span, help)
        elif (value := self._anchors[name]) is None:
            self._fault("SB110", f"anchor '{name}' contains itself", span, ["replace the alias by the value"])
        elif isinstance(value, Scalar):
            return Scalar(span, value.value, value.text, value.plain, value.faulty)
        else:
            return value
        return Scalar(span, "", "", faulty=True)

    def _merged(self, value: Tree) -> list[Mapping]:
        sources = value.values if isinstance(value, Listing) else [value]
        for source in sources:
            if not isinstance(source, Mapping) and not source.faulty:
                help = ["refer to an anchor on a mapping: `<<: *name`"]
                self._fault("SB110", "value of the merge key '<<' is not a mapping", source.span, help)
        return [source for source in sources if isinstance(source, Mapping)]

    def _filled(self, value: Tree, key_span: Span | None = None) -> Tree:
        """The value, unless it is empty, which no key allows, or null, which drops a key in changes of a sidecar."""
        if not isinstance(value, Scalar) or value.value is not None or value.faulty:
            return value
        changes = self._keys[0] == "variants" or (self._keys[0] == "modules" and self._keys[2:3] == ["set"])
        if changes and value.text and isinstance(self._keys[-1], str) and len(self._keys) > 2:
            return value
        start = key_span or value.span
        comment = self._lines[start.line - 1][start.end_column - 1 :].lstrip(": ") if start.end_column else ""
        if re.match(r"#[^\s#]", comment):
            help = [f'# starts a comment; quote the text: "{comment}"']
        elif key_span and (number := self._decimal_comma_before(key_span)):
            help = [f"use a decimal point: `{number}`"]
        elif key_span and re.search(r"\w:\S", str(self._keys[-1])):
            help = ["add a space after the colon: `key: value`"]
        else:
            help = ["add a value, write {} for an empty mapping, or remove the key"]
        self._fault("SB110", "missing value", start, help)
        return Scalar(value.span, None, value.text, faulty=True)

    def _decimal_comma_before(self, key: Span) -> str:
        """The number, with its unit, split by a decimal comma in braces: ``1,5 N*m`` becomes a value 1 and a key."""
        line = self._lines[key.line - 1]
        whole, rest = re.search(r"[-+]?\d+,$", line[: key.column - 1]), str(self._keys[-1])
        return f"{whole[0][:-1]}.{rest}" if whole and rest[:1].isdigit() else ""

    def _too_much(self, event: Any, message: str) -> Never:
        help = ["use anchors for repeated settings, not for structures that contain each other"]
        self._diagnostics.add("SB110", f"{subject(tuple(self._keys[:2]))}: {message}", self._span(event), help=help)
        raise TooMuchError

    def _fault(self, code: str, message: str, span: Span, help: Sequence[str], notes: Sequence[str] = ()) -> None:
        self._diagnostics.add(code, f"{subject(tuple(self._keys))}: {message}", span, help=help, notes=notes)

    def _span(self, first: Any, last: Any = None) -> Span:
        start, end = first.start_mark, (last or first).end_mark
        end_column = end.column + 1 if end.line == start.line else 0
        return Span(self._file, start.line + 1, start.column + 1, end_column)


def _events(text: str) -> Iterator[Any]:
    """The events of ruamel.yaml's parser; converts its ValueError for escapes beyond Unicode."""
    yaml = YAML(typ="safe", pure=True)
    try:
        yield from yaml.parse(text)
    except (ValueError, OverflowError) as failure:
        raise MarkedYAMLError(
            problem="escape sequence beyond the Unicode range", problem_mark=yaml.reader.get_mark()
        ) from failure


def _core_value(text: str) -> str | int | float | bool | None:
    """The type of a plain scalar by the core schema."""
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text) and len(text) < 19:
        return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
    return float(text) if _FLOAT.fullmatch(text) else text
