"""Commands on an assembly whose parts are in separate files: every file is an input."""

import hashlib
import json
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from stepbot.diagnostics import Diagnostics
from stepbot.jobs.batch.runs import plan, run_batch
from stepbot.pipeline.conversion import Options
from tests import parts
from tests.command_line import snapshot
from tests.parts import ALUMINIUM, STEEL, drawn
from tests.separate_files import write_separately
from tests.solids import box

from .conftest import Stepbot

FAST = ("-f", "urdf", "--no-verify")
SIDECAR = """\
version: 1
robot: lever
step: machine.step
links:
  base: {parts: [foot]}
  lever: {parts: [arm]}
joints:
  hinge:
    type: continuous
    parent: base
    child: lever
    origin: {xyz: [0, 0, 0.01]}
    axis: z
"""


def machine(thickness: float = 10.0) -> Assembly:
    """A foot, and an arm of two bars on it."""
    bar = drawn("bar", box(80, 10, thickness), "#222222", STEEL)
    foot = drawn("foot", box(40, 40, 10).at(0, 0, 0), "#b0b0b0", ALUMINIUM)
    arm = Assembly("arm", [Occurrence(bar, "bar:1"), Occurrence(bar, "bar:2", pose((0, 30, 0)))])
    return Assembly("machine", [Occurrence(foot, "foot:1"), Occurrence(arm, "arm:1", pose((0, 0, 20)))])


