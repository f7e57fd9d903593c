"""USD's binary format, "crate" version 0.8, for layers of meshes, by the AOUSD Core Specification 1.0.

https://aousd.org/blog/foundations-of-open-3d-development-introducing-aousd-core-specification-1-0/
A layer is a bootstrap, values, and six tables: tokens, strings, fields, sets of fields, paths and specs. A spec (layer,
prim or attribute) has a path and a set of fields; a field has a token as its name, and a value of 64 bits that holds
the value itself or its offset. Tables and integers are packed by a code for their differences and then by LZ4, whose
blocks may consist of literals alone: no compressor is needed, and the bytes are the same everywhere.
"""

import struct
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from msgspec import Struct, field
from numpy.typing import NDArray

_VERSION = (0, 8, 0)
"""Every USD since 2020 reads it, and so do Apple's readers."""
_BOOTSTRAP = 88
_ATTRIBUTE, _PRIM, _LAYER = 1, 6, 7
"""Types of specs."""
_INT, _DOUBLE, _STRING, _TOKEN, _VEC3F, _TOKENS, _SPECIFIER, _VARIABILITY = 3, 9, 10, 11, 24, 41, 42, 44
"""Types of values."""
_ARRAY, _INLINED, _COMPRESSED = 1 << 63, 1 << 62, 1 << 61
_LEAST_COMPRESSED = 16
"""Shorter arrays of integers are stored as they are."""
_END_OF_SET = -1
_UNIFORM = 1

Ints = NDArray[np.int32]
Singles = NDArray[np.float32]


class CrateAttribute(Struct, frozen=True):
    """An attribute with its value."""

    name: str
    type: str
    """``point3f[]``, ``int[]``, ``token``."""
    value: Singles | Ints | str
    """Singles of shape (n, 3), integers of shape (n,), or a token."""
    uniform: bool = False
    interpolation: str = ""
    """Of normals: ``uniform`` for one per face."""


class CratePrim(Struct, frozen=True):
    """A prim that is defined."""

    type: str
    name: str
    attributes: Sequence[CrateAttribute] = ()
    children: Sequence["CratePrim"] = ()


def crate(metadata: Mapping[str, str | float], doc: str, top: CratePrim) -> bytes:
    """The bytes of a binary layer with one root prim, its default one.

    Args:
        metadata: Numbers and tokens of the layer, such as ``metersPerUnit``.

    Raises:
        ValueError: A number is not finite.
    """
    return _Crate(metadata, doc, top).content()


class _Path(Struct):
    """A node of the tree of paths."""

    name: str
    spec: int
    fields: int
    """Index of its set of fields."""
    children: list["_Path"] = field(default_factory=list)


class _Crate:
    def __init__(self, metadata: Mapping[str, str | float], doc: str, top: CratePrim) -> None:
        self._tokens: dict[str, int] = {top.name: 0}  # indices of attributes are negated in the paths: none has 0
        self._strings: dict[str, int] = {}
        self._fields: dict[tuple[int, int], int] = {}
        self._sets: dict[tuple[int, ...], int] = {}
        self._set_entries: list[int] = []
        self._values = bytearray(_BOOTSTRAP)
        self._offsets: dict[bytes, int] = {}
        fields = {"defaultPrim": self._token(top.name), "documentation": self._string(doc)}
        fields |= {key: self._scalar(value) for key, value in metadata.items()}
        fields["primChildren"] = self._names([top.name])
        self._root = _Path("", _LAYER, self._set(fields), [self._prim(top)])

    def _prim(self, prim: CratePrim) -> _Path:
        fields = {"specifier": _inlined(_SPECIFIER, 0), "typeName": self._token(prim.type)}
        if prim.attributes:
            fields["properties"] = self._names([attribute.name for attribute in prim.attributes])
        if prim.children:
            fields["primChildren"] = self._names([child.name for child in prim.children])
        parts = [self._attribute(attribute) for attribute in prim.attributes] + [
            self._prim(child) for child in prim.children
        ]
        return _Path(prim.name, _PRIM, self._set(fields), parts)

    def _attribute(self, attribute: CrateAttribute) -> _Path:
        fields = {"typeName": self._token(attribute.type)}
        if attribute.uniform:
            fields["variability"] = _inlined(_VARIABILITY, _UNIFORM)
        if attribute.interpolation:
            fields["interpolation"] = self._token(attribute.interpolation)
        value = attribute.value
        fields["default"] = self._token(value) if isinstance(value, str) else self._array(value)
        return _Path(attribute.name, _ATTRIBUTE, self._set(fields))

    def _set(self, fields: Mapping[str, int]) -> int:
        """The index of a set of fields, from their values by name."""
        pairs = [(self._index(name), value) for name, value in fields.items()]
        entries = tuple(self._fields.setdefault(pair, len(self._fields)) for pair in pairs)
        if entries not in self._sets:
            self._sets[entries] = len(self._set_entries)
            self._set_entries += [*entries, _END_OF_SET]
        return self._sets[entries]

    def _index(self, token: str) -> int:
        return self._tokens.setdefault(token, len(self._tokens))

    def _token(self, token: str) -> int:
        return _inlined(_TOKEN, self._index(token))

    def _string(self, text: str) -> int:
        return _inlined(_STRING, self._strings.setdefault(text, len(self._strings)))

    def _scalar(self, value: str | float) -> int:
        return self._token(value) if isinstance(value, str) else self._stored(_DOUBLE, struct.pack("<d", value))

    def _names(self, names: Sequence[str]) -> int:
        return self._stored(_TOKENS, struct.pack(f"<Q{len(names)}I", len(names), *map(self._index, names)))

    def _array(self, values: Singles | Ints) -> int:
        """An array; one without elements has no place in the file."""
        kind = _VEC3F if values.ndim == 2 else _INT
        if not np.isfinite(values).all():
            raise ValueError("NaN and infinity cannot be written")
        if not len(values):
            return kind << 48 | _ARRAY
        count = struct.pack("<Q", len(values))
        if kind == _INT and len(values) >= _LEAST_COMPRESSED:
            return self._stored(kind, count + _integers(values.astype(np.int32))) | _ARRAY | _COMPRESSED
        return self._stored(kind, count + values.astype("<f4" if kind == _VEC3F else "<i4").tobytes()) | _ARRAY

    def _stored(self, kind: int, content: bytes) -> int:
        """A value at an offset that is a multiple of 8; equal ones share it."""
        if content not in self._offsets:
            self._values += bytes(-len(self._values) % 8)
            self._offsets[content] = len(self._values)
            self._values += content
        return kind << 48 | self._offsets[content]

    def content(self) -> bytes:
        """The whole layer."""
        paths = list(_depth_first(self._root))
        tables = {"PATHS": self._paths(paths), "SPECS": _specs(paths)}
        tables |= {"FIELDS": self._field_table(), "FIELDSETS": _counted(self._set_entries)}
        indices = [self._index(text) for text in self._strings]
        tables |= {"STRINGS": struct.pack(f"<Q{len(indices)}I", len(indices), *indices), "TOKENS": self._token_table()}
        result, places = self._values, []
        for name, table in reversed(tables.items()):
            places.append(struct.pack("<16sqq", name.encode(), len(result), len(table)))
            result += table
        start = len(result)
        result += struct.pack("<Q", len(places)) + b"".join(places)
        result[:_BOOTSTRAP] = struct.pack("<8s8Bq64x", b"PXR-USDC", *_VERSION, 0, 0, 0, 0, 0, start)
        return bytes(result)

    def _token_table(self) -> bytes:
        text = b"".join(token.encode() + b"\0" for token in self._tokens)
        packed = _packed(text)
        return struct.pack("<QQQ", len(self._tokens), len(text), len(packed)) + packed

    def _field_table(self) -> bytes:
        values = _packed(struct.pack(f"<{len(self._fields)}Q", *(value for _, value in self._fields)))
        return _counted([name for name, _ in self._fields]) + struct.pack("<Q", len(values)) + values

    def _paths(self, paths: Sequence[tuple[_Path, int]]) -> bytes:
        tokens = [0, *(self._index(path.name) * (-1 if path.spec == _ATTRIBUTE else 1) for path, _ in paths[1:])]
        count = struct.pack("<Q", len(paths))
        jumps = [jump for _, jump in paths]
        return count + _counted(range(len(paths))) + _integers(tokens) + _integers(jumps)


