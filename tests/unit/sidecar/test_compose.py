"""YAML text to values with places, against ruamel.yaml's loader where it follows YAML 1.2."""

import io
import json
import math
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError

from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.compose import DEEPEST, TooMuchError, compose
from stepbot.sidecar.load import load_sidecar
from stepbot.sidecar.text import BoundedDiagnostics, TooManyFaultsError
from stepbot.sidecar.tree import Tree, plain_data, span

FILE = "a.robot.yaml"


def composed(text: str, diagnostics: Diagnostics) -> Tree:
    """The tree of a text with a value."""
    tree = compose(text, FILE, diagnostics)
    assert tree is not None
    return tree


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("010", 10),
        ("0o10", 8),
        ("0x10", 16),
        ("-7", -7),
        ("1e3", 1000.0),
        ("-1e-3", -0.001),
        (".5", 0.5),
        ("5.", 5.0),
        (".inf", math.inf),
        ("-.inf", -math.inf),
        ("-inf", "-inf"),
        ("true", True),
        ("yes", "yes"),
        ("on", "on"),
        ("1_000", "1_000"),
        ("1:30", "1:30"),
        ("2024-01-01", "2024-01-01"),
        ("_", "_"),
        ("45 deg", "45 deg"),
        ("-z", "-z"),
        ("'10'", "10"),
        ("!!str 10", "10"),
        ("! 10", "10"),
        ("9" * 30, 1e30),
    ],
)
def test_scalars_follow_the_core_schema(text: str, value: object, diagnostics: Diagnostics) -> None:
    """Plain scalars follow YAML 1.2.2, section 10.3.2; quoted ones are strings."""
    data = plain_data(composed(f"a: {text}", diagnostics))["a"]
    assert data == value
    assert type(data) is type(value)


SCALARS = st.one_of(
    st.integers(-(10**9), 10**9),
    st.floats(allow_nan=False, allow_infinity=False),
    st.booleans(),
    st.text("abcö *#:,[]{}'\"\\\n0-", min_size=1),
)
KEYS = st.text("abcö *#:0-", min_size=1, max_size=8)
VALUES = st.recursive(
    SCALARS, lambda values: st.lists(values, max_size=4) | st.dictionaries(KEYS, values, max_size=4), max_leaves=20
)


@pytest.mark.slow
@given(data=st.dictionaries(KEYS, VALUES, max_size=5))
def test_json_comes_back(data: object) -> None:
    """Output of the standard library's JSON writer is read unchanged."""
    diagnostics = Diagnostics()
    assert plain_data(composed(json.dumps(data, ensure_ascii=False), diagnostics)) == data
    assert len(diagnostics) == 0


@pytest.mark.slow
@given(data=st.dictionaries(KEYS, VALUES, max_size=5))
def test_block_style_comes_back(data: object) -> None:
    """Block-style output of ruamel.yaml is read unchanged."""
    writer, stream, diagnostics = YAML(typ="safe", pure=True), io.StringIO(), Diagnostics()
    writer.default_flow_style = False
    writer.dump(data, stream)
    assert plain_data(composed(stream.getvalue(), diagnostics)) == data
    assert len(diagnostics) == 0


def is_plain(data: object) -> bool:
    """Whether data can be represented in JSON, recursively."""
    if isinstance(data, dict):
        return all(isinstance(key, str) and is_plain(value) for key, value in data.items())
    if isinstance(data, list):
        return all(map(is_plain, data))
    return data is None or isinstance(data, bool | int | float | str)


@given(text=st.text("ab:*&<-#[]{}, \n'\"!|>%@`\t?0.~", max_size=60))
def test_any_text_ends_in_a_value_or_a_fault(text: str) -> None:
    """For any text, composing raises only YAML errors and exceeded limits."""
    try:
        tree = compose(text, FILE, Diagnostics())
    except (MarkedYAMLError, TooMuchError):
        tree = None
    assert tree is None or is_plain(plain_data(tree))


def test_places(diagnostics: Diagnostics) -> None:
    """Lines and columns count from 1; a value on one line has an end."""
    tree = composed("a:\n  b: [1, 'zwölf']\n  c: {d: *x}\n".replace("*x", "x"), diagnostics)
    assert (span(tree, ("a", "b", 1)).line, span(tree, ("a", "b", 1)).column) == (2, 10)
    assert span(tree, ("a", "b", 1)).end_column == 17
    assert span(tree, ("a", "b")).end_column == 18
    assert span(tree, ("a",)).end_column == 0
    assert span(tree, ("a", "c", "no", "such")).column == 3
    assert span(tree, ()).line == 1


