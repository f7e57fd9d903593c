"""The amount of output: one screen by default, everything with -v, findings only with -q."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostic, Span
from stepbot.report.record import Check, Report, Status
from stepbot.report.summarizing import proof_of
from stepbot_cli import diagnostic_text
from stepbot_cli.columns import cells
from stepbot_cli.proof import proof_lines
from stepbot_cli.terminal import Display, show_diagnostics

from .conftest import Stepbot

LOADED = Check("a.urdf", "urdf", "mujoco", "load", Status.PASSED)
MASS = Check("a.urdf", "urdf", "mujoco", "mass", Status.PASSED, 2.5e-16, 1e-9, "kg", "link 'arm'")
MESHES = Check("a.urdf", "urdf", "pybullet", "meshes", Status.PASSED, 3.4e-6, 2e-5, "m", "link 'arm'")
NOT_TOLD = Check("a.urdf", "urdf", "yourdfpy", "meshes", Status.NOT_RUN, why="yourdfpy does not report it")
OWN = Check("a.sdf", "sdf", "reader", "mass", Status.PASSED, 1e-16, 1e-9, "kg")
FAILED = Check("a.sdf", "sdf", "pybullet", "mass", Status.FAILED, 0.5, 1e-9, "kg", why="0.5 kg too heavy")
NEVER = Check("a.xml", "mjcf", "drake", "mass", Status.NOT_RUN, why="drake is not installed")


def lines_of(report: Report, width: int | None, *, color: bool = False) -> list[str]:
    """The verification results on a screen; Drake need not be installed."""
    return proof_lines(proof_of(report, ["drake"]), width, color=color)


def test_one_line_per_file() -> None:
    """A line has the engines that compared the file, the worst deviation and the result; one failure fails the file."""
    lines = lines_of(Report(checks=(LOADED, MASS, MESHES, NOT_TOLD, OWN, FAILED, NEVER), own_parsers=("reader",)), None)
    assert [line.split(maxsplit=3) for line in lines[:4]] == [
        ["format", "file", "result", "engines           worst deviation"],
        ["urdf", "a.urdf", "passed", "mujoco, pybullet  meshes: 3.4e-06 of 2e-05 m"],
        ["sdf", "a.sdf", "failed", "reader, pybullet  mass: 5.0e-01 of 1e-09 kg"],
        ["mjcf", "a.xml", "not", "run  -                 -"],
    ]
    counts = "7 checks: 4 passed (1 by stepbot's parsers only), 1 failed, 2 not run (-v for reasons)"
    assert lines[4:] == [f"{counts}; not installed: drake"]


@pytest.mark.parametrize("width", [60, 80, 120])
def test_proof_fits_the_screen(width: int) -> None:
    """No line is wider than the screen."""
    checks = [Check("机器人.urdf", "urdf", f"engine {n}", "mass", Status.PASSED, 1e-9, 1e-3, "kg") for n in range(9)]
    assert max(map(cells, lines_of(Report(checks=tuple(checks)), width))) <= width


def test_colour_is_the_results() -> None:
    """Colours do not change the text, even if a file is named like a result."""
    report = Report(checks=(Check("passed", "urdf", "mujoco", "mass", Status.PASSED), FAILED))
    coloured = lines_of(report, 80, color=True)
    assert "passed  \x1b[32mpassed\x1b[0m" in coloured[1]
    plain = "\n".join(coloured)
    for code in ("1;31", "32", "1", "0"):
        plain = plain.replace(f"\x1b[{code}m", "")
    assert plain.splitlines() == lines_of(report, 80)


def finding(severity: str, code: str, number: int) -> Diagnostic:
    """One of several findings of a code."""
    kind = {"error": "error", "warning": "warning", "note": "note"}[severity]
    return Diagnostic(code, kind, f"subject {number}: wrong", Span("arm.yaml"), notes=("why",))  # type: ignore[arg-type]


def test_repeated_notes_are_one_line() -> None:
    """Notes of a code are one line with their count; a single note is its message; -v prints all."""
    text = diagnostic_text.screen(
        [finding("note", "SB706", 1), finding("note", "SB708", 2), finding("note", "SB706", 3)]
    )
    title = "initial pose not written"
    assert text == f"note[SB706]: 2 x {title}\nnote[SB708]: subject 2: wrong\n3 notes (-v shows all)"


def test_repeated_warnings_are_counted() -> None:
    """Some warnings of a code are printed in full and the others counted; of all errors the message is printed."""
    warnings = [finding("warning", "SB305", number) for number in range(5)]
    errors = [finding("error", "SB130", number) for number in range(9)]
    text = diagnostic_text.screen([*warnings, *errors])
    assert [f"subject {n}: wrong" in text for n in range(5)].count(True) == 5
    assert text.count("warning[SB305]: subject") == 3
    assert text.count("error[SB130]: subject") == 9
    assert text.count("= note: why") == 3 + 5
    assert text.endswith("-v shows all)")

    assert "\nwarning[SB305]: 2 more: path depends on sibling order\n" in text
    assert text.endswith("9 errors, 5 warnings (more: stepbot explain SB130; -v shows all)")


def test_long_lists_of_notes_are_cut() -> None:
    """The default output has the first notes of a finding; -v has all."""
    many = finding("warning", "SB512", 1)._replace(notes=tuple(f"pair {number}" for number in range(9)))
    text = diagnostic_text.screen([many])
    assert "pair 5" in text
    assert "pair 6" not in text
    assert "= note: 3 more notes" in text
    assert text.endswith("-v shows all)")
    assert "pair 8" in diagnostic_text.full([many])


def test_quiet_folds_as_the_default_does(capsys: pytest.CaptureFixture[str]) -> None:
    """With -q there is never more than without it: notes and counts are left out, and warnings stay folded."""
    found = [*(finding("warning", "SB504", number) for number in range(9)), finding("note", "SB505", 1)]
    show_diagnostics(found)
    usual = capsys.readouterr().err.splitlines()
    show_diagnostics(found, Display(quiet=True))
    quiet = capsys.readouterr().err.splitlines()
    assert set(quiet) < set(usual)
    assert any(line.startswith("warning[SB504]: ") and " more" in line for line in quiet)
    assert not any("SB505" in line for line in quiet)


def test_folded_notes_are_cut_at_the_screen() -> None:
    """A line of folded notes is cut to the screen, and whole in a pipe."""
    long = Diagnostic("SB708", "note", "x" * 300, Span("a"))
    assert cells(diagnostic_text.screen([long], width=60).splitlines()[0]) == 60
    assert "x" * 300 in diagnostic_text.screen([long])


@pytest.mark.parametrize("width", ["60", "80", "120"])
def test_success_is_one_screen(arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch, width: str) -> None:
    """A successful conversion of a small arm prints at most 50 lines, at any width."""
    monkeypatch.setenv("COLUMNS", width)
    monkeypatch.setenv("STEPBOT_NO_CACHE", "")
    monkeypatch.setenv("STEPBOT_CACHE", str(arm.parent / "kept"))
    run = stepbot("convert", "arm2.robot.yaml", "-f", "urdf,mjcf")
    assert run.code == 0
    lines = (run.err + run.out).splitlines()
    assert len(lines) <= 50
    assert max(map(cells, lines)) <= int(width)
    assert " not run (-v for reasons)" in run.out.replace("\n    ", " ")


def test_verbose_and_quiet(arm: Path, stepbot: Stepbot) -> None:
    """-v prints every note, -q prints nothing on success; together they are a usage error."""
    command = ("convert", "arm2.robot.yaml", "--no-verify", "-f", "urdf,sdf")
    usual, verbose = stepbot(*command), stepbot(*command, "-v")
    assert "note[SB706]: 2 x initial pose" in usual.err
    assert verbose.err.count("note[SB706]: ") == 2
    assert "= note: base/column: exact:" in verbose.err
    assert "= note:" not in usual.err
    quiet = stepbot(*command, "-q")
    assert (quiet.code, quiet.out, quiet.err) == (0, "", "")
    assert stepbot(*command, "-q", "-v").code == 2
    sidecar = arm / "arm2.robot.yaml"
    sidecar.write_text(sidecar.read_text(encoding="utf-8").replace("[forearm]", "[forarm]"), encoding="utf-8")
    quiet = stepbot(*command, "-q")
    assert quiet.code == 1
    assert "error[SB301]" in quiet.err
    assert "did you mean" in quiet.err
