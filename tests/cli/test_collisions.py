"""``stepbot collisions``, and the sidecar's ``self_collision`` in a conversion."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import jsonschema
import mujoco
import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from tests import parts, solids

from .conftest import Stepbot

SCHEMA = Path(__file__).parents[2] / "schemas" / "report-1.schema.json"
SIDECAR = """\
version: 1
robot: plates
step: plates.step
defaults: {density: 1000}
links:
  base: {parts: [base]}
  lower: {parts: [lower]}
  upper: {parts: [upper]}
  far: {parts: [far]}
joints:
  one: {type: continuous, parent: base, child: lower, origin: {xyz: [0, 0, 0]}, limits: {effort: 1, velocity: 1}}
  two: {type: continuous, parent: base, child: upper, origin: {xyz: [0, 0, 0]}, limits: {effort: 1, velocity: 1}}
  three: {type: continuous, parent: base, child: far, origin: {xyz: [0, 0, 0]}, limits: {effort: 1, velocity: 1}}
"""
"""Plates on a common axis: the lower and the upper one always overlap, the far one never meets them."""
DISABLED = {
    ("base", "lower", "Adjacent"),
    ("base", "upper", "Adjacent"),
    ("base", "far", "Adjacent"),
    ("lower", "upper", "Always"),
    ("lower", "far", "Never"),
    ("upper", "far", "Never"),
}


@pytest.fixture(scope="module")
def drawing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The STEP file of the plates."""
    file = tmp_path_factory.mktemp("plates") / "plates.step"
    heights = {"lower": 0, "upper": 6, "far": 50}
    pieces = [(parts.drawn("base", solids.box(10, 10, 10)), (-100, 0, 0))]
    pieces += [(parts.drawn(name, solids.box(40, 40, 8)), (0, 0, z)) for name, z in heights.items()]
    parts.write_step(file, Assembly("plates", [Occurrence(one, f"{one.name}:1", pose(at)) for one, at in pieces]))
    return file


