"""Component paths, by which the sidecar and the command line refer to components.

    gripper/XL,XC-330/horn      the names on the way down from below the root; ``.`` is the root itself
    bolt#2                      the second of the siblings called bolt; without ``#n``, all of them
    horn                        a path from the root, else the one place where a path ends like this
    **/M3x8*                    ``*`` within a name, ``**`` across names; globs match from the root

A name is that of the product or of the occurrence. Fusion's save counter, `` v12`` in ``arm v12`` and ``arm v12:1``,
counts on neither side. ``/``, ``*`` and ``#`` inside a name take a backslash, as does a name that is a single dot;
every other character stands for itself.
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import Literal, TypeVar

from msgspec import Struct, field

from stepbot.diagnostics import NOT_TEXT, did_you_mean, one_line

from ..assembly import ROOT_PATH, Component

_ACROSS = "**"
_ANY = "\0"
_SAVE_COUNTER = re.compile(r"(?<=\S) v\d+(?=(?::\d+)?$)")
_ORDINAL = re.compile(r"(?<!\\)#(\d{1,18})$")
_ESCAPED = re.compile(r"\\([/*#])")
_ESCAPES = str.maketrans({character: f"\\{character}" for character in "/*#"})
_DOT = re.compile(r"\\*\.")
"""A name that would be the root without a backslash before it."""
_SLASH = re.compile(r"(?<!\\)/")
_STAR = re.compile(r"(?<!\\)\*+")

_T = TypeVar("_T")


class Binding(Struct, frozen=True):
    """The result of a path lookup."""

    pattern: str
    indices: tuple[int, ...] = ()
    """The components that match, in file order; one may be below another. Empty if there is a ``problem``."""
    topmost: tuple[int, ...] = ()
    """Those of ``indices`` that are not below another of them."""
    problem: Literal["", "unknown", "ambiguous"] = ""
    candidates: tuple[str, ...] = ()
    """Canonical paths of the candidates of an ambiguous path."""
    help: tuple[str, ...] = ()
    """Remedies, near matches first."""
    fragile: bool = False
    """Whether the path depends on an ordinal ``#n``, which changes if the CAD inserts an equal part."""


def plain_name(name: str) -> str:
    """A name without its save counter: ``arm v12`` and ``arm v12:1`` give ``arm`` and ``arm:1``.

    Characters that no sidecar may contain, such as those of a wrong code page, are U+FFFD.
    """
    name = NOT_TEXT.sub("\ufffd", name.strip())
    return _SAVE_COUNTER.sub("", name) if " v" in name else name


def escape(name: str) -> str:
    """A name as a segment of a path that matches exactly this name."""
    return f"\\{name}" if _DOT.fullmatch(name) else name.translate(_ESCAPES)


def segments_of(pattern: str) -> list[str]:
    """The segments of a path or glob, as they are written."""
    return _SLASH.split(pattern)


def is_glob(pattern: str) -> bool:
    """Whether a path has a ``*`` that stands for other characters."""
    return _STAR.search(pattern) is not None


def without_ordinal(segment: str) -> str:
    """A segment without its ``#n``."""
    return _ORDINAL.sub("", segment)


def quoted(path: str) -> str:
    """A path as a YAML string on one line, in quotes, ready to paste."""
    if not path.isprintable():
        text = path.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{one_line(text)}"'  # Python's escapes of control characters are YAML's too
    return f"'{path.replace(chr(39), 2 * chr(39))}'" if "\\" in path or '"' in path else f'"{path}"'


def subtree_ends(components: Sequence[Component]) -> list[int]:
    """For each component, the index after its last descendant; its subtree is contiguous in depth-first order."""
    ends = list(range(1, len(components) + 1))
    for component in reversed(components[1:]):
        ends[component.parent] = max(ends[component.parent], ends[component.index])
    return ends


