"""Colours and progress are for terminals only."""

import io
import json
import re
import sys

import pytest

from stepbot.diagnostics import Diagnostics, Span
from stepbot_cli.progress import progress_bar
from stepbot_cli.terminal import Display, show_diagnostics_of_use, wants_color, write_json


class Terminal(io.StringIO):
    """A stream that is a terminal."""

    encoding = "utf-8"

    def isatty(self) -> bool:
        """Return True."""
        return True


@pytest.fixture(autouse=True)
def _plain_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("NO_COLOR", "FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")


def test_color_on_a_terminal_only() -> None:
    """A pipe gets no escape sequences."""
    assert wants_color(Terminal())
    assert not wants_color(io.StringIO())


def test_no_color_is_obeyed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A non-empty NO_COLOR or a dumb terminal switches colours off."""
    monkeypatch.setenv("NO_COLOR", "")
    assert wants_color(Terminal())
    monkeypatch.setenv("NO_COLOR", "1")
    assert not wants_color(Terminal())
    monkeypatch.delenv("NO_COLOR")
    monkeypatch.setenv("TERM", "dumb")
    assert not wants_color(Terminal())


def test_commands_that_use_a_robot_do_not_repeat_the_notes_of_check(capsys: pytest.CaptureFixture[str]) -> None:
    """Warnings, and notes about the command itself, are printed; -v prints all."""
    diagnostics = Diagnostics()
    for code in ("SB505", "SB762:initial-pose", "SB621", "SB006", "SB502"):
        diagnostics.add(code, f"about {code}", Span("arm.robot.yaml"))
    show_diagnostics_of_use(diagnostics, Display(concise=True))
    brief = capsys.readouterr().err
    assert re.findall(r"SB\d{3}(?=\])", brief) == ["SB621", "SB006", "SB502"]
    show_diagnostics_of_use(diagnostics, Display(verbose=True))
    full = capsys.readouterr().err
    assert "SB505" in full
    assert "SB762:initial-pose" in full


def test_progress_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """A terminal shows the current stage."""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress_bar() as progress:
        progress("read")
        progress("verify")
    assert "verifying in the engines" in terminal.getvalue()


def test_bar_without_color_is_not_blank(monkeypatch: pytest.MonkeyPatch) -> None:
    """With NO_COLOR the progress bar distinguishes done and remaining by characters."""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("NO_COLOR", "1")
    with progress_bar() as progress:
        progress("read")
        progress("verify")
    assert "############........" in terminal.getvalue()


def test_no_progress_in_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pipe gets no progress."""
    pipe = io.StringIO()
    monkeypatch.setattr(sys, "stderr", pipe)
    with progress_bar() as progress:
        progress("read")
    assert pipe.getvalue() == ""


def test_json_cannot_steer_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    """Control and bidi characters in names are escaped in JSON and can be read back."""
    name = "a\x1b[31m\x9b2J\x7f\u202eb\U000e0001 Ж"
    write_json({"name": name})
    out = capsys.readouterr().out
    assert "".join(c for c in out if not c.isprintable()) == "\n\n\n"
    assert json.loads(out) == {"name": name}
    assert "Ж" in out
