"""Warnings and notes are suppressed by the sidecar or `--ignore` and counted; errors are never suppressed."""

import json
import re
from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from stepbot.diagnostics import Diagnostics, Ignore, Span
from tests.parts import drawn, write_same_names, write_step
from tests.solids import box

from .conftest import Stepbot

SIDECAR = "arm2.robot.yaml"


def write_also(arm: Path, text: str) -> None:
    """Append to the sidecar."""
    with (arm / SIDECAR).open("a", encoding="utf-8") as sidecar:
        sidecar.write(text)


def with_losses(arm: Path) -> None:
    """Give a joint an armature, which SDFormat lacks: warning SB760:armature."""
    text = (arm / SIDECAR).read_text(encoding="utf-8")
    assert "friction: 0.02}" in text
    (arm / SIDECAR).write_text(text.replace("friction: 0.02}", "friction: 0.02, armature: 0.01}"), encoding="utf-8")


CONVERT = ("convert", SIDECAR, "--no-verify", "-f", "sdf")


@pytest.mark.slow
def test_ignored_by_the_sidecar_and_on_the_command_line(arm: Path, stepbot: Stepbot) -> None:
    """Ignored findings are omitted, counted on the screen and in the report, and accepted by `--strict`."""
    with_losses(arm)
    assert "warning[SB760:armature]" in stepbot(*CONVERT).err
    run = stepbot(*CONVERT, "--ignore", "sb703,SB505")
    assert "SB760:armature" not in run.err
    assert ", 2 ignored" in run.err
    write_also(arm, "ignore_findings: [SB505, {code: 'SB760:armature', reason: simulated elsewhere}]\n")
    run = stepbot(*CONVERT, "--strict")
    assert run.code == 0, run.err
    assert "SB760:armature" not in run.err
    report = json.loads((arm / "arm2" / "report.json").read_text(encoding="utf-8"))
    assert report["summary"]["ignored"] == {"SB505": 1, "SB760:armature": 1}
    assert {one["code"] for one in report["diagnostics"]}.isdisjoint({"SB505", "SB760:armature"})