@pytest.fixture
def lever(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with ``lever.robot.yaml``, the four files of its assembly, and a cache."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("STEPBOT_NO_CACHE", "")
    monkeypatch.setenv("STEPBOT_CACHE", str(tmp_path / "kept"))
    write_separately(tmp_path, machine())
    (tmp_path / "lever.robot.yaml").write_text(SIDECAR, encoding="utf-8")
    return tmp_path


def replace_part(folder: Path) -> None:
    """Double the thickness of the bar, which is two references below the STEP that the sidecar names."""
    (folder / "new").mkdir()
    write_separately(folder / "new", machine(thickness=20.0))
    shutil.copy(folder / "new" / "bar.step", folder)


def mass_of(report: Path, link: str) -> float:
    """Mass [kg] of a link in a report."""
    document = json.loads(report.read_bytes())
    mass: float = next(one for one in document["robot"]["links"] if one["name"] == link)["mass"]
    return mass


@pytest.mark.slow
def test_a_changed_part_is_another_input(lever: Path, stepbot: Stepbot) -> None:
    """`convert`, `check` and `uptodate` detect a change of a file that the STEP refers to indirectly."""
    assert stepbot("convert", "lever.robot.yaml", "-o", "out", *FAST).code == 0
    assert mass_of(Path("out/report.json"), "lever") == pytest.approx(2 * STEEL * 0.08 * 0.01 * 0.01)
    assert stepbot("check", "--step", "lever.robot.yaml").code == 0
    assert stepbot("uptodate", "lever.robot.yaml", "-o", "out", "-f", "urdf").code == 0
    before = snapshot(Path("out"))
    recorded = json.loads(Path("out/report.json").read_bytes())["inputs"]
    assert recorded == {
        name: hashlib.sha256(Path(name).read_bytes()).hexdigest()
        for name in ("machine.step", "foot.step", "arm.step", "bar.step")
    }

    replace_part(lever)
    run = stepbot("uptodate", "lever.robot.yaml", "-o", "out", "-f", "urdf")
    assert run.code == 1
    assert "SB007" in run.out
    assert stepbot("convert", "lever.robot.yaml", "-o", "out", *FAST).code == 0
    assert mass_of(Path("out/report.json"), "lever") == pytest.approx(2 * STEEL * 0.08 * 0.01 * 0.02)
    assert snapshot(Path("out")) != before


@pytest.mark.slow
def test_a_part_that_goes_missing(lever: Path, stepbot: Stepbot) -> None:
    """The cached assembly is not used while one of its files is missing, and is used again afterwards."""
    assert stepbot("convert", "lever.robot.yaml", "-o", "out", *FAST).code == 0
    assert stepbot("check", "--step", "lever.robot.yaml").code == 0
    Path("bar.step").rename("aside.step")
    for command in (("check", "--step"), ("convert", "-o", "out", *FAST), ("uptodate", "-o", "out", "-f", "urdf")):
        run = stepbot(*command, "lever.robot.yaml")
        assert run.code == 1
        assert "arm.step:" in run.out + run.err
        assert "error[SB203]: the geometry of 'bar' is in file 'bar.step', which does not exist" in run.out + run.err
    Path("aside.step").rename("bar.step")
    assert stepbot("uptodate", "lever.robot.yaml", "-o", "out", "-f", "urdf").code == 0


@pytest.mark.slow
def test_an_assembly_with_a_missing_part_is_shown(lever: Path, stepbot: Stepbot) -> None:
    """`inspect` lists all components, marks the missing one, reports the error, and caches nothing."""
    complete = json.loads(stepbot("inspect", "machine.step", "--json").out)
    assert all(component["missing"] is None for component in complete["components"])
    Path("bar.step").rename("aside.step")
    run = stepbot("inspect", "machine.step")
    assert run.code == 1
    assert "error[SB203]: the geometry of 'bar' is in file 'bar.step', which does not exist" in run.err
    assert [line for line in run.out.splitlines() if "MISSING: file 'bar.step' was not read" in line]
    document = json.loads(stepbot("inspect", "machine.step", "--json").out)
    assert [c["path"] for c in document["components"]] == [c["path"] for c in complete["components"]]
    assert {c["missing"] for c in document["components"]} == {None, "bar.step"}
    Path("aside.step").rename("bar.step")
    assert json.loads(stepbot("inspect", "machine.step", "--json").out) == complete


@pytest.mark.slow
def test_diagnostics_name_a_part_from_the_cache_too(lever: Path, stepbot: Stepbot) -> None:
    """A diagnostic about a part names the part's file, relative to the current folder, also from the cache."""
    bar = parts.draw(lever / "bar.step", drawn("bar", box(80, 10, 10), "", STEEL)).path
    bar.write_bytes(bar.read_bytes().replace(b"'bar'", b"'b\xe4r'"))
    expected = stepbot("inspect", "machine.step").err
    assert "bar.step:" in expected
    assert "SB210" in expected
    assert stepbot("inspect", "machine.step").err == expected
    other = lever / "other"
    other.mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(other)
        assert "../bar.step:" in stepbot("inspect", "../machine.step").err.replace("\\", "/")


def test_inspect_lists_the_files(lever: Path, stepbot: Stepbot) -> None:
    """`inspect` has the tree and masses of a single file, and lists the referenced files."""
    run = stepbot("inspect", "machine.step")
    assert run.code == 0
    assert "foot.step, arm.step, bar.step" in run.out
    document = json.loads(stepbot("inspect", "--json", "machine.step").out)
    assert document["facts"]["further files"] == "foot.step, arm.step, bar.step"
    assert [c["path"] for c in document["components"]] == [".", "foot", "arm", "arm/bar:1", "arm/bar:2"]


@pytest.mark.slow
@pytest.mark.parametrize("as_bytes", [False, True], ids=["same machine", "other machine"])
def test_batch(as_bytes: bool, lever: Path) -> None:
    """A batch sends every file to the executor; a changed part is converted again."""
    diagnostics = Diagnostics()
    tasks = plan([Path("lever.robot.yaml")], Path("all"), diagnostics)
    options = Options(Path("all"), formats=("urdf",), verify=False)

    def statuses() -> list[str]:
        with ThreadPoolExecutor(1) as executor:
            outcomes = list(run_batch(tasks, options, Path("all"), executor, at_once=1, as_bytes=as_bytes))
        assert [str(d) for outcome in outcomes for d in outcome.diagnostics if d.severity == "error"] == []
        return [outcome.status.value for outcome in outcomes]

    assert statuses() == ["converted"]
    assert mass_of(Path("all/lever/report.json"), "lever") == pytest.approx(2 * STEEL * 0.08 * 0.01 * 0.01)
    assert statuses() == ["unchanged"]
    replace_part(lever)
    assert statuses() == ["converted"]
    assert mass_of(Path("all/lever/report.json"), "lever") == pytest.approx(2 * STEEL * 0.08 * 0.01 * 0.02)
