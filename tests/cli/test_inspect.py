"""``stepbot inspect``: component paths for the sidecar, measures, axis lines."""

import json
import math
import re
import subprocess
import sys
from pathlib import Path

import pytest
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from ruamel.yaml import YAML

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence, Part, write_step
from robot_library.stepbot_arm2.dimensions import BASE_PLATE, COLUMN, TURNTABLE, turntable_place
from stepbot.step.assembly import Quantity
from tests import command_line, parts, solids
from tests.step_editor import StepEditor

from .conftest import Stepbot


def test_components_with_paths_to_paste(arm: Path, stepbot: Stepbot) -> None:
    """One line per component: quoted path, solids, volume, centre, density, names."""
    run = stepbot("inspect", "arm2.step")
    assert (run.code, run.err) == (0, "")
    assert run.out.startswith("arm2.step: AP214, length unit mm")
    assert "15 definitions, 20 components, 16 solids" in run.out
    (line,) = [line for line in run.out.splitlines() if line.startswith('"base/screw M6x12:1"')]
    assert "7850 kg/m^3" in line
    assert "  'screw M6x12'  " in line
    assert "'screw M6x12:1'" not in line, "the product with a number says nothing new"
    assert "48, 48, 9" in line


@pytest.mark.slow
def test_names_of_an_occurrence(arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """An occurrence with its own name is listed; a narrow screen omits names that the path contains."""
    text = Path("arm2.step").read_text(encoding="utf-8")
    assert "'turntable:1'" in text
    Path("arm2.step").write_text(text.replace("'turntable:1'", "'disc'"), encoding="utf-8")
    (line,) = [line for line in stepbot("inspect", "arm2.step").out.splitlines() if "'turntable'" in line]
    assert "'turntable', 'disc'" in line
    monkeypatch.setenv("COLUMNS", "100")
    narrow = stepbot("inspect", "arm2.step", "--filter", "shoulder/*").out
    assert "'turntable', 'disc'" in narrow
    assert "'cheek'" not in narrow


def test_odd_characters_in_names(tmp_path: Path, stepbot: Stepbot) -> None:
    """Line breaks, terminal escapes and bidi marks in names do not break the listing."""
    from robot_library.moments import pose
    from robot_library.step_file import Assembly, Occurrence

    names = {"NAME_A": "two\nlines\x1b[31mred", "NAME_B": "tab\tand\u2028\x85end", "NAME_C": "\u202ertl"}
    children = [
        Occurrence(parts.drawn(name, solids.box(1, 2, 3)), f"{name}:1", pose((9 * i, 0, 0)))
        for i, name in enumerate(names)
    ]
    path = tmp_path / "odd.step"
    parts.draw(path, Assembly("root", children))
    text = path.read_text(encoding="utf-8")
    for name, odd in names.items():
        text = text.replace(name, "".join(f"\\X2\\{ord(c):04X}\\X0\\" for c in odd))
    path.write_text(text, encoding="utf-8")
    run = stepbot("inspect", str(path))
    assert run.code == 0
    assert all(line.isprintable() for line in run.out.split("\n"))
    table = run.out.partition("\n\n")[2].splitlines()
    assert len(table) == 1 + 1 + len(names)
    assert len({line.index("  1 ") for line in table[2:]}) == 1  # columns are still aligned
    pasted = [str(YAML(typ="safe").load(line.split("  ")[0])) for line in table[2:]]
    # Control characters, which a foreign code page leaves in names, are replaced.
    assert pasted == [re.sub("[\x1b\x85\u2028]", "\ufffd", name) for name in names.values()]
    document = json.loads(stepbot("inspect", str(path), "--json").out)
    assert [component["path"] for component in document["components"][1:]] == pasted


@pytest.mark.slow
def test_what_is_watertight_and_of_what(tmp_path: Path, stepbot: Stepbot) -> None:
    """The header counts closed meshes and lists materials; an open solid has the reason in its row."""
    out = stepbot("inspect", str(parts.write_nested(tmp_path / "nested.step").path)).out
    assert re.search(r"\d+ solids \(watertight\)", out)
    (line,) = [line for line in out.splitlines() if line.startswith("materials: ")]
    assert "'stuff of 7850' 7850 kg/m^3 (" in line
    out = stepbot("inspect", str(parts.write_open_solid(tmp_path / "open.step").path)).out
    assert "1 solid (0 of 1 watertight)" in out
    assert "4 of its edges belong to one face only" in out
    assert "materials:" not in out


@pytest.mark.slow
def test_every_path_means_one_component(arm: Path, stepbot: Stepbot) -> None:
    """Each printed path selects exactly its component."""
    from stepbot.pipeline.stages import Options, inspect
    from stepbot.step.structure.paths import ComponentPaths

    assembly = inspect(arm / "arm2.step", Options(output=Path())).assembly
    assert assembly is not None
    paths = ComponentPaths(assembly.components)
    assert all(paths.find_one(c.path).topmost == (c.index,) for c in assembly.components)
    assert all(f'"{c.path}"' in stepbot("inspect", "arm2.step").out for c in assembly.components[:3])


def test_volumes_are_those_of_the_drawing(arm: Path, stepbot: Stepbot) -> None:
    """The volume of a rod is that of its cylinder, 8 mm by 120 mm."""
    document = json.loads(stepbot("inspect", "arm2.step", "--json").out)
    (rod,) = [c for c in document["components"] if c["path"] == "forearm/gripper/rod:1"]
    assert rod["volume"] == pytest.approx(math.pi * 0.004**2 * 0.120, rel=1e-9)
    assert rod["density"] == 7850.0
    total = sum(c["volume"] for c in document["components"] if c["body"] >= 0)
    assert document["volume"] == document["components"][0]["volume"] == pytest.approx(total)
    assert document["exit_code"] == 0


def test_sizes_are_those_of_the_drawing(arm: Path, stepbot: Stepbot) -> None:
    """Sizes of the base plate (120 by 120 by 12 mm) and a rod (8 by 120 by 8) are mm in the text and m in JSON."""
    out = stepbot("inspect", "arm2.step").out
    (plate,) = [line for line in out.splitlines() if line.startswith('"base/base plate"')]
    assert "  120 x 120 x 12  " in plate
    document = json.loads(stepbot("inspect", "arm2.step", "--json").out)
    (rod,) = [c for c in document["components"] if c["path"] == "forearm/gripper/rod:1"]
    assert rod["size"] == pytest.approx([0.008, 0.120, 0.008], abs=1e-5)
    (low, high) = document["components"][0]["bounds"]
    assert document["components"][0]["size"] == pytest.approx([b - a for a, b in zip(low, high, strict=True)])


def listed_paths(out: str) -> list[str]:
    """The paths at the start of the lines of a listing."""
    return [str(YAML(typ="safe").load(match[0])) for match in re.finditer(r'^"[^"]*"', out, re.MULTILINE)]


def test_repeated_parts_share_a_line(arm: Path, stepbot: Stepbot) -> None:
    """Four identical screws are one line with a count; `--unfold` and `--features` list each."""
    out = stepbot("inspect", "arm2.step").out
    (line,) = [line for line in out.splitlines() if "screw M6x12" in line]
    assert re.match(r'"base/screw M6x12:1" +4 +1 +0\.751626 cm\^3 ', line)
    assert 'to "base/screw M6x12:4"' in line
    all_paths = [c["path"] for c in json.loads(stepbot("inspect", "arm2.step", "--json").out)["components"]]
    assert len(all_paths) == 21
    assert listed_paths(stepbot("inspect", "arm2.step", "--unfold").out) == all_paths
    assert set(all_paths) == set(listed_paths(stepbot("inspect", "arm2.step", "--features").out))
    counts = [int(match) for match in re.findall(r'^"[^"]*" +(\d+) +\d+ +\S+ cm', out, re.MULTILINE)]
    assert len(listed_paths(out)) + sum(counts) - len(counts) == len(all_paths)


def test_depth_and_filter(arm: Path, stepbot: Stepbot) -> None:
    """`--depth` and filters limit the text and count the rest; JSON has all components."""
    out = stepbot("inspect", "arm2.step", "--depth", "1").out
    assert listed_paths(out) == [".", "base", "shoulder", "forearm"]
    assert out.endswith("\n17 components below depth 1 not shown\n")
    out = stepbot("inspect", "arm2.step", "--filter", "*screw*", "--unfold").out
    assert listed_paths(out) == [f"base/screw M6x12:{n}" for n in (1, 2, 3, 4)]
    assert "17 components that do not match '*screw*' not shown" in out
    assert listed_paths(stepbot("inspect", "arm2.step", "--filter", "forearm/*").out) == [
        "forearm/beam",
        "forearm/gripper",
    ]
    everything = stepbot("inspect", "arm2.step", "--json").out
    assert stepbot("inspect", "arm2.step", "--json", "--depth", "1", "--filter", "*screw*").out == everything
    run = stepbot("inspect", "arm2.step", "--filter", "gripperr")
    assert (run.code, run.out) == (2, "")
    assert "did you mean 'gripper'" in run.err


def test_narrow_screen(arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """At 60 columns a path has its own line; in a pipe all is on one line."""
    monkeypatch.setenv("COLUMNS", "60")
    out = stepbot("inspect", "arm2.step").out
    assert max(map(len, out.splitlines())) <= 60
    narrow = listed_paths(out)
    assert "16 solids; 829.083 cm^3; 326.5 x 126 x 309.7 mm; at 103.27, 3, 154.83 mm" in " ".join(out.split())
    monkeypatch.delenv("COLUMNS")
    run = stepbot("inspect", "arm2.step")
    assert listed_paths(run.out) == narrow
    table = run.out.partition("\n\n")[2].splitlines()
    assert len(table) == 1 + len(narrow)
    monkeypatch.setenv("COLUMNS", "200")
    assert stepbot("inspect", "arm2.step").out == run.out


def test_validation_properties(tmp_path: Path, stepbot: Stepbot) -> None:
    """Stated validation properties are listed with the measured values, as text and JSON."""
    file = StepEditor(parts.write_box(tmp_path / "box.step", (100.0, 60.0, 40.0)).path)
    block = file.definition("block")
    file.measure(block, Quantity.VOLUME, 0.240, "cm", power=3)
    file.measure(block, Quantity.AREA, 24_800.0)
    path = str(file.write())
    run = stepbot("inspect", path)
    assert run.code == 0
    assert "warning[SB226]: 1 of 2 validation properties in the file differs" in run.out + run.err
    assert "1 of 2 validation properties match" in run.out
    rows = [line.split() for line in run.out.splitlines() if line.startswith('"."')]
    assert ['"."', "volume", "[cm^3]", "0.24", "240", "1.0e+03", "differs"] in rows
    assert not any("area" in row for row in rows)
    verbose = stepbot("inspect", path, "-v").out
    assert [line.split()[1] for line in verbose.splitlines() if line.startswith('"." ') and "[cm" in line] == [
        "volume",
        "area",
    ]
    document = json.loads(stepbot("inspect", path, "--json").out)
    wrong, right = document["validations"]
    assert (wrong["component"], wrong["quantity"], wrong["agrees"]) == (".", "volume", False)
    assert (wrong["stated"], wrong["read"]) == ([pytest.approx(0.24e-6)], [pytest.approx(240e-6)])
    assert (right["quantity"], right["agrees"], right["deviation"]) == ("area", True, pytest.approx(0, abs=1e-9))
    assert document["bodies"][0]["area"] == pytest.approx(0.0248)


def test_closed_surfaces_are_weighed(tmp_path: Path, stepbot: Stepbot) -> None:
    """A closed shell that is no solid has a volume and a mass; `inspect` says so, and does not deny the volume."""
    shell = TopExp_Explorer(solids.box(30, 40, 50).shape, TopAbs_ShapeEnum.TopAbs_SHELL).Current()
    drawing = parts.draw(tmp_path / "case.step", parts.Drawn("case", shell))
    run = stepbot("inspect", str(drawing.path))
    assert (run.code, run.err) == (0, "")
    assert "1 surface body (1 closed), 60 cm^3 in total" in run.out
    assert "closed surface, weighed as a solid" in run.out
    assert "encloses no volume" not in run.out


def test_features_are_origins_to_paste(arm: Path, stepbot: Stepbot) -> None:
    """Each axis line is listed with an origin that, used in a sidecar, selects that line."""
    run = stepbot("inspect", "arm2.step", "--features")
    (line,) = [line for line in run.out.splitlines() if "at [86.603, 0, 200] mm" in line]
    origin = line.partition("origin: ")[2]
    assert origin == '{axis_of: "forearm/beam", near: [86.603 mm, 0 mm, 200 mm]}'
    sidecar = arm / "arm2.robot.yaml"
    text = sidecar.read_text(encoding="utf-8")
    frame = f"frames:\n  hole: {{link: forearm, origin: {origin}}}\n"
    sidecar.write_text(text.replace("frames:\n", frame), encoding="utf-8")
    run = stepbot("check", "--step", "arm2.robot.yaml")
    assert run.code == 0, run.out


def test_between_components(arm: Path, stepbot: Stepbot) -> None:
    """The axis line of a pin and its bore, as text and JSON."""
    run = stepbot("inspect", "arm2.step", "--between", "base", "shoulder")
    assert run.out.startswith("'base' and 'shoulder' share 1 axis\n")
    assert 'origin: {mate: ["base", "shoulder"]}' in run.out
    document = json.loads(stepbot("inspect", "arm2.step", "--between", "base", "shoulder", "--json").out)
    (line,) = document["between"]["lines"]
    assert line["direction"] == pytest.approx([0, 0, 1])
    assert line["chosen"]
    # The pivot of the post is in the bore of the turntable over its whole height. The wider faces, of the post and of
    # the outside of the turntable, touch in a plane only. The weight is the smaller radius of the faces in contact.
    pivot_begins = BASE_PLATE[2] + COLUMN.height
    pivot_ends = pivot_begins + COLUMN.pivot
    turntable_begins = float(turntable_place()[2, 3])
    assert pivot_begins <= turntable_begins < turntable_begins + TURNTABLE.height <= pivot_ends
    assert 0.0 < TURNTABLE.bore - COLUMN.pivot_radius < 0.1
    assert line["weight"] * 1e3 == pytest.approx(min(COLUMN.pivot_radius, TURNTABLE.bore))


def test_between_links_of_a_sidecar(arm: Path, stepbot: Stepbot) -> None:
    """With a sidecar, `--between` compares links by name."""
    run = stepbot("inspect", "arm2.robot.yaml", "--between", "upper_arm", "forearm")
    assert re.match(r"link 'upper_arm' and link 'forearm' share \d+ ax", run.out)
    assert "origin: {auto: true" in run.out


def test_between_names_what_there_is(arm: Path, stepbot: Stepbot) -> None:
    """Where no name is similar, the links and the components below the root are listed."""
    assert 'components below the root: "base", "shoulder", "forearm"' in " ".join(
        stepbot("inspect", "arm2.step", "--between", "qwerty", "base").err.split()
    )
    of_sidecar = stepbot("inspect", "arm2.robot.yaml", "--between", "qwerty", "base").err
    assert "links: base, upper_arm, forearm, left_finger, right_finger" in " ".join(of_sidecar.split())
    assert "did you mean 'upper_arm'?" in stepbot("inspect", "arm2.robot.yaml", "--between", "uper_arm", "base").err


def test_quiet_prints_no_results(arm: Path, stepbot: Stepbot) -> None:
    """As in the other commands; JSON is printed anyway."""
    for option in ("-q", "--concise"):
        run = stepbot("inspect", "arm2.step", option)
        assert (run.code, run.out, run.err) == (0, "", "")
    assert json.loads(stepbot("inspect", "arm2.step", "-q", "--json").out)["exit_code"] == 0


def test_between_unknown_names(arm: Path, stepbot: Stepbot) -> None:
    """An unknown name is a usage error with similar names."""
    run = stepbot("inspect", "arm2.step", "--between", "base", "shulder")
    assert run.code == 2
    assert "did you mean 'shoulder'" in run.err


def test_what_is_no_step(arm: Path, stepbot: Stepbot) -> None:
    """A file that is not STEP is a finding; with `--json` only JSON is printed."""
    (arm / "no.step").write_text("hello\n", encoding="utf-8")
    run = stepbot("inspect", "no.step")
    assert run.code in (1, 2)
    assert run.out == "no.step: not read, 1 error\n"
    assert "no.step:1:1: error[SB201]: is not a STEP file" in run.err
    document = json.loads(stepbot("inspect", "no.step", "--json").out)
    assert document["exit_code"] == run.code
    assert document["diagnostics"][0]["file"].endswith("no.step")


@pytest.mark.slow
def test_json_while_the_kernel_prints(tmp_path: Path) -> None:
    """Kernel errors on standard output do not break the JSON document."""
    path = parts.write_colored_faces(tmp_path / "block.step").path
    text = path.read_text(encoding="utf-8")
    text, lost = re.subn(r"#\d+\s*=\s*(COLOUR_RGB|DRAUGHTING_PRE_DEFINED_COLOUR)[^;]*;", "", text)
    assert lost
    path.write_text(text, encoding="utf-8", newline="\n")
    kernel = (
        "import sys; from pathlib import Path; from stepbot.step.kernel import read_model;read_model(Path(sys.argv[1]))"
    )
    reported = subprocess.run([sys.executable, "-c", kernel, str(path)], capture_output=True, text=True, check=True)
    assert "ERR" in reported.stdout
    run = command_line.stepbot("inspect", path, "--json", cwd=tmp_path)
    document = json.loads(run.out)
    assert [finding["code"] for finding in document["diagnostics"]] == ["SB223"]
    assert document["components"][0]["solids"] == 1


def test_names_along_the_branches_of_a_tree_are_paths(
    arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`--tree` shows each component below its parent; a filter keeps the subassemblies above; lines fit the screen."""
    run = stepbot("inspect", "arm2.step", "--tree", "--unfold")
    paths, above = [], list[str]()
    for guides, name in re.findall(r'^([│├└─ ]*)"([^"]+)"', run.out, re.MULTILINE):
        above[len(guides) // 4 :] = [name]
        paths.append("/".join(above[1:]) or ".")
    document = json.loads(stepbot("inspect", "arm2.step", "--json").out)
    assert paths == [component["path"] for component in document["components"]]
    assert 'screw M6x12:1": 4 times; 1 solid' in stepbot("inspect", "arm2.step", "--tree").out
    filtered = stepbot("inspect", "arm2.step", "--tree", "--filter", "*screw*").out
    assert re.findall(r'"([^"]+)"(?=:|$)', filtered, re.MULTILINE) == [".", "base", "screw M6x12:1"]
    monkeypatch.setenv("COLUMNS", "60")
    assert max(map(len, stepbot("inspect", "arm2.step", "--tree").out.splitlines())) <= 60
    assert stepbot("inspect", "arm2.step", "--tree", "--features").code == 2


@pytest.mark.slow
def test_between_lists_the_strongest_axes_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot
) -> None:
    """A pin in its bore with the radii of each side; nine misaligned pairs of holes are counted, and listed with -v."""
    plate, pin = solids.box(200, 60, 10), solids.cylinder(8, 10).at(80, 0, 5)
    holes = [(x, y) for x in (-80, -60, -40) for y in (-20, 0, 20)]
    base, arm = plate + pin, plate - solids.cylinder(8.05, 10).at(80, 0, -5)
    for x, y in holes:
        hole = solids.cylinder(2, 10).at(x, y, -5)
        base, arm = base - hole, arm - hole.at(0.5, 0, 0)
    placed = [Occurrence(Part("base", base.shape)), Occurrence(Part("arm", arm.shape), X_AP=pose((0, 0, 10)))]
    write_step(tmp_path / "plates.step", Assembly("plates", placed))
    monkeypatch.chdir(tmp_path)
    lines = stepbot("inspect", "plates.step", "--between", "base", "arm").out.splitlines()
    assert lines[0] == "'base' and 'arm' share 1 axis"
    assert "selected by default: shaft of radius 8 mm and bore of radius 8.05 mm overlap by 10 mm" in lines[1]
    assert lines[1].endswith("(radius 8 mm of 'base'; radius 8.05 mm of 'arm')")
    assert lines[2:] == ["    9 misaligned pairs of axes not shown; -v shows all"]
    everything = stepbot("inspect", "plates.step", "--between", "base", "arm", "-v").out
    assert everything.count("are misaligned") == 9
    assert "not shown" not in everything


def test_sizes_have_the_digits_of_their_meshes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot
) -> None:
    """Between flat faces to the micrometre; across a curved face rounded to what the exact size is within."""
    disc, plate = solids.cylinder(67.3215, 20.125), solids.box(100.375, 20.062, 3.175).at(0, 0, 30)
    placed = [Occurrence(Part("disc", disc.shape)), Occurrence(Part("plate", plate.shape))]
    write_step(tmp_path / "sizes.step", Assembly("sizes", placed))
    monkeypatch.chdir(tmp_path)
    run = stepbot("inspect", "sizes.step")
    sizes = dict(re.findall(r'^"(\w+)".* (\S+ x \S+ x \S+) ', run.out, re.MULTILINE))
    assert sizes["plate"] == "100.375 x 20.062 x 3.175"
    across, also_across, high = sizes["disc"].split(" x ")
    assert high == "20.125"
    deviation = 0.002 * math.hypot(2 * 67.3215, 2 * 67.3215, 20.125)
    for text in (across, also_across):
        assert text.count(".") == 1
        assert len(text.split(".")[1]) == 1
        assert abs(float(text) - 2 * 67.3215) <= 2 * deviation