@pytest.mark.slow
def test_results_in_the_cache_know_what_was_ignored(
    arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ignored codes are part of the cache key, and their counts are cached."""
    monkeypatch.setenv("STEPBOT_NO_CACHE", "")
    monkeypatch.setenv("STEPBOT_CACHE", str(arm.parent / "kept"))
    check = ("check", "--step", SIDECAR, "-v")
    first, ignoring = stepbot(*check), stepbot(*check, "--ignore", "SB505")
    assert "note[SB505]" in first.out
    assert "1 ignored" in ignoring.out
    assert "SB505" not in ignoring.out
    assert stepbot(*check).out == first.out
    assert stepbot(*check, "--ignore", "SB505").out == ignoring.out


@pytest.mark.parametrize(("code", "message"), [("SB450", "SB450 is an error"), ("SB50", "unknown code 'SB50'")])
def test_errors_cannot_be_ignored(arm: Path, stepbot: Stepbot, code: str, message: str) -> None:
    """The code of an error, or an unknown code, is an error in the sidecar and a usage error in `--ignore`."""
    run = stepbot("check", SIDECAR, "--ignore", code)
    assert run.code == 2
    assert message in run.err
    write_also(arm, f"ignore_findings: [SB505, {{code: {code}}}]\n")
    run = stepbot("check", SIDECAR)
    assert run.code == 1
    line = len((arm / SIDECAR).read_text(encoding="utf-8").splitlines())
    assert f"{SIDECAR}:{line}:33: error[SB141]: ignore_findings: {message}" in run.out
    assert "= help: " in run.out


def test_unused_entries_are_reported(arm: Path, stepbot: Stepbot) -> None:
    """An entry that ignores nothing is a note at its line if all related checks ran."""
    write_also(arm, "ignore_findings: [SB305, SB139, SB810]\n")
    only_text = stepbot("check", "--concise", SIDECAR).out
    assert only_text.count("note[SB142]") == 1
    assert "unused ignore of SB139" in only_text
    built = stepbot("check", "--concise", "--step", SIDECAR).out
    assert built.count("note[SB142]") == 2
    assert "unused ignore of SB305" in built


def test_entry_of_a_joint_holds_for_that_joint(arm: Path, stepbot: Stepbot) -> None:
    """An entry of a joint ignores the warning for that joint only."""
    text = (arm / SIDECAR).read_text(encoding="utf-8")
    text, changed = re.subn(r"(lower: -\d+ deg, upper: \d+) deg", r"\1", text, count=2)
    assert changed == 2
    text = text.replace("\n  shoulder:\n    type", "\n  shoulder:\n    ignore_findings: [SB139]\n    type", 1)
    (arm / SIDECAR).write_text(text, encoding="utf-8")
    run = stepbot("check", "--concise", SIDECAR)
    assert run.out.count("warning[SB139]") == 1
    assert "warning[SB139]: joint 'elbow'" in run.out


@pytest.mark.parametrize(
    ("rule", "message", "line", "notes", "covered"),
    [
        ({}, "anything", 1, ("sum",), True),
        ({"subject": "link 'a'", "first_line": 3, "last_line": 5}, "link 'a': light", 9, (), True),
        ({"subject": "link 'a'", "first_line": 3, "last_line": 5}, "link 'ab': light", 9, (), False),
        ({"subject": "link 'a'", "first_line": 3, "last_line": 5}, "path", 4, (), True),
        ({"subject": "link 'a'", "first_line": 3, "last_line": 5}, "3 paths", 4, ("line 4", "line 9"), False),
        ({"subject": "parts rule '**/M3*'", "pattern": "**/M3*"}, "'arm/M3x8:1': open", 0, (), True),
        ({"subject": "parts rule '**/M3*'", "pattern": "**/M3*"}, "'arm/M4x8:1': open", 0, (), False),
        ({"subject": "parts rule 'cover'", "pattern": "cover"}, "'arm/cover': open", 0, (), True),
        ({"subject": "parts rule 'cover'", "pattern": "cover"}, "'arm/cover' and 3 more: open", 0, (), False),
    ],
)
def test_what_an_entry_covers(
    rule: dict[str, object], message: str, line: int, notes: tuple[str, ...], covered: bool
) -> None:
    """An entry covers diagnostics about its subject or at its lines; only a top-level entry covers summaries."""
    diagnostics = Diagnostics()
    diagnostics.ignore([Ignore("SB602", Span("a.yaml", 4, 3), **rule)])  # type: ignore[arg-type]
    diagnostics.add("SB602", message, Span("a.yaml", line), notes=notes)
    assert len(diagnostics.ignored) == covered
    assert len(diagnostics) + len(diagnostics.ignored) == 1
    assert bool(diagnostics.unused_ignores) != covered
    diagnostics.ignore([Ignore("SB602", Span("stepbot"))])
    assert len(diagnostics.ignored) == 1, "also of what was found before"


NUMBERED = """version: 1
robot: row
step: robot.step
defaults: {density: 1000}
links:
  base: {rest: true}
  pin:
    parts: ['pin#2']
    ignore_findings: [SB305]
  other: {parts: ['pin#3']}
joints:
  weld: {type: fixed, parent: base, child: pin, origin: {xyz: [0, 0, 0]}}
  glue: {type: fixed, parent: base, child: other, origin: {xyz: [0, 0, 0]}}
"""


@pytest.mark.slow
def test_entry_of_a_link_takes_its_path_out_of_a_summary(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot
) -> None:
    """An entry of a link removes its paths from the summary SB305."""
    monkeypatch.chdir(tmp_path)
    write_same_names(Path("robot.step"))
    Path(SIDECAR).write_text(NUMBERED, encoding="utf-8")
    run = stepbot("check", "--step", "-v", SIDECAR)
    assert run.out.count("warning[SB305]") == 1
    assert f"{SIDECAR}:10:19: warning[SB305]: robot.step: one path depends on the order of siblings (#n)" in run.out
    assert "pin#2" not in run.out.split("warning[SB305]")[1].split("\n\n")[0]
    assert "1 ignored" in run.out
    Path(SIDECAR).write_text(NUMBERED.replace("    ignore_findings: [SB305]\n", ""), encoding="utf-8")
    assert "2 paths depend on the order of siblings (#n)" in stepbot("check", "--step", SIDECAR).out


@pytest.mark.slow
def test_entry_of_a_link_holds_for_its_overlapping_solids(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot
) -> None:
    """An entry of a link ignores SB512 for that link only."""
    monkeypatch.chdir(tmp_path)
    blocks = [drawn(name, box(40, 10, 10)) for name in "abcd"]
    places = [(20.0 * i, 0.0, 0.0) for i in range(2)] + [(20.0 * i, 50.0, 0.0) for i in range(2)]
    children = [Occurrence(block, f"{block.name}:1", pose(at)) for block, at in zip(blocks, places, strict=True)]
    write_step(Path("robot.step"), Assembly("row", children))
    text = NUMBERED[: NUMBERED.index("links:")] + (
        "links:\n  base: {parts: [a, b], ignore_findings: [SB512]}\n  lid: {parts: [c, d]}\n"
        "joints:\n  weld: {type: fixed, parent: base, child: lid, origin: {xyz: [0, 0, 0]}}\n"
    )
    Path(SIDECAR).write_text(text, encoding="utf-8")
    run = stepbot("check", "--step", SIDECAR)
    assert run.out.count("warning[SB512]") == 1
    assert "warning[SB512]: link 'lid'" in run.out
    assert "1 ignored" in run.out


@pytest.mark.parametrize(
    ("rule", "ignored"),
    [
        ("SB760", {"SB760:armature", "SB760:spring", "SB760:imu"}),
        ("SB760:spring", {"SB760:spring"}),
        ("SB703", {"SB760:armature", "SB760:spring"}),
        ("SB715", {"SB763:mimic"}),
    ],
)
def test_a_rule_selects_a_feature_or_what_a_code_of_an_earlier_version_stood_for(rule: str, ignored: set[str]) -> None:
    """A code alone covers all its features, with a feature this one, an earlier version's what took its place."""
    diagnostics = Diagnostics()
    for code in ("SB760:armature", "SB760:spring", "SB760:imu", "SB763:mimic", "SB763:mimic-chain"):
        diagnostics.add(code, "URDF: left out", Span("arm.urdf"))
    diagnostics.ignore([Ignore(rule, Span("arm.robot.yaml", 3))])
    assert {one.code for one in diagnostics.ignored} == ignored
    assert not diagnostics.unused_ignores


def test_codes_with_features_are_accepted_and_explained(arm: Path, stepbot: Stepbot) -> None:
    """Features and codes of earlier versions work in `--ignore`, a sidecar and `explain`; unknown features do not."""
    with_losses(arm)
    write_also(arm, "ignore_findings: [SB505, SB703]\n")
    assert stepbot(*CONVERT, "--strict").code == 0
    assert "SB760:armature" in stepbot("explain", "703").out
    assert "feature not written" in stepbot("explain", "sb760:Armature").out
    run = stepbot(*CONVERT, "--ignore", "SB760:armatur")
    assert run.code == 2
    assert "unknown code 'SB760:armatur'" in run.err
