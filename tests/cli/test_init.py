"""``stepbot init``: the drafted sidecar, its summary, and overwriting."""

import json
from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence, Part, write_step
from stepbot import draft as draft_in_python
from stepbot.draft.draft import Confidence, Draft, DraftLink
from stepbot.draft.text.sidecar_text import sidecar_text
from stepbot.pipeline.conversion import Options
from stepbot.serving.decisions import decisions
from stepbot.serving.editor import Editor
from stepbot.serving.local_server import Refused
from stepbot_cli.init import draft_document
from tests import parts
from tests.separate_files import write_separately
from tests.solids import box, cylinder
from tests.unit.step.exchange.test_mechanisms import add_mechanism

from .conftest import Stepbot

LIBRARY = Path(__file__).parents[2] / "robot_library"


@pytest.fixture
def slider(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a STEP file of a slider that states its kinematic pair."""
    parts.write_slider(tmp_path / "slider.step")
    add_mechanism(tmp_path / "slider.step")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def chain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a base, an arm on its pin and a hand on the arm's pin: two joints without a motor."""
    pin = cylinder(10, 20).at(0, 0, 10)
    bar = box(180, 40, 20).at(60, 0, 0)
    bored = bar - cylinder(10.02, 20).at(0, 0, -10)
    shapes = {"base": bar + pin.at(120, 0, 0), "arm": bored + pin.at(120, 0, 0), "hand": bored}
    groups = [Assembly(name, [Occurrence(Part(f"{name} bar", solid.shape))]) for name, solid in shapes.items()]
    placed = [Occurrence(group, X_AP=pose((120 * n, 0, 20 * n))) for n, group in enumerate(groups)]
    write_step(tmp_path / "chain.step", Assembly("chain", placed))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_draft_passes_the_check_and_converts(slider: Path, stepbot: Stepbot) -> None:
    """A pair in the STEP becomes a joint; the sidecar passes `check --step` and converts unchanged."""
    run = stepbot("init", "slider.step")
    assert run.code == 0, run.err
    assert run.out.startswith("slider.robot.yaml: 2 links, 1 joint; root link 'holder'; to decide: 1 REVIEW mark, ")
    assert "  on strong evidence: slide (prismatic); -v shows it\n" in run.out
    assert "stepbot check --step slider.robot.yaml" in run.out
    assert (slider / "robot-1.schema.json").read_bytes() == (stepbot("schema").out).encode()
    checked = stepbot("check", "--step", "slider.robot.yaml", "--json")
    assert checked.code == 0, checked.out
    assert stepbot("convert", "slider.robot.yaml", "--no-verify").code == 0


def test_nothing_is_overwritten_without_force(slider: Path, stepbot: Stepbot) -> None:
    """An existing sidecar is SB012 and exit code 1 without `--force`; an existing schema is never overwritten."""
    sidecar, schema = slider / "slider.robot.yaml", slider / "robot-1.schema.json"
    for mine in (sidecar, schema):
        mine.write_text("mine", encoding="utf-8")
    run = stepbot("init", "slider.step")
    assert run.code == 1
    assert "error[SB012]" in run.err
    assert sidecar.read_text(encoding="utf-8") == "mine"
    assert stepbot("init", "slider.step", "--force").code == 0
    assert sidecar.read_text(encoding="utf-8").startswith("# yaml-language-server")
    assert schema.read_text(encoding="utf-8") == "mine"


@pytest.mark.slow
def test_sidecar_elsewhere_names_the_step_from_there(slider: Path, stepbot: Stepbot) -> None:
    """`-o` creates its folder and writes `step` relative to it; the bytes are deterministic."""
    for name in ("first", "second"):
        assert stepbot("init", "slider.step", "-o", f"{name}/a.robot.yaml").code == 0
    text = (slider / "first" / "a.robot.yaml").read_bytes()
    assert b"step: ../slider.step\n" in text or b'step: "../slider.step"\n' in text
    assert text == (slider / "second" / "a.robot.yaml").read_bytes()
    assert stepbot("check", "--step", "first/a.robot.yaml").code == 0


@pytest.mark.slow
def test_joints_of_a_plain_step_are_inferred(arm: Path, stepbot: Stepbot) -> None:
    """Without stated pairs, joints are inferred from shapes with evidence: shoulder, elbow and both fingers."""
    (arm / "arm2.robot.yaml").unlink()
    run = stepbot("init", "arm2.step", "--json")
    assert run.code == 0, run.err
    document = json.loads(run.out)
    assert sorted(joint["type"] for joint in document["joints"]) == ["prismatic", "prismatic", "revolute", "revolute"]
    assert all(joint["evidence"] for joint in document["joints"])
    checked = stepbot("check", "--step", "arm2.robot.yaml", "--json")
    assert checked.code == 0, checked.out


@pytest.mark.usefixtures("slider")
def test_json_has_links_joints_and_what_is_left_to_do(stepbot: Stepbot) -> None:
    """`--json` has the draft with scores and evidence, and the number of open items."""
    run = stepbot("init", "slider.step", "--json")
    document = json.loads(run.out)
    assert (run.code, document["exit_code"], document["written"]) == (0, 0, True)
    (joint,) = document["joints"]
    assert (joint["type"], joint["parent"], joint["child"], joint["score"]) == ("prismatic", "holder", "block", 1.0)
    assert document["limits_to_fill_in"] == 1
    assert document["root"] == "holder"


def test_review_marks_are_counted_as_they_are_written() -> None:
    """Three materials without a density have one mark, and one at the placeholder."""
    base = DraftLink("base", (), Confidence(1.0), rest=True)
    draft = Draft("arm", "base", (base,), without_density=("X1", "X2", "X3", ""))
    document = draft_document(draft, sidecar_text(draft, "arm.step"))
    assert document["review"] == 2


@pytest.mark.parametrize("step", ["nowhere.step", "notes.step"])
def test_file_that_is_no_step_writes_nothing(
    step: str, tmp_path: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A missing or invalid STEP is a finding, and no sidecar is written."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "notes.step").write_text("hello", encoding="utf-8")
    run = stepbot("init", step)
    assert run.code in (1, 2)
    assert "error[SB" in run.err
    assert [path.name for path in tmp_path.iterdir()] == ["notes.step"]


def test_folder_that_cannot_be_written_is_a_finding(slider: Path, stepbot: Stepbot) -> None:
    """A file at the path of the folder is SB004."""
    (slider / "file").write_text("", encoding="utf-8")
    run = stepbot("init", "slider.step", "-o", "file/a.robot.yaml")
    assert run.code in (1, 2)
    assert "error[SB004]" in run.err


@pytest.mark.slow
def test_interactive_asks_for_the_root_link(slider: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """`--interactive` changes the root link; questions go to standard error; Enter keeps the draft."""
    import io

    monkeypatch.setattr("sys.stdin", io.StringIO("2\n"))
    run = stepbot("init", "slider.step", "--interactive", "-v")
    assert run.code == 0, run.err
    assert "Which link stands, as the root?" in run.err
    assert "  slide: prismatic, block -> holder, score 1.00\n" in run.out
    assert stepbot("check", "--step", "slider.robot.yaml").code == 0
    assert stepbot("init", "slider.step", "-i", "--json").code == 2

    monkeypatch.setattr("sys.stdin", io.StringIO("y\n"))
    run = stepbot("init", "slider.step", "--interactive", "--force", "-v")
    assert run.code == 0, run.err
    assert "'y' is not one of '1', '2'" in run.err
    assert "end of input: left as drafted" in run.err


@pytest.mark.slow
@pytest.mark.usefixtures("chain")
@pytest.mark.parametrize(
    ("answers", "motions", "joints"),
    [
        ("\n\n", 2, ["score 0.8", "score 0.8"]),  # both joints unknown: the draft as it is
        ("2\n1\n", 2, ["score 1.00"]),  # the arm is fixed, the hand turns
        ("2\n2\n", 2, []),  # all is one link
        ("1\n1\n", 2, ["score 1.00", "score 1.00"]),  # both turn
    ],
)
def test_answers_are_facts_to_infer_from(
    answers: str, motions: int, joints: list[str], stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After each answer links and joints are inferred again: parts that move as one are one link, not a fixed joint."""
    import io

    monkeypatch.setattr("sys.stdin", io.StringIO(answers))
    run = stepbot("init", "chain.step", "--interactive", "--force", "-v")
    assert run.code == 0, run.err
    assert run.err.count(", or is it fixed?") == motions
    lines = [line for line in run.out.splitlines() if "revolute, " in line]
    assert all(score in line for score, line in zip(joints, lines, strict=True)), run.out
    assert run.out.startswith(f"chain.robot.yaml: {len(joints) + 1} link")
    assert not [line for line in run.out.splitlines() if ": fixed, " in line]
    assert stepbot("check", "--step", "chain.robot.yaml").code == 0


@pytest.mark.slow
def test_answers_are_kept_for_the_next_draft(chain: Path, stepbot: Stepbot) -> None:
    """Answers of a file are in the sidecar, and `init --force` uses them again; one that does not apply is noted."""
    asked = json.loads(stepbot("init", "chain.step", "--json").out)["questions"]
    assert [one["name"] for one in asked] == ["arm bar + base bar", "arm bar + hand bar"]
    assert [one["drafted"] for one in asked] == ["revolute", "revolute"]
    answers = {"stands": "hand/hand bar", asked[0]["name"]: "fixed", "cap + lid": "revolute", asked[1]["name"]: "maybe"}
    (chain / "answers.json").write_text(json.dumps(answers))
    first = stepbot("init", "chain.step", "--force", "--answers", "answers.json", "--json")
    document = json.loads(first.out)
    assert (document["root"], len(document["joints"])) == ("hand", 1)
    assert document["answers"] == {"stands": "hand/hand bar", asked[0]["name"]: "fixed"}
    assert sorted(document["notes"]) == [
        "the answer 'maybe' to 'arm bar + hand bar' was not used: it must be one of revolute, fixed",
        "the answer 'revolute' to 'cap + lid' was not used: there is no such question",
    ]
    kept = (chain / "chain.robot.yaml").read_text(encoding="utf-8")
    again = json.loads(stepbot("init", "chain.step", "--force", "--json").out)
    assert (again["root"], again["answers"], again["notes"]) == ("hand", document["answers"], [])
    assert "  stands: hand/hand bar\n" in kept
    assert stepbot("check", "--step", "chain.robot.yaml").code == 0
    in_python = draft_in_python(chain / "chain.step", answers={asked[0]["name"]: "fixed"}).draft
    assert in_python is not None
    assert (len(in_python.joints), [one.name for one in in_python.questions]) == (1, [asked[1]["name"]])
    (chain / "answers.json").write_text("[1]")
    assert stepbot("init", "chain.step", "--force", "--answers", "answers.json").code == 2


@pytest.mark.slow
def test_the_page_asks_what_init_asks(chain: Path, stepbot: Stepbot) -> None:
    """`view --edit` lists the questions of `init --interactive`; their answers draft the same sidecar, or keep it."""
    sidecar = chain / "chain.robot.yaml"
    asked = json.loads(stepbot("init", "chain.step", "--json").out)["questions"]
    drafted = sidecar.read_text(encoding="utf-8")
    editor = Editor(sidecar, Options(output=chain), lambda shown: None)
    (listed,) = [one for one in decisions(editor.sidecar().sidecar, {}) if one["kind"] == "question"]
    assert len(asked) == len(listed["questions"]) == 2
    for one, other in zip(asked, listed["questions"], strict=True):
        assert (one["name"], one["text"], one["drafted"]) == (other["name"], other["text"], other["drafted"])
        assert {option["value"] for option in one["options"]} == {other["drafted"], *other["others"]}
    with pytest.raises(Refused, match="no such question"):
        editor.edit({"action": "answer", "name": asked[0]["name"], "value": "ball"})
    editor.edit({"action": "answer", "name": asked[0]["name"], "value": "fixed"})
    again = sidecar.read_text(encoding="utf-8")
    (chain / "answers.json").write_text(json.dumps({asked[0]["name"]: "fixed"}))
    assert stepbot("init", "chain.step", "--force", "--answers", "answers.json").code == 0
    assert sidecar.read_text(encoding="utf-8") == again != drafted
    editor.undo({})
    assert sidecar.read_text(encoding="utf-8") == drafted
    editor.edit({"action": "keep_draft"})
    kept = sidecar.read_text(encoding="utf-8")
    assert [line for line in drafted.split("\n") if line not in kept.split("\n")][:2] == [
        "# What decides most: uncomment a line with your answer and run `stepbot init --force`, or run `init -i`.",
        "# answers:",
    ]
    assert len(drafted.split("\n")) == len(kept.split("\n")) + 7
    assert not [one for one in decisions(editor.sidecar().sidecar, {}) if one["kind"] == "question"]


def test_pairs_of_a_referenced_file_are_noted(
    tmp_path: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Kinematic pairs in a file that the root file refers to are ignored, and a note names the file."""
    bar = Part("bar", box(180, 40, 20).shape)
    write_separately(tmp_path, Assembly("pair", [Occurrence(bar), Occurrence(bar, X_AP=pose((0, 0, 200)))]))
    add_mechanism(tmp_path / "bar.step")
    monkeypatch.chdir(tmp_path)
    run = stepbot("init", "pair.step")
    assert run.code == 0, run.err
    note = "'bar.step' has kinematic pairs, which were ignored: they are read from the root file only"
    assert note in " ".join((tmp_path / "pair.robot.yaml").read_text(encoding="utf-8").replace("#", "").split())


@pytest.mark.slow
def test_draft_and_check_doubt_the_same_axes(stepbot: Stepbot, tmp_path: Path) -> None:
    """Where `check` finds the faces on an axis weak, the draft has a REVIEW with the same words, whatever the score."""
    step, sidecar = LIBRARY / "stepbot_delta" / "delta.step", tmp_path / "delta.robot.yaml"
    drafted = json.loads(stepbot("init", "--json", str(step), "-o", str(sidecar)).out)
    (table,) = json.loads(stepbot("check", "--step", "--json", str(sidecar)).out)["joint_tables"].values()
    doubts = {row["name"]: row["doubt"] for row in table}
    assert {one["name"]: one["doubt"] for one in (*drafted["joints"], *drafted["closures"])} == doubts
    doubted = [joint for joint in drafted["joints"] if joint["doubt"]]
    assert doubted
    assert all(joint["review"] and joint["score"] >= 0.8 for joint in doubted)
    unwrapped = sidecar.read_text(encoding="utf-8").replace("\n  #   ", " ")
    for joint in doubted:
        assert f"  # REVIEW: weak evidence for its axis: {joint['doubt']}\n" in unwrapped


def test_joints_with_the_same_doubts_are_printed_once(chain: Path, stepbot: Stepbot) -> None:
    """The first is shown with its doubts, the others by name; -v shows each."""
    run = stepbot("init", "chain.step")
    lines = run.out.splitlines()
    first = next(n for n, line in enumerate(lines) if line.startswith("  arm_joint: revolute, base -> arm, score "))
    assert lines[first + 1].startswith("    no motor found")
    assert lines[first + 2] == "    the same: hand_joint"
    assert "hand_joint: " not in run.out
    run = stepbot("init", "chain.step", "--force", "-v")
    assert "  hand_joint: revolute, arm -> hand, score " in run.out
    assert "the same: " not in run.out
