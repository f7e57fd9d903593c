"""YAML syntax errors have their places, and the sections around them are read."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.syntax_faults import compose_around_faults
from stepbot.sidecar.tree import plain_data

FILE = "a.robot.yaml"


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ("a: [1, 2\nb: 3\n", 1, 4, "unclosed '['"),
        ("a: {x: 1\nb: 3\n", 1, 4, "unclosed '{'"),
        ("a: [x, {y: [1}]\nb: 3\n", 1, 12, "unclosed '['"),
        ('a: "x\nb: 3\n', 1, 4, "unclosed quote"),
        ("a: 'x\n", 1, 4, "unclosed quote"),
        ("a: x: y\n", 1, 5, "unexpected colon"),
        ("a\nb: 3\n", 2, 2, "unexpected colon"),
        ("a:1\nb: 3\n", 1, 3, "missing space after the colon of 'a'"),
        ("a:1\n# c\n\nb: 3\n", 1, 3, "missing space after the colon of 'a'"),
        ("b: 3\na:so101\nc: 4\n", 2, 3, "missing space after the colon of 'a'"),
        ("b: 3\na so101\nc: 4\n", 2, 2, "missing colon of 'a'"),
        ("a:{x: 1, y: 2}\n", 1, 1, "missing space after the colon"),
        ("a:\n  c: 4\n  base [x, y]\n", 3, 7, "missing colon of 'base'"),
        ("a:\n  type:ball\n  c: 4\n", 2, 8, "missing space after the colon of 'type'"),
        ("a: some\n  more text\nb: c: d\n", 3, 5, "unexpected colon"),
        ("a:\n  x: 1\n y: 2\n", 3, 2, "inconsistent indentation"),
        ("a:\n  - x\n   - y\n  z: 1\n", 4, 3, "inconsistent indentation"),
        ("a: @x\n", 1, 4, "value starts with the reserved character @"),
        ("a: 'it's'\n", 1, 8, "unexpected text"),
        ("a: x]\nb: [1]]\n", 2, 7, "unexpected ']'"),
        ('a: "b\\#1"\n', 1, 4, "in a double-quoted string"),
        ("a: - x\n", 1, 4, "unexpected list item"),
        ("{a: 1}}\n", 1, 7, "unexpected '}'"),
    ],
)
def test_error_is_reported_at_its_place(text: str, line: int, column: int, message: str) -> None:
    """An error is described at the place to edit."""
    diagnostics = Diagnostics()
    assert not compose_around_faults(text, FILE, diagnostics).whole
    first = next(iter(diagnostics))
    assert first.code == "SB104"
    assert message in first.message
    assert (first.span.line, first.span.column) == (line, column)


def test_sections_around_faults_are_read() -> None:
    """Several errors are all reported, and the text between them is parsed."""
    diagnostics = Diagnostics()
    composed = compose_around_faults("a: [1\nb: 2\nc: {x: @}\nd:\n  e: 5\nf: 'g\n", FILE, diagnostics)
    assert composed.tree is not None
    assert plain_data(composed.tree) == {"b": 2, "d": {"e": 5}}
    assert [(d.span.line, d.span.column) for d in diagnostics] == [(1, 4), (3, 8), (6, 4)]


def test_lines_without_a_key_are_reported_one_by_one() -> None:
    """Each is reported once with the line to write, and the sections around them are read."""
    diagnostics = Diagnostics()
    composed = compose_around_faults(
        "version:1\nrobot:so101\nstep: a\nlinks:\n  b [rest, true]\n  d: 1\nc: 4\n", FILE, diagnostics
    )
    assert composed.tree is not None
    assert plain_data(composed.tree) == {"step": "a", "c": 4}
    assert [(d.span.line, d.help) for d in diagnostics] == [
        (2, ("write `robot: so101`",)),
        (1, ("write `version: 1`",)),
        (5, ("write `b: [rest, true]`",)),
    ]


@pytest.mark.parametrize(
    ("text", "message", "remedy"),
    [
        ("links:\n  base {rest: true}\n", "link 'base': missing colon", "write `base: {rest: true}`"),
        ("links:\n  base:{rest: true}\n", "link 'base': missing space after the colon", "write `base: {rest: true}`"),
        ("links:\n  'base {rest': 1\n", "", ""),
        ("links:\n  finger [ab]: 1\n", "", ""),
    ],
)
def test_brackets_in_keys(text: str, message: str, remedy: str) -> None:
    """``base {rest`` would be a key of YAML; quoted, and with both brackets, it is one."""
    diagnostics = Diagnostics()
    compose_around_faults(text, FILE, diagnostics)
    assert [(d.code, d.message, *d.help) for d in diagnostics] == ([("SB104", message, remedy)] if message else [])


def test_tabs_are_reported_line_by_line() -> None:
    """Each line indented by a tab is reported, and parsed as if it had spaces."""
    diagnostics = Diagnostics()
    composed = compose_around_faults("a:\n\tb: 1\n\tc: 2\nd:\n  e: 3\n", FILE, diagnostics)
    assert composed.tree is not None
    assert plain_data(composed.tree) == {"a": {"b": 1, "c": 2}, "d": {"e": 3}}
    assert [(d.code, d.span.line) for d in diagnostics] == [("SB104", 2), ("SB104", 3)]


def test_json_with_tabs_is_yaml(diagnostics: Diagnostics) -> None:
    """Within braces, tabs are blanks."""
    composed = compose_around_faults('{\n\t"a": 1\n}\n', FILE, diagnostics)
    assert composed.whole


def test_globs_without_quotes_stay_keys() -> None:
    """An unquoted glob is reported, and its rule is still checked."""
    diagnostics = Diagnostics()
    text = "parts:\n  **/M3*: {ignore: true}\n  b: {}\n  *nut v1: {mass: }\n"
    composed = compose_around_faults(text, FILE, diagnostics)
    assert composed.tree is not None
    assert list(plain_data(composed.tree)["parts"]) == ["**/M3*", "b", "*nut v1"]
    assert [(d.code, d.span.line, d.span.column, d.span.end_column) for d in diagnostics] == [
        ("SB104", 2, 3, 9),
        ("SB104", 4, 3, 10),
        ("SB110", 4, 13, 17),
    ]


def test_alias_as_a_key_needs_a_blank_and_is_no_glob(diagnostics: Diagnostics) -> None:
    """``*name : value`` is a key by alias, and no glob."""
    composed = compose_around_faults("a: &k key\n*k : 1\n", FILE, diagnostics)
    assert composed.whole


@given(text=st.text("ab:*&<-#[]{}, \n'\"!|>%@`\t?0.~", max_size=80))
def test_any_text_ends(text: str) -> None:
    """Any text gives a complete tree, or an error."""
    diagnostics = Diagnostics()
    composed = compose_around_faults(text, FILE, diagnostics)
    assert composed.whole or len(diagnostics)
    lines = text.split("\n")
    for diagnostic in diagnostics:
        assert 1 <= diagnostic.span.line <= len(lines)
        assert 1 <= diagnostic.span.column <= len(lines[diagnostic.span.line - 1]) + 1
