"""Data classes and arrays are encoded and decoded unchanged, or rejected."""

import random
from collections.abc import Mapping
from math import copysign, inf, isnan, nan
from typing import Any, Literal, NamedTuple, TypeVar, get_origin, get_type_hints

import numpy as np
import pytest
from msgspec import Struct
from numpy.typing import NDArray
from typing_extensions import TypeAliasType

from stepbot.diagnostics import Diagnostic, Span
from stepbot.engines.observation import Observation, Quantity, Request
from stepbot.jobs.incremental import Record
from stepbot.pipeline.loading import Geometry
from stepbot.report.robot import Report
from stepbot.robot.model import Base, Box, Robot, Sphere
from stepbot.robot.model import Geometry as Shape
from stepbot.runtime.cache import Undecodable, codec_of
from stepbot.step.assembly import Assembly, ReadOptions
from tests.robots import four_bar


class Pair(NamedTuple):
    """A tuple whose fields have names."""

    name: str
    span: Span | None = None


class Everything(Struct, frozen=True, eq=False):
    """One field of each supported type."""

    flag: bool
    count: int
    number: float
    text: str
    data: bytes
    kind: Base
    choice: Literal["a", "b"]
    pair: tuple[int, str]
    many: tuple[float, ...]
    nested: tuple[tuple[Span, ...], ...]
    mapping: Mapping[Quantity, tuple[int, ...]]
    perhaps: Span | None
    record: Pair
    shape: Shape
    points: NDArray[np.float64]
    faces: NDArray[np.int32]


def example() -> Everything:
    """Values that are easily changed by an encoding."""
    return Everything(
        True,
        -(2**70),
        0.1 + 0.2,
        "Grüße \udcff 机器人 \x00",
        b"\x00\xff",
        Base.FLOATING,
        "b",
        (1, "x"),
        (-0.0, inf, -inf, 5e-324, 1.7976931348623157e308, 3),
        ((), (Span("a", 1),)),
        {Quantity.MASS: (1, 2), Quantity.COM: ()},
        None,
        Pair("x", Span("a", 1, 2)),
        Sphere(0.5),
        np.array([[1.0, -0.0, nan]]),
        np.empty((0, 3), np.int32),
    )


def assert_same(one: Any, other: Any) -> None:
    """Assert equality to the last bit, including the types of numbers."""
    assert type(one) is type(other) or isinstance(one, Mapping)
    if isinstance(one, np.ndarray):
        assert (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())
    elif isinstance(one, Struct):
        for name in one.__struct_fields__:
            assert_same(getattr(one, name), getattr(other, name))
    elif isinstance(one, tuple):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            assert_same(a, b)
    elif isinstance(one, Mapping):
        assert_same(tuple(one.items()), tuple(other.items()))
    elif isinstance(one, float):
        assert (isnan(one) and isnan(other)) or (one == other and copysign(1, one) == copysign(1, other))
    else:
        assert one == other


def test_everything_comes_back() -> None:
    """Signed zeros, infinities, integers in float fields and lone surrogates are decoded unchanged."""
    codec = codec_of(Everything)
    data = codec.encode(example())
    assert_same(example(), codec.decode(data))
    assert codec.encode(codec.decode(data)) == data


def test_robot_comes_back() -> None:
    """A whole robot with loops and meshes is decoded unchanged."""
    robot = four_bar()
    assert_same(robot, codec_of(Robot).decode(codec_of(Robot).encode(robot)))


def test_arrays_come_back_read_only() -> None:
    """Decoded arrays share the cache's bytes and are read-only."""
    points = codec_of(Everything).decode(codec_of(Everything).encode(example())).points
    with pytest.raises(ValueError, match="read-only"):
        points[0, 0] = 2.0


@pytest.mark.parametrize(
    "kind", [Assembly, Diagnostic, Geometry, Observation, ReadOptions, Record, Report, Request, Robot]
)
def test_all_that_is_kept_has_a_codec(kind: type) -> None:
    """Every field of cached data has an annotation that the codec supports, recursively."""
    seen: set[Any] = set()

    def walk(one: Any) -> None:
        codec_of(one)
        is_tuple = isinstance(one, type) and issubclass(one, tuple) and hasattr(one, "_fields")
        is_record = isinstance(one, type) and issubclass(one, Struct)
        if one in seen or not (is_record or is_tuple):
            for argument in getattr(one, "__args__", ()):
                if (
                    argument is not Ellipsis
                    and not isinstance(argument, str)
                    and get_origin(one) not in (np.ndarray, NDArray)
                ):
                    walk(argument)
            return
        seen.add(one)
        hints = get_type_hints(one)
        for name in one._fields if is_tuple else one.__struct_fields__:
            walk(hints[name])

    walk(kind)
    assert kind in seen


def test_damaged_bytes_are_rejected_or_valid() -> None:
    """Any damaged bytes give a value of the type, or the codec's error, never another one."""
    data = codec_of(Everything).encode(example())
    generator = random.Random(7)
    refused = 0
    for _ in range(3000):
        damaged = bytearray(data)
        for _ in range(generator.randint(1, 4)):
            damaged[generator.randrange(len(damaged))] = generator.randrange(256)
        if generator.random() < 0.3:
            del damaged[generator.randrange(len(damaged)) :]
        try:
            value = codec_of(Everything).decode(bytes(damaged))
        except Undecodable:
            refused += 1
        else:
            assert isinstance(value, Everything)
    assert refused > 1000


def test_other_types_are_refused() -> None:
    """Data of one type is rejected when decoded as another."""
    with pytest.raises(Undecodable):
        codec_of(Span).decode(codec_of(Box).encode(Box((1.0, 2.0, 3.0))))


def test_arrays_of_objects_are_refused() -> None:
    """Object arrays are rejected: storing them requires pickling, which executes what it reads."""
    with pytest.raises(TypeError):
        codec_of(np.ndarray).encode(np.array([{}], dtype=object))


def test_what_has_no_annotation_is_a_bug() -> None:
    """An unsupported type is reported when its codec is requested."""
    with pytest.raises(TypeError, match="no codec"):
        codec_of(set)


Number = TypeVar("Number", bound=np.generic)
Grid = TypeAliasType("Grid", np.ndarray[tuple[Any, ...], np.dtype[Number]], type_params=(Number,))
"""``type Grid[Number] = ...``: the form of numpy's own ``NDArray`` from numpy 2.5 on."""
Corners = TypeAliasType("Corners", Grid[np.float64])
Corner = TypeAliasType("Corner", tuple[float, ...])


class Aliased(Struct, frozen=True, eq=False):
    """Fields whose annotations are aliases, aliases of aliases, and aliases within other types."""

    grid: Grid[np.int32]
    corners: Corners
    corner: Corner | None
    named: Mapping[str, tuple[Corner, ...]]


def test_aliases_stand_for_their_types() -> None:
    """Aliases of the ``type`` statement are expanded, with their arguments, for any target."""
    value = Aliased(np.arange(3, dtype=np.int32), np.eye(3), (0.5,), {"a": ((1.5, 2.5),)})
    assert_same(value, codec_of(Aliased).decode(codec_of(Aliased).encode(value)))