def test_merge_keys(diagnostics: Diagnostics) -> None:
    """Own keys take precedence over merged ones in any order, earlier sources over later ones."""
    text = "a: &a {x: 1, y: 1}\nb: &b {x: 2, z: 2}\nc: {z: 3, <<: [*a, *b]}\nd:\n  <<: *a\n  x: 4\n"
    data = plain_data(composed(text, diagnostics))
    assert data["c"] == {"z": 3, "x": 1, "y": 1}
    assert data["d"] == {"x": 4, "y": 1}


def test_quoted_merge_key_is_a_key(diagnostics: Diagnostics) -> None:
    """Only a plain `<<` merges."""
    assert plain_data(composed("a: {'<<': {x: 1}}", diagnostics)) == {"a": {"<<": {"x": 1}}}


def test_every_duplicate_is_reported(diagnostics: Diagnostics) -> None:
    """Every duplicate key is reported with its place, and the first value applies."""
    tree = composed("a: 1\nb: {c: 1, c: 2, c: 3}\n'a': 2\n", diagnostics)
    assert plain_data(tree) == {"a": 1, "b": {"c": 1}}
    assert [(d.code, d.span.line, d.span.column) for d in diagnostics] == [
        ("SB107", 2, 11),
        ("SB107", 2, 17),
        ("SB107", 3, 1),
    ]


def test_alias_shows_its_own_place(diagnostics: Diagnostics) -> None:
    """An error in an aliased scalar is reported at the alias."""
    assert span(composed("a: &x 3 kg\nb: *x\n", diagnostics), ("b",)).line == 2


@pytest.mark.parametrize(
    "text",
    [
        "a: &a [x, x, x, x, x, x, x, x, x, x]\n"
        + "".join(f"{b}: &{b} [{', '.join(['*' + a] * 10)}]\n" for a, b in zip("abcdefghi", "bcdefghij", strict=True)),
        "a0: &a0 {k0: 1, l0: 1}\n"
        + "".join(f"a{n}: &a{n} {{k{n}: *a{n - 1}, l{n}: *a{n - 1}}}\n" for n in range(1, 23)),
        "a: &a {" + ", ".join(f"k{n}: 1" for n in range(1000)) + "}\n" + "b:\n" + "- <<: *a\n" * 200,
        "[" * 5000,
        "a: " + "{a: " * 5000,
        "- " * 5000 + "x",
        "a: &a [" * (DEEPEST + 1) + "x" + "]" * (DEEPEST + 1),
    ],
    ids=["billion laughs", "doubling maps", "merges", "lists", "maps", "items", "anchors"],
)
def test_bombs_end_quickly(text: str) -> None:
    """Aliases that expand to too much, or nest too deeply, are reported without expansion."""
    diagnostics, start = Diagnostics(), time.process_time()
    with pytest.raises((TooMuchError, MarkedYAMLError)) as caught:
        compose(text, FILE, diagnostics)
    assert time.process_time() - start < 20
    if caught.type is TooMuchError:
        assert [d.code for d in diagnostics] == ["SB110"]


def test_values_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """A list that is too long is reported where it exceeds the limit."""
    monkeypatch.setattr("stepbot.sidecar.compose.LARGEST_SIZE", 1000)
    diagnostics = Diagnostics()
    with pytest.raises(TooMuchError):
        compose("a: [" + "1, " * 300_000, FILE, diagnostics)
    assert [(d.code, d.span.column) for d in diagnostics] == [("SB110", 5 + 997 * 3)]


def test_faults_are_bounded() -> None:
    """The number of reported syntax errors is limited."""
    diagnostics = BoundedDiagnostics()
    with pytest.raises(TooManyFaultsError):
        compose("a: 1\n" * 3000, FILE, diagnostics)


def test_a_sidecar_may_have_any_number_of_warnings(tmp_path: Path) -> None:
    """A draft of a large robot has a placeholder in each joint: 150 of them are no reason to refuse it."""
    links = "".join(f"  l{n}: {{}}\n" for n in range(151))
    joints = "".join(f"  j{n}: {{type: revolute, parent: l{n}, child: l{n + 1}, limits: todo}}\n" for n in range(150))
    path = tmp_path / "long.robot.yaml"
    path.write_text(f"version: 1\nrobot: long\nstep: a.step\nlinks:\n{links}joints:\n{joints}", encoding="utf-8")
    diagnostics = Diagnostics()
    sidecar = load_sidecar(path, diagnostics)
    assert sidecar is not None
    check_sidecar(sidecar, diagnostics)
    assert not diagnostics.has_errors
    assert [one.code for one in diagnostics].count("SB463") == 150
