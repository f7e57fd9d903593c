"""The amount of output: one screen by default, everything with -v, findings only with -q."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostic, Span
from stepbot_cli import diagnostic_text
from stepbot_cli.columns import cells
from stepbot_cli.terminal import Display, show_diagnostics, write_verdict

from .conftest import Stepbot


def finding(severity: str, code: str, number: int) -> Diagnostic:
    """One of several findings of a code."""
    kind = {"error": "error", "warning": "warning", "note": "note"}[severity]
    return Diagnostic(code, kind, f"subject {number}: wrong", Span("arm.yaml"), notes=("why",))  # type: ignore[arg-type]


def of_its_own(one: Diagnostic) -> Diagnostic:
    """A finding with other words than those on other lines."""
    number = int(one.message.removeprefix("subject ")[0])
    return one._replace(message=f"subject {'abcdefghij'[number]}: wrong")


def test_notes_are_counted() -> None:
    """Notes are one number in the default output; -v prints all."""
    text = diagnostic_text.screen([finding("note", "SB762:initial-pose", 1), finding("warning", "SB763:frame", 2)])
    assert "SB762:initial-pose" not in text
    assert text.endswith("\n1 warning, 1 note (more: stepbot explain SB763; -v shows all)")
    assert diagnostic_text.screen([finding("note", "SB762:initial-pose", 1)]) == "1 note (-v shows all)"


def todo(name: str, line: int, limit: str) -> Diagnostic:
    """A finding about one of several joints."""
    help = (f"joint '{name}': limits: {limit}",)
    return Diagnostic("SB463", "warning", f"joint '{name}': placeholder", Span("a.yaml", line, 5), help=help)


def test_one_cause_is_one_finding() -> None:
    """Findings that differ in subject and place alone are one, with all subjects, places and remedies of their own."""
    same = [todo(name, 10 * n, "30 deg") for n, name in enumerate(("hip", "knee", "ankle", "toe"), 1)]
    other = todo("wrist", 70, "90 deg")
    text = diagnostic_text.screen([*same, other])
    assert text.count("warning[SB463]") == 1
    assert "= note: the same for 'knee' (line 20), 'ankle' (line 30), 'toe' (line 40), 'wrist' (line 70)\n" in text
    assert "= help: joint 'hip': limits: 30 deg\n" in text
    assert "= help: 'wrist' (line 70): joint 'wrist': limits: 90 deg\n" in text
    assert "'knee' (line 20): joint" not in text
    assert text.endswith("5 warnings (more: stepbot explain SB463; -v shows all)")
    elsewhere = other._replace(message="joint 'wrist': something else", span=Span("a.yaml", 70))
    assert diagnostic_text.screen([*same, elsewhere]).count("warning[SB463]") == 2


def test_one_cause_of_several_kinds_is_one_finding(capsys: pytest.CaptureFixture[str]) -> None:
    """A joint and a closure with the same error are one finding, and so is one message at several places."""
    kinds = [
        Diagnostic("SB123", "error", f"{kind} '{name}': type: invalid choice 'revolut'", Span("a.yaml", n, 5))
        for n, (kind, name) in enumerate((("joint", "hip"), ("joint", "knee"), ("closure", "pin")), 1)
    ]
    tabs = [Diagnostic("SB104", "error", "sidecar: tab in indentation", Span("a.yaml", n, 1)) for n in (7, 9)]
    text = diagnostic_text.screen([*kinds, *tabs])
    assert text.count("error[") == 2
    assert "= note: the same for 'knee' (line 2), closure 'pin' (line 3)\n" in text
    assert "= note: the same for a.yaml:9:1\n" in text
    assert diagnostic_text.full([*kinds, *tabs]).count("error[") == 5
    assert write_verdict("a: not converted", [*kinds, *tabs], Display())
    assert capsys.readouterr().out == "a: not converted, 5 errors of 2 causes\n"


def test_warnings_that_differ_in_numbers_are_one_finding() -> None:
    """The others are one line each, with their numbers; errors stay apart, and -v has all in full."""
    names = ("base", "arm", "hand", "jaw", "tip", "tool")
    places = [Span("a.yaml", 10 * n) for n in range(1, 7)]
    found = [
        Diagnostic("SB512", "warning", f"link '{name}': overlap: {n}.5 g of 1{n} g", at, ("cut",), (f"pair {n}",))
        for n, (name, at) in enumerate(zip(names, places, strict=True), 1)
    ]
    text = diagnostic_text.screen(found)
    assert text.count("warning[SB512]") == 1
    assert "= note: likewise link 'arm': overlap: 2.5 g of 12 g (line 20)\n" in text
    assert "= note: likewise link 'tip': overlap: 5.5 g of 15 g (line 50) and 1 more\n" in text
    assert "pair 1" in text
    assert "pair 2" not in text
    assert text.count("= help: cut") == 1
    assert text.endswith("6 warnings (more: stepbot explain SB512; -v shows all)")
    assert diagnostic_text.screen([one._replace(severity="error") for one in found]).count("error[SB512]") == 6


def test_repeated_warnings_are_counted() -> None:
    """Some warnings of a code are printed in full and the others counted; of all errors the message is printed."""
    warnings = [of_its_own(finding("warning", "SB305", number)) for number in range(5)]
    errors = [finding("error", "SB130:link", number) for number in range(9)]
    text = diagnostic_text.screen([*warnings, *errors])
    assert text.count("warning[SB305]: subject") == 3
    assert text.count("error[SB130:link]: subject") == 9
    assert text.count("= note: why") == 3 + 5
    assert text.endswith("-v shows all)")

    assert "\nwarning[SB305]: 2 more: path depends on sibling order\n" in text
    assert text.endswith("9 errors, 5 warnings (more: stepbot explain SB130; -v shows all)")


def test_long_lists_of_names_are_cut() -> None:
    """The default output has the first names of a message and the number of the others; -v has all."""
    names = ", ".join(f"'mesh {n}'" for n in range(40))
    many = Diagnostic("SB872", "warning", f"textures not converted: {names}, in OBJ", Span("a.urdf"))
    text = diagnostic_text.screen([many])
    assert "'mesh 11' and 28 more, in OBJ\n" in text
    assert text.endswith("-v shows all)")
    assert "'mesh 39'" in diagnostic_text.full([many])
    few = many._replace(message=f"textures not converted: {', '.join(names.split(', ')[:12])}")
    assert "more" not in diagnostic_text.screen([few]).splitlines()[0]


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
    found = [*(of_its_own(finding("warning", "SB504", number)) for number in range(9)), finding("note", "SB505", 1)]
    show_diagnostics(found)
    usual = capsys.readouterr().err.splitlines()
    show_diagnostics(found, Display(quiet=True))
    quiet = capsys.readouterr().err.splitlines()
    assert set(quiet) < set(usual)
    assert any(line.startswith("warning[SB504]: ") and " more" in line for line in quiet)
    assert not any("SB505" in line for line in quiet)


@pytest.mark.slow
@pytest.mark.parametrize("width", ["60", "80", "120"])
def test_success_is_one_screen(arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch, width: str) -> None:
    """A successful conversion of a small arm is a few lines, at any width, and ends with the command that shows it."""
    monkeypatch.setenv("COLUMNS", width)
    monkeypatch.setenv("STEPBOT_NO_CACHE", "")
    monkeypatch.setenv("STEPBOT_CACHE", str(arm.parent / "kept"))
    run = stepbot("convert", "arm2.robot.yaml", "-f", "urdf,mjcf")
    assert run.code == 0
    lines = (run.err + run.out).splitlines()
    assert len(lines) <= 12
    assert max(map(cells, lines)) <= int(width)
    text = run.out.replace("\n    ", " ")
    assert text.startswith(
        "arm2: 5 links, 4 joints, 3 degrees of freedom, 2.19 kg\nproven: URDF and MJCF match the CAD in "
    )
    assert text.endswith("see it: stepbot view arm2\n")


def test_verbose_and_quiet(arm: Path, stepbot: Stepbot) -> None:
    """-v prints every note, -q prints nothing on success; together they are a usage error."""
    command = ("convert", "arm2.robot.yaml", "--no-verify", "-f", "urdf,sdf")
    usual, verbose = stepbot(*command), stepbot(*command, "-v")
    assert "note[" not in usual.err
    assert verbose.err.count("note[SB762:initial-pose]: ") == 2
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
