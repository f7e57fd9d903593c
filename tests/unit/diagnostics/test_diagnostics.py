"""Diagnostics: order, severities, exit codes, near matches."""

import pytest

from stepbot.diagnostics import Diagnostic, Diagnostics, Span, StepbotError, did_you_mean
from stepbot.diagnostics.codes import CODES

WARNING = next(code.id for code in CODES.values() if code.severity == "warning")
ERROR = next(code.id for code in CODES.values() if code.severity == "error" and not code.could_not_run)
COULD_NOT_RUN = next(code.id for code in CODES.values() if code.could_not_run)


def test_place_is_clickable() -> None:
    """A place is printed as `file:line:column`."""
    assert str(Span("arm.robot.yaml", 14, 7)) == "arm.robot.yaml:14:7"
    assert str(Span("arm.xml", 14)) == "arm.xml:14"
    assert str(Span("arm.step")) == "arm.step"


def test_headline_is_complete() -> None:
    """The headline has place, severity, code and message."""
    diagnostic = Diagnostic("SB001", "error", "no such file", Span("arm.step", 3, 4))
    assert str(diagnostic) == "arm.step:3:4: error[SB001]: no such file"


def test_severity_is_the_codes(diagnostics: Diagnostics) -> None:
    """The severity of a finding is that of its code."""
    assert diagnostics.add(WARNING, "w", Span("a")).severity == "warning"
    assert diagnostics.add(ERROR, "e", Span("a")).severity == "error"
    assert [d.message for d in diagnostics] == ["w", "e"]


def test_unknown_code_is_refused(diagnostics: Diagnostics) -> None:
    """An unknown code raises an error."""
    with pytest.raises(KeyError):
        diagnostics.add("SB000", "?", Span("a"))


@pytest.mark.parametrize("code", ["", "SB", "SB000", "SB307", "SB999", "x"])
def test_unknown_codes_are_missing(code: str) -> None:
    """No code is found outside of the ranges, or in their gaps."""
    assert code not in CODES


def test_each_code_is_found() -> None:
    """A code looked up on its own is the one of the whole table, in its order."""
    assert [CODES[name] for name in CODES] == list(CODES.values())
    assert [code.id for code in CODES.values()] == list(CODES)


def test_finding_is_kept_once(diagnostics: Diagnostics) -> None:
    """A diagnostic added twice is reported once, in its first position."""
    first = diagnostics.add(WARNING, "w", Span("a"))
    diagnostics.add(WARNING, "v", Span("a"))
    assert diagnostics.extend([first]) == [first]
    assert [d.message for d in diagnostics] == ["w", "v"]
    assert len(diagnostics) == 2


@pytest.mark.parametrize(
    ("codes", "exit_code"),
    [([], 0), ([WARNING], 0), ([ERROR, WARNING], 1), ([ERROR, COULD_NOT_RUN], 2), ([COULD_NOT_RUN], 2)],
)
def test_exit_code(codes: list[str], exit_code: int) -> None:
    """The exit code is 0 for clean, 1 for findings, 2 for could not run; the worst finding decides."""
    diagnostics = Diagnostics()
    for code in codes:
        diagnostics.add(code, "m", Span("a"))
    assert diagnostics.exit_code == exit_code
    assert diagnostics.has_errors == (exit_code != 0)


def test_strict_turns_warnings_into_errors(diagnostics: Diagnostics) -> None:
    """After `make_strict` a warning is an error and ends the stage."""
    diagnostics.add(WARNING, "w", Span("a"))
    diagnostics.raise_if_errors()
    diagnostics.make_strict()
    assert [d.severity for d in diagnostics] == ["error"]
    assert diagnostics.exit_code == 1
    with pytest.raises(StepbotError, match=r"a: error\[SB\d{3}\]: w"):
        diagnostics.raise_if_errors()


def test_error_carries_all_findings(diagnostics: Diagnostics) -> None:
    """The exception at the end of a stage contains warnings, too; its text has only the errors."""
    diagnostics.add(WARNING, "harmless", Span("a"))
    diagnostics.add(ERROR, "bad", Span("a"))
    with pytest.raises(StepbotError) as raised:
        diagnostics.raise_if_errors()
    assert len(raised.value.diagnostics) == 2
    assert "bad" in str(raised.value)
    assert "harmless" not in str(raised.value)


def test_near_matches() -> None:
    """A misspelt name has its nearest candidates, without duplicates; an unrelated name has none."""
    assert did_you_mean("forarm", ["forearm", "wrist"]) == ("did you mean 'forearm'?",)
    assert did_you_mean("xyz", ["forearm", "wrist"]) == ()
    assert did_you_mean("BASE", ["base", "case"]) == ("did you mean 'base'?",)
    (two,) = did_you_mean("arm1", ["arm2", "arm2", "arm3"])
    assert two.count("arm2") == two.count("arm3") == 1
