"""The text and JSON form of a diagnostic."""

import json
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostic, Span
from stepbot.diagnostics.codes import CODES
from stepbot_cli import diagnostic_text
from stepbot_cli.columns import cells

SOURCE = "version: 1\nlinks:\n  base: {}\njoints:\n  elbow:\n    child: forarm\n"


@pytest.fixture
def sidecar(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A sidecar in the current folder."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "arm.robot.yaml"
    file.write_text(SOURCE, encoding="utf-8")
    return file


def diagnostic(span: Span, **texts: tuple[str, ...]) -> Diagnostic:
    """An error with a place."""
    return Diagnostic("SB301", "error", "joint 'elbow': no component 'forarm' in arm.step", span, **texts)


def warning(span: Span) -> Diagnostic:
    """A warning without help, which ends with its code frame."""
    return diagnostic(span)._replace(severity="warning")


@pytest.mark.usefixtures("sidecar")
def test_full_shows_the_line_and_the_remedy() -> None:
    """The code frame marks the place; notes and help are below it."""
    found = diagnostic(Span("arm.robot.yaml", 6, 12, 18), help=("did you mean 'forearm'?",), notes=("one\ntwo",))
    assert diagnostic_text.full([found]).splitlines() == [
        "arm.robot.yaml:6:12: error[SB301]: joint 'elbow': no component 'forarm' in arm.step",
        "  |",
        "6 |     child: forarm",
        "  |            ^^^^^^",
        "  = note: one",
        "          two",
        "  = help: did you mean 'forearm'?",
    ]


def test_error_without_help_shows_the_advice_of_its_code() -> None:
    """Every error has a remedy, in text and JSON; warnings and notes may lack one."""
    bare, fix = diagnostic(Span("arm.robot.yaml")), CODES["SB301"].fix
    assert diagnostic_text.full([bare]).splitlines()[1:] == [f"  = help: {fix}"]
    assert diagnostic_text.plain(bare)["help"] == [fix]
    assert diagnostic_text.full([warning(Span("arm.robot.yaml"))]).count("\n") == 0


@pytest.mark.usefixtures("sidecar")
def test_mark_without_extent_is_one_character() -> None:
    """Without an end, one mark shows the start."""
    assert diagnostic_text.full([warning(Span("arm.robot.yaml", 6, 12))]).splitlines()[-1] == "  |            ^"


@pytest.mark.usefixtures("sidecar")
def test_place_beyond_the_file_has_no_frame() -> None:
    """A line beyond the end of the file has no frame; a column beyond the end of a line stays on that line."""
    assert len(diagnostic_text.full([warning(Span("arm.robot.yaml", 99, 1))]).splitlines()) == 1
    assert diagnostic_text.full([warning(Span("arm.robot.yaml", 6, 18))]).splitlines()[-1] == "  |" + " " * 18 + "^"


def test_file_that_is_gone_has_no_frame() -> None:
    """If the file cannot be read, only the headline is printed."""
    assert diagnostic_text.full([warning(Span("gone.yaml", 6, 12))]) == diagnostic_text.concise(
        [warning(Span("gone.yaml", 6, 12))]
    )


def test_wide_characters_keep_the_mark_in_place(tmp_path: Path) -> None:
    """The mark below Chinese names is as wide as the names."""
    file = tmp_path / "a.yaml"
    file.write_text("\ufeff机器人: 手臂 x\n", encoding="utf-8")
    line, mark = diagnostic_text.full([warning(Span(str(file), 1, 6, 8))]).splitlines()[-2:]
    assert line == "1 | 机器人: 手臂 x"
    assert mark == "  |" + " " * (1 + 8) + "^^^^"


def test_long_line_is_cut_around_the_place(tmp_path: Path) -> None:
    """Of a line of a megabyte, only the part around the place is shown."""
    file = tmp_path / "a.yaml"
    file.write_text("x" * 500_000 + "HERE" + "y" * 500_000, encoding="utf-8")
    line, mark = diagnostic_text.full([warning(Span(str(file), 1, 500_001, 500_005))]).splitlines()[-2:]
    assert len(line) < 140
    start = mark.index("^")
    assert line[start : start + 4] == "HERE"
    assert mark[start:] == "^^^^"


@pytest.mark.parametrize("width", [60, 80, 120])
@pytest.mark.parametrize("line", ["x" * 40 + "HERE" + "y" * 200, "手" * 70 + "HERE" + "臂" * 70, "HERE" + "z" * 90])
def test_frame_fits_the_screen(tmp_path: Path, line: str, width: int) -> None:
    """No line of a frame exceeds the screen, and the mark is below its place, with wide characters too."""
    file = tmp_path / "a.yaml"
    file.write_text(line, encoding="utf-8")
    column = line.index("HERE") + 1
    frame = diagnostic_text.full([warning(Span(str(file), 1, column, column + 4))], width=width).splitlines()[1:]
    assert max(map(cells, frame)) <= width
    shown, mark = frame[1:3]
    assert cells(shown.partition("HERE")[0]) == cells(mark.partition("^")[0])
    assert mark.strip(" |") == "^^^^"


@pytest.mark.parametrize(
    "content", [b"PK\x03\x04\x14\x00\x08\x08arm.step", bytes(range(128, 256)), "манипулятор".encode("cp1251")]
)
def test_binary_content_has_no_frame(tmp_path: Path, content: bytes) -> None:
    """Binary content, or text in another encoding, is not printed; the headline has the position."""
    file = tmp_path / "a.yaml"
    file.write_bytes(content)
    assert len(diagnostic_text.full([warning(Span(str(file), 1, 1))]).splitlines()) == 1


def test_footer_explains_the_first_error() -> None:
    """The footer names the code of the first error, else of the first warning, never of a note."""
    found = [Diagnostic(c, s, "m", Span("a")) for c, s in (("SB505", "note"), ("SB305", "warning"), ("SB450", "error"))]
    assert diagnostic_text.summary(found) == "1 error, 1 warning, 1 note (more: stepbot explain SB450)"
    assert diagnostic_text.summary(found[:2]) == "1 warning, 1 note (more: stepbot explain SB305)"
    assert diagnostic_text.summary(found[:1]) == "1 note"


def test_names_cannot_steer_the_terminal(tmp_path: Path) -> None:
    """Escape sequences in names and source lines are printed as text."""
    file = tmp_path / "a.yaml"
    file.write_text("a: \x1b[2Jb\n", encoding="utf-8")
    text = diagnostic_text.full(
        [Diagnostic("SB301", "error", "no '\x1b[31mred'", Span(str(file), 1, 1), help=("\x07",))]
    )
    assert "\x1b" not in text
    assert "\x07" not in text
    assert r"\x1b[31mred" in text


def test_color_only_when_asked_for() -> None:
    """Colours surround the text without changing it."""
    found = [diagnostic(Span("gone.yaml", 6, 12), help=("h",))]
    colored = diagnostic_text.full(found, color=True)
    assert "\x1b[1;31merror[SB301]\x1b[0m" in colored
    assert "\x1b" not in diagnostic_text.full(found)


def test_concise_is_one_line_each() -> None:
    """The concise form has one line per finding."""
    found = [diagnostic(Span("a.yaml", 1, 2), help=("h",)), diagnostic(Span("b.yaml"))]
    assert [line.split(": ")[0] for line in diagnostic_text.concise(found).splitlines()] == ["a.yaml:1:2", "b.yaml"]


def test_plain_is_json() -> None:
    """The JSON form is complete and can be read back."""
    plain = diagnostic_text.plain(diagnostic(Span("a.yaml", 1, 2, 3), help=("h",), notes=("n",)))
    assert (
        json.loads(json.dumps(plain))
        == plain
        == {
            "code": "SB301",
            "severity": "error",
            "message": "joint 'elbow': no component 'forarm' in arm.step",
            "file": "a.yaml",
            "line": 1,
            "column": 2,
            "end_column": 3,
            "help": ["h"],
            "notes": ["n"],
        }
    )


def test_summary_counts_and_leads_on() -> None:
    """The summary counts findings by severity and names the command that explains them."""
    error, note = diagnostic(Span("a")), Diagnostic("SB102", "note", "n", Span("a"))
    assert diagnostic_text.summary([error, error, note]) == "2 errors, 1 note (more: stepbot explain SB301)"
    assert diagnostic_text.summary([note]) == "1 note"