def _depth_first(path: _Path, *, last: bool = True) -> Iterator[tuple[_Path, int]]:
    """Each path with its jump: how far its next sibling is, 0 if that follows, -1 for a last one with children, or -2.

    Args:
        last: Whether it has no further sibling.
    """
    below = [one for child in path.children for one in _depth_first(child, last=child is path.children[-1])]
    alone = -2 if last else 0
    yield path, alone if not below else -1 if last else 1 + len(below)
    yield from below


def _specs(paths: Sequence[tuple[_Path, int]]) -> bytes:
    sets, specs = [path.fields for path, _ in paths], [path.spec for path, _ in paths]
    return _counted(range(len(paths))) + _integers(sets) + _integers(specs)


def _inlined(kind: int, value: int) -> int:
    return kind << 48 | _INLINED | value


def _counted(values: Sequence[int]) -> bytes:
    return struct.pack("<Q", len(values)) + _integers(values)


def _integers(values: Sequence[int] | Ints) -> bytes:
    """The size of packed integers, and them: the most frequent difference, two bits for the size of each, and those."""
    numbers = np.asarray(values, dtype=np.int64)
    steps = np.diff(numbers, prepend=0).astype(np.int32)  # modulo 2**32, as the reader adds them
    distinct, counts = np.unique(steps, return_counts=True)
    common = distinct[np.argmax(counts)]
    codes = np.full(len(steps), 3, np.uint8)
    codes[(steps >= -(1 << 15)) & (steps < 1 << 15)] = 2
    codes[(steps >= -(1 << 7)) & (steps < 1 << 7)] = 1
    codes[steps == common] = 0
    quads = np.concatenate([codes, np.zeros(-len(codes) % 4, np.uint8)]).reshape(-1, 4)
    bits = quads[:, 0] | quads[:, 1] << 2 | quads[:, 2] << 4 | quads[:, 3] << 6
    sizes = np.array([0, 1, 2, 4])[codes]
    places, content = np.cumsum(sizes) - sizes, np.zeros(int(sizes.sum()), np.uint8)
    for byte in range(4):
        wide = sizes > byte
        content[places[wide] + byte] = (steps[wide] >> (8 * byte)) & 0xFF
    packed = _packed(struct.pack("<i", common) + bits.astype(np.uint8).tobytes() + content.tobytes())
    return struct.pack("<Q", len(packed)) + packed


def _packed(content: bytes) -> bytes:
    """One block of LZ4 with literals alone, after the number of further blocks."""
    more = len(content) - 15
    if more < 0:
        return bytes((0, len(content) << 4)) + content
    return b"\0\xf0" + b"\xff" * (more // 255) + bytes((more % 255,)) + content