def nearest_claim(components: Sequence[Component], claims: Iterable[tuple[Iterable[int], _T]], default: _T) -> list[_T]:
    """For each component the value of the nearest claim: on itself, else on the nearest component above it.

    Args:
        claims: Claimed components and the value of the claim; of several claims on one component, the first holds.
    """
    given: dict[int, _T] = {}
    for indices, value in claims:
        for index in indices:
            given.setdefault(index, value)
    values: list[_T] = []
    for component in components:
        above = values[component.parent] if component.parent >= 0 else default
        values.append(given.get(component.index, above))
    return values


class _Segment(Struct, frozen=True, eq=False):
    """One segment of a pattern."""

    text: str
    """As written."""
    name: str
    """Without escapes, ordinal and save counter; runs of stars are ``_ANY``."""
    ordinal: int
    """n of ``#n``; 0 if there is none."""
    _verdicts: dict[str, bool] = field(default_factory=dict)

    @property
    def is_glob(self) -> bool:
        return self.text == _ACROSS or _ANY in self.name

    def accepts(self, name: str) -> bool:
        """Whether a plain name matches, without the ordinal; results are cached, since names repeat."""
        if _ANY not in self.name:
            return name == self.name
        verdict = self._verdicts.get(name)
        if verdict is None:
            verdict = self._verdicts[name] = _matches_parts(name, self.name.split(_ANY))
        return verdict


def _matches_parts(name: str, parts: Sequence[str]) -> bool:
    """Whether a name consists of the parts in order, with anything between; each is matched where it first fits."""
    first, *middle, last = parts
    end = len(name) - len(last)
    if not (name.startswith(first) and name.endswith(last)):
        return False
    at = len(first)
    for part in middle:
        at_part = name.find(part, at, end)
        if at_part < 0:
            return False
        at = at_part + len(part)
    return at <= end


def _parse_segment(text: str) -> _Segment:
    base = _ORDINAL.sub("", text)
    ordinal = _ORDINAL.search(text)
    plain = plain_name(base)
    name = plain[1:] if _DOT.fullmatch(base) else _ESCAPED.sub(r"\1", _STAR.sub(_ANY, plain))
    return _Segment(text, name, int(ordinal[1]) if ordinal and base else 0)