@pytest.fixture
def plates(drawing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with the plates and a sidecar that does not request the search."""
    (tmp_path / "plates.step").write_bytes(drawing.read_bytes())
    (tmp_path / "plates.robot.yaml").write_text(SIDECAR, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def disabled(srdf: Path) -> set[tuple[str, str, str]]:
    """Pairs of an SRDF, with their reasons."""
    top = ET.parse(srdf).getroot()
    assert (top.tag, top.get("name")) == ("robot", "plates")
    pairs = top.iter("disable_collisions")
    return {(one.attrib["link1"], one.attrib["link2"], one.attrib["reason"]) for one in pairs}


def excludes(mjcf: Path) -> set[frozenset[str]]:
    """Pairs of bodies that MuJoCo reads as excluded."""
    model = mujoco.MjModel.from_xml_path(str(mjcf))
    pairs = [divmod(int(signature), 1 << 16) for signature in model.exclude_signature]
    return {frozenset((model.body(a).name, model.body(b).name)) for a, b in pairs}


def test_classes_and_srdf(stepbot: Stepbot, plates: Path) -> None:
    """The command lists classes with evidence, warns of links that always overlap, and writes the SRDF."""
    run = stepbot("collisions", "plates.robot.yaml", "--samples", "500", "--srdf", "out/plates.srdf")
    assert run.code == 0
    assert "warning[SB620]" in run.err
    assert "overlap in all 500 poses, by 2 mm as drawn" in run.err
    assert disabled(plates / "out" / "plates.srdf") == DISABLED
    rows = [" ".join(line.split()) for line in run.out.splitlines()]
    assert "always lower, upper 500 (100.00%) drawn pose, 2 mm" in rows
    assert {"never 2 pairs", "adjacent 3 pairs"} <= set(rows)


@pytest.mark.slow
def test_excluded_contacts_of_the_sidecar(stepbot: Stepbot, plates: Path) -> None:
    """A pair that somebody excludes is in MJCF and in the SRDF, without a search and with one, and not warned of."""
    assert "SB810" in stepbot("convert", "plates.robot.yaml", "-o", "plain").err
    (plates / "plates.robot.yaml").write_text(SIDECAR + "excluded_contacts: [[upper, lower]]\n", encoding="utf-8")
    run = stepbot("convert", "plates.robot.yaml", "-o", "out", "-f", "urdf,mjcf")
    assert run.code == 0, run.err
    assert "SB810" not in run.err
    assert frozenset(("lower", "upper")) in excludes(plates / "out" / "plates.xml")
    assert ("lower", "upper", "User") in disabled(plates / "out" / "plates.srdf")
    searched = stepbot("collisions", "plates.robot.yaml", "--samples", "20", "--srdf", "plates.srdf")
    assert "SB620" not in searched.err
    assert disabled(plates / "plates.srdf") >= {("lower", "upper", "Always")}


def test_strict_turns_the_warning_into_an_error(stepbot: Stepbot, plates: Path) -> None:
    """With --strict the warning ends the run with exit code 1, and no SRDF is written."""
    run = stepbot("collisions", "plates.robot.yaml", "--samples", "20", "--strict", "--srdf", "plates.srdf")
    assert run.code == 1
    assert not (plates / "plates.srdf").exists()
    ignored = stepbot("collisions", "plates.robot.yaml", "--samples", "20", "--strict", "--ignore", "SB620")
    assert ignored.code == 0


@pytest.mark.slow
def test_json(stepbot: Stepbot, plates: Path) -> None:
    """The JSON document has all pairs, valid by the schema of the report."""
    run = stepbot("collisions", "plates.robot.yaml", "--samples", "50", "--json")
    document = json.loads(run.out)
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    jsonschema.validate(document["self_collision"], {**schema, **schema["$defs"]["self_collision"], "required": []})
    assert (document["robot"], document["exit_code"]) == ("plates", 0)
    assert document["self_collision"]["samples"] == 50
    (pair,) = [pair for pair in document["self_collision"]["pairs"] if pair["class"] == "always"]
    assert pair["links"] == ["lower", "upper"]
    assert pair["depth"] == pytest.approx(2e-3, abs=1e-6)
    assert pair["pose"] == {"one": 0.0, "two": 0.0, "three": 0.0}


def test_missing_files_and_steps_are_reported(stepbot: Stepbot, plates: Path) -> None:
    """A missing file cannot run; a STEP file is no robot; a number of poses must be positive."""
    assert stepbot("collisions", "missing.robot.yaml").code == 2
    assert stepbot("collisions", "missing.urdf").code == 2
    step = stepbot("collisions", "plates.step")
    assert step.code != 0
    assert "error[" in step.err
    assert stepbot("collisions", "plates.robot.yaml", "--samples", "0").code == 2


@pytest.mark.slow
def test_conversion_excludes_and_proves(stepbot: Stepbot, plates: Path) -> None:
    """With the key, pairs that always overlap are excluded in MJCF, listed in the SRDF and the report, and proven."""
    sidecar = plates / "plates.robot.yaml"
    assert stepbot("convert", "plates.robot.yaml", "-o", "plain").code == 0
    assert frozenset(("lower", "upper")) not in excludes(plates / "plain" / "plates.xml")
    assert not (plates / "plain" / "plates.srdf").exists()

    sidecar.write_text(SIDECAR + "self_collision: {samples: 200}\n", encoding="utf-8")
    run = stepbot("convert", "plates.robot.yaml", "-o", "out", "-v")
    assert run.code == 0
    assert "SB620" in run.err
    assert "SB763:excluded-contact" in run.err
    assert "SB810" not in run.err
    assert excludes(plates / "out" / "plates.xml") - excludes(plates / "plain" / "plates.xml") == {
        frozenset(("lower", "upper"))
    }
    assert disabled(plates / "out" / "plates.srdf") == DISABLED
    report = json.loads((plates / "out" / "report.json").read_text(encoding="utf-8"))
    jsonschema.validate(report, json.loads(SCHEMA.read_text(encoding="utf-8")))
    assert report["robot"]["self_collision"]["samples"] == 200
    proven = [one for one in report["checks"] if (one["engine"], one["quantity"]) == ("mujoco", "contacts")]
    assert [one["status"] for one in proven] == ["passed"]


@pytest.mark.slow
def test_never_can_be_excluded_too(stepbot: Stepbot, plates: Path) -> None:
    """`exclude` names the classes: with `never`, MJCF excludes pairs that never meet; with none, nothing more.

    For MJX, both are excluded unless the sidecar names others, or no pair were left.
    """
    for_mjx = SIDECAR.replace("{density: 1000}", "{density: 1000, collision: {for: mjx}}")
    slides = "type: prismatic, axis: [0, 0, 1], parent: base, child: far, limits: {lower: -40 mm, upper: 0}"
    meets = f"{for_mjx[: for_mjx.index('  three:')]}  three: {{{slides}, origin: {{xyz: [0, 0, 0]}}}}\n"
    for text, exclude, pairs in (
        (SIDECAR, "[always, never]", 3),
        (SIDECAR, "[never]", 2),
        (SIDECAR, "[]", 0),
        (for_mjx, "[]", 0),
        (for_mjx, "", 1),
        (meets, "", 2),
    ):
        key = f"self_collision: {{samples: 50, exclude: {exclude}}}\n" if exclude else ""
        (plates / "plates.robot.yaml").write_text(text + key, encoding="utf-8")
        assert stepbot("convert", "plates.robot.yaml", "-o", "out", "-f", "mjcf").code == 0
        moving = {pair for pair in excludes(plates / "out" / "plates.xml") if "base" not in pair}
        assert len(moving) == pairs
    for wrong in ("{samples: 0}", "{samples: 2000000}", "{samples: many}", "{exclude: [sometimes]}"):
        (plates / "plates.robot.yaml").write_text(f"{SIDECAR}self_collision: {wrong}\n", encoding="utf-8")
        run = stepbot("check", "plates.robot.yaml")
        assert run.code == 1
        assert "self_collision" in run.out or "plates.robot.yaml:15" in run.out


@pytest.mark.long
def test_written_files_give_the_same_classes(stepbot: Stepbot, plates: Path) -> None:
    """The classes of the written URDF and MJCF are those of the sidecar."""
    assert stepbot("convert", "plates.robot.yaml", "-o", "out", "-f", "urdf,mjcf", "--no-verify").code == 0
    found = []
    for target in ("plates.robot.yaml", "out/plates.urdf", "out/plates.xml"):
        document = json.loads(stepbot("collisions", target, "--samples", "100", "--json").out)
        pairs = document["self_collision"]["pairs"]
        found.append([(sorted(pair["links"]), pair["class"], pair["contacts"]) for pair in pairs])
    assert found[0] == found[1] == found[2]


@pytest.mark.parametrize("command", ["view", "render", "collisions", "drive"])
def test_a_misspelt_target_is_proposed(command: str, arm: Path, stepbot: Stepbot) -> None:
    """A file that does not exist ends with those that may be meant: without its suffix, misspelt, or all of them."""
    for target, help in (
        ("arm2", "did you mean 'arm2.robot.yaml' or 'arm2.step'?"),
        ("arm22.step", "did you mean 'arm2.step'?"),
        ("zzzzzzzz.urdf", "files in '.': 'arm2.robot.yaml', 'arm2.step'"),
        ("nowhere/arm2.urdf", "there is no folder 'nowhere'"),
    ):
        run = stepbot(command, target)
        assert run.code != 0
        assert "error[SB001]" in run.err
        assert help in run.err, run.err
    assert sorted(file.name for file in arm.iterdir()) == ["arm2.robot.yaml", "arm2.step"]