class ComponentPaths:
    """Looks up paths in one assembly; built once, so that each lookup is fast even for thousands of components."""

    def __init__(self, components: Sequence[Component]) -> None:
        self._components = components
        self._ends = subtree_ends(components)
        self._product_names: list[tuple[str, ...]] = []
        self._occurrence_names: list[str] = []
        self._ordinals: list[int] = []
        self._by_name: dict[str, list[int]] = defaultdict(list)
        self._children: dict[tuple[int, str], list[int]] = defaultdict(list)
        for component in components:
            canonical = _parse_segment(component.segment)
            product, occurrence = plain_name(component.product), plain_name(component.occurrence)
            # The canonical name is numbered too: it is the occurrence's, or `body`, if the product's name is generic.
            numbered = canonical.ordinal > 0 or canonical.name != occurrence
            named = (product, canonical.name) if numbered else (product,)
            names = tuple(dict.fromkeys(name for name in named if name))
            self._product_names.append(names)
            self._occurrence_names.append(occurrence)
            self._ordinals.append(canonical.ordinal or component.ordinal)
            if component.parent >= 0:
                for name in dict.fromkeys((*names, occurrence)):
                    self._by_name[name].append(component.index)
                    self._children[component.parent, name].append(component.index)
        self._occurrence_ordinals = self._count_occurrences()

    def find(self, pattern: str) -> Binding:
        """The components that match a path or glob, or the reason for no match."""
        if pattern == ROOT_PATH:
            return Binding(pattern, (0,), (0,))
        segments = [_parse_segment(text) for text in segments_of(pattern)]
        if any(segment.is_glob for segment in segments):
            matches = self._glob(segments)
            return self._bound(pattern, segments, matches) if matches else self._unknown(pattern, segments)
        if exact := self._match_whole(segments):
            return self._bound(pattern, segments, exact)
        anchors = self._match_ends(segments)
        top = self._topmost(sorted(anchors))
        if not top:
            literal = [c.index for c in self._components if c.path == pattern]
            return self._bound(pattern, segments, literal) if literal else self._unknown(pattern, segments)
        if len({anchors[index] for index in top}) > 1:
            return self._ambiguous(pattern, top)
        return self._bound(pattern, segments, top)

    def find_one(self, pattern: str) -> Binding:
        """The only component that matches a path or glob; of several, the one with this canonical path."""
        binding = self.find(pattern)
        if len(binding.topmost) <= 1:
            return binding
        canonical = [index for index in binding.topmost if self._components[index].path == pattern]
        if canonical:
            return Binding(pattern, (canonical[0],), (canonical[0],), fragile=binding.fragile)
        return self._ambiguous(pattern, binding.topmost)

    def below(self, indices: Iterable[int]) -> list[int]:
        """The given components and everything below them, each once, in file order."""
        covered: list[int] = []
        end = 0
        for index in sorted(indices):
            covered += range(max(index, end), self._ends[index])
            end = max(end, self._ends[index])
        return covered

    def _count_occurrences(self) -> list[int]:
        """For each component, n among siblings of equal occurrence name; 0 if that is a sibling's product name."""
        products = {(c.parent, name) for c in self._components for name in self._product_names[c.index]}
        counts: dict[tuple[int, str], int] = defaultdict(int)
        ordinals = []
        for component in self._components:
            key = (component.parent, self._occurrence_names[component.index])
            counts[key] += 1
            ordinals.append(0 if key in products else counts[key])
        return ordinals

    def _matches(self, segment: _Segment, index: int) -> bool:
        if segment.ordinal in (0, self._ordinals[index]) and any(map(segment.accepts, self._product_names[index])):
            return True
        occurrence = self._occurrence_names[index]
        return (
            bool(occurrence)
            and segment.accepts(occurrence)
            and (segment.ordinal in (0, self._occurrence_ordinals[index]))
        )

    def _match_whole(self, segments: Sequence[_Segment]) -> list[int]:
        """Components whose whole path matches segments without stars, in file order."""
        components = [0]
        for segment in segments:
            named = (child for parent in components for child in self._children.get((parent, segment.name), ()))
            components = [child for child in named if self._matches(segment, child)]
        return sorted(components)

    def _match_ends(self, segments: Sequence[_Segment]) -> dict[int, int]:
        """Components whose path ends with the segments, each with the parent of the first segment."""
        ends = {}
        for index in self._by_name.get(segments[-1].name, ()):
            at = index
            for segment in reversed(segments):
                if at <= 0 or not self._matches(segment, at):
                    break
                at = self._components[at].parent
            else:
                ends[index] = at
        return ends

    def _glob(self, segments: Sequence[_Segment]) -> list[int]:
        """Components whose whole path matches: an automaton whose states are bits, run down the tree."""
        if segments[-1].text == _ACROSS:  # "everything below", so at least one more name
            segments = [*segments, _Segment("*", _ANY, 0)]
        across = sum(1 << i for i, segment in enumerate(segments) if segment.text == _ACROSS)
        accepted = 1 << len(segments)
        states = [0] * len(self._components)
        states[0] = _skip_across(1, segments)
        matches = []
        for component in self._components[1:]:
            before = states[component.parent]
            after = before & across
            for i in _bits(before & ~across & (accepted - 1)):
                if self._matches(segments[i], component.index):
                    after |= 1 << (i + 1)
            states[component.index] = after = _skip_across(after, segments)
            if after & accepted:
                matches.append(component.index)
        if [segment.text for segment in segments] == [_ACROSS, "*"] and self._components[0].body >= 0:
            matches.insert(0, 0)  # an assembly that is one part
        return matches

    def _topmost(self, indices: Sequence[int]) -> tuple[int, ...]:
        top: list[int] = []
        for index in indices:
            if not top or index >= self._ends[top[-1]]:
                top.append(index)
        return tuple(top)

    def _bound(self, pattern: str, segments: Sequence[_Segment], indices: Sequence[int]) -> Binding:
        top = self._topmost(indices)
        fragile = any(segment.ordinal for segment in segments) and any(map(self._is_by_ordinal_only, top))
        return Binding(pattern, tuple(indices), top, fragile=fragile)

    def _is_by_ordinal_only(self, index: int) -> bool:
        while index >= 0:
            if self._components[index].by_ordinal_only:
                return True
            index = self._components[index].parent
        return False

    def _ambiguous(self, pattern: str, indices: Sequence[int]) -> Binding:
        return Binding(
            pattern,
            problem="ambiguous",
            candidates=tuple(self._components[index].path for index in indices),
            help=("use one of the full paths",),
        )

    def _unknown(self, pattern: str, segments: Sequence[_Segment]) -> Binding:
        remedies = self._near_paths(segments)
        root = self._components[0]
        if len(segments) > 1 and segments[0].name in (plain_name(root.product), plain_name(root.occurrence)):
            rest = "/".join(segment.text for segment in segments[1:])
            remedies = (f"paths begin below the root: {quoted(rest)}", *remedies)
        elif segments[0].name in (plain_name(root.product), plain_name(root.occurrence)):
            remedies = (f'the root itself is "{ROOT_PATH}"', *remedies)
        is_misspelt = bool(remedies) and any(not self._is_name(segment) for segment in segments)
        if any(segment.is_glob for segment in segments) and segments[0].text != _ACROSS and not is_misspelt:
            remedies = (*remedies, "globs match from the root: begin with `**/` to match at any depth")
        return Binding(pattern, problem="unknown", help=remedies)

    def _is_name(self, segment: _Segment) -> bool:
        """Whether any component has such a name, at any depth."""
        return not segment.name.replace(_ANY, "") or any(segment.accepts(name) for name in self._by_name)

    def _near_paths(self, segments: Sequence[_Segment]) -> tuple[str, ...]:
        """Help for a misspelt path: the first segment without a match is the one to correct."""
        for segment in segments:
            word = segment.name.replace(_ANY, "")
            if self._is_name(segment):
                continue
            parts = segment.name.casefold().split(_ANY)
            cased = [name for name in self._by_name if segment.is_glob and _matches_parts(name.casefold(), parts)]
            if cased:
                return (f"upper and lower case differ: '{cased[0]}'",)
            same = [name for name in self._by_name if name.casefold() == word.casefold()]
            return tuple(f"did you mean '{name}'?" for name in same[:1]) or did_you_mean(word, self._distinct(word))
        last = segments[-1]
        places = [c.path for c in self._components[1:] if self._matches(last, c.index)] if last.name.strip(_ANY) else []
        return tuple(f"did you mean {quoted(path)}?" for path in places[:3])

    def _distinct(self, word: str) -> list[str]:
        """Names of different components; of two for the same ones, that of an occurrence if the word looks like one."""
        numbered = ":" in word
        names = sorted(self._by_name, key=lambda name: (":" in name) != numbered)  # stable: products come first
        of: dict[tuple[int, ...], str] = {}
        for name in names:
            of.setdefault(tuple(self._by_name[name]), name)
        return list(of.values())


def _skip_across(states: int, segments: Sequence[_Segment]) -> int:
    """``**`` may match no name at all: add the state after each one."""
    for i, segment in enumerate(segments):
        if segment.text == _ACROSS and states >> i & 1:
            states |= 1 << (i + 1)
    return states


def _bits(states: int) -> Iterable[int]:
    while states:
        lowest = states & -states
        yield lowest.bit_length() - 1
        states ^= lowest
