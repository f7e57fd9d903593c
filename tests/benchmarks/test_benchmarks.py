"""Benchmarks use assemblies of known volume, measure whole process trees, and publish current results."""

import json
import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from benchmarks import collision
from benchmarks import contenders as who
from benchmarks.assemblies import ASSEMBLIES, Assembly, generate
from benchmarks.command import case_of, drafted
from benchmarks.comparison import compare
from benchmarks.contenders import Case, Contender
from benchmarks.inference_time import in_a_row
from benchmarks.report import PAGE, page_with_results
from benchmarks.timing import CommandFailed, peak_memory, timed
from stepbot.step.assembly import ReadOptions
from stepbot.step.reader import read_assembly
from tests.conftest import ReadDiagnostics
from tests.unit.assemble.workshop import Workshop

ROOT = Path(__file__).resolve().parents[2]
BURN = "import time\nwhile time.process_time() < 0.3: pass"


@pytest.mark.slow
@pytest.mark.parametrize(
    "assembly", [Assembly(definitions=3, occurrences=2), Assembly(cells=4)], ids=["plates", "relief"]
)
def test_volume_in_closed_form(tmp_path: Path, assembly: Assembly) -> None:
    """Each definition has the volume of its closed form, as integrated by the kernel."""
    sidecar = generate(assembly, tmp_path, "made")
    script = [sys.executable, str(ROOT / "benchmarks" / "bare_occt.py"), "made.step"]
    run = subprocess.run(script, cwd=tmp_path, capture_output=True, text=True, encoding="utf-8", check=True)
    reported = json.loads(run.stdout.splitlines()[-1])
    assert reported["solids"] == (assembly.definitions or 1)
    assert reported["volume"] * assembly.occurrences == pytest.approx(assembly.volume, rel=1e-9)
    assert case_of(sidecar, None, tmp_path / "case").step.name == "made.step"


@pytest.mark.long
def test_plain_converter_writes_the_volume_in_closed_form(tmp_path: Path) -> None:
    """The masses of the plain converter's links are those of the solids, so that it does the work of its class."""
    assembly = Assembly(definitions=3)
    generate(assembly, tmp_path, "made")
    script = [sys.executable, str(ROOT / "benchmarks" / "plain_converter.py"), "made.step", "out"]
    subprocess.run(script, cwd=tmp_path, check=True)
    links = ET.parse(tmp_path / "out" / "assembly.urdf").getroot().findall("link/inertial/mass")
    assert len(links) == len(list((tmp_path / "out").glob("*.stl"))) == 3
    assert sum(float(mass.attrib["value"]) for mass in links) == pytest.approx(
        assembly.volume * 1e-9 * 1000.0, rel=1e-6
    )


@pytest.mark.parametrize("link", ["base", "rail-connector", '"rail connector"'])
def test_a_frame_to_move_is_put_on_the_first_link(link: str, tmp_path: Path) -> None:
    """Names of drafted links have hyphens, or quotes around blanks."""
    (tmp_path / "a.step").write_bytes(b"")
    text = f"version: 1\nstep: a.step\nlinks:\n  # the root\n  {link}:  # first\n    rest: true\n"
    (tmp_path / "a.robot.yaml").write_text(text, encoding="utf-8")
    case = case_of(tmp_path / "a.robot.yaml", None, tmp_path / "case")
    assert f"benchmark_probe: {{link: {link}," in case.sidecar.read_text(encoding="utf-8")


@pytest.mark.long
def test_a_plain_step_gets_a_drafted_sidecar(tmp_path: Path) -> None:
    """`cold` of a STEP file measures with the sidecar that `stepbot init` drafts."""
    generate(Assembly(definitions=2), tmp_path, "made")
    sidecar = drafted(tmp_path / "made.step", tmp_path / "drafts")
    case = case_of(sidecar, None, tmp_path / "case")
    case.edit()
    assert compare(case, [who.COLD], 1, warm_up=False)[0].cpu > 0.0


def test_assemblies_have_the_size_in_their_names() -> None:
    """Assemblies have a thousand definitions, ten thousand occurrences, twenty thousand faces, as named."""
    assert ASSEMBLIES["definitions"].definitions == 1000
    assert ASSEMBLIES["occurrences"].occurrences == 10_000
    assert 2 * ASSEMBLIES["faces"].cells ** 2 == 20_000


def test_same_bytes_each_time(tmp_path: Path) -> None:
    """Generated assemblies have deterministic bytes."""
    for name in ("one", "two"):
        generate(Assembly(definitions=2), tmp_path / name, "made")
    assert (tmp_path / "one" / "made.step").read_bytes() == (tmp_path / "two" / "made.step").read_bytes()


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "wait4"), reason="times of process trees are taken where there is wait4")
def test_time_of_all_processes(tmp_path: Path) -> None:
    """CPU time includes child processes; a command that fails has no result."""
    both = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {BURN!r}], check=True)"
    cost = timed([sys.executable, "-c", both], tmp_path, os.environ)
    assert cost.cpu >= 0.3
    assert cost.wall > 0.0
    with pytest.raises(CommandFailed, match="exit code 3"):
        timed([sys.executable, "-c", "raise SystemExit(3)"], tmp_path, os.environ)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="orphans are adopted on Linux")
def test_time_of_processes_that_outlive_the_command(tmp_path: Path) -> None:
    """CPU time includes child processes that the command does not wait for."""
    left = f"import subprocess, sys; subprocess.Popen([sys.executable, '-c', {BURN!r}])"
    assert timed([sys.executable, "-c", left], tmp_path, os.environ).cpu >= 0.3


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/smaps_rollup").exists(), reason="memory is measured on Linux")
def test_memory_of_all_processes(tmp_path: Path) -> None:
    """Memory includes child processes."""
    hold = "import time; held = bytearray(b'x' * 2**26); time.sleep(0.4)"
    both = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {hold!r}], check=True)"
    assert peak_memory([sys.executable, "-c", both], tmp_path, os.environ) > 64.0


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "wait4"), reason="times of process trees are taken where there is wait4")
def test_ratios_are_to_the_first(tmp_path: Path) -> None:
    """Ratios are relative to the first contender; each contender runs once per round."""
    log = tmp_path / "log"

    def contender(name: str, work: str) -> Contender:
        return Contender(name, lambda case: [sys.executable, "-c", f"{work}\nopen('log', 'a').write('{name}')"])

    case = Case("one", tmp_path, tmp_path, tmp_path)
    rows = compare(case, [contender("a", "pass"), contender("b", BURN)], 2)
    assert log.read_text() == "ababab"
    assert [row.contender for row in rows] == ["a", "b"]
    assert rows[0].wall_ratio == rows[0].cpu_ratio == 1.0
    assert rows[1].cpu_ratio > 1.0


def test_an_edit_changes_the_frame_and_nothing_else(tmp_path: Path) -> None:
    """The first edit of a sidecar adds a frame; further edits change the text and keep its length."""
    for text in ("links:\n  base: {rest: true}\n", 'links:\n  # a word\n  "a b":\n    rest: true\njoints: {}\n'):
        sidecar = tmp_path / "arm.robot.yaml"
        sidecar.write_text(f"version: 1\nrobot: arm\nstep: 'x.step'  # here\n{text}", encoding="utf-8")
        (tmp_path / "x.step").write_bytes(b"")
        case = case_of(sidecar, None, tmp_path / str(len(text)))
        texts = []
        for _ in range(3):
            texts.append(case.sidecar.read_text(encoding="utf-8"))
            case.edit()
        assert len(set(texts)) == 3
        assert len({len(text) for text in texts[1:]}) == 1
        assert texts[0].startswith(sidecar.read_text(encoding="utf-8").rstrip())


def test_page_has_the_tables_of_the_results() -> None:
    """``python -m benchmarks report`` leaves the page unchanged."""
    page = PAGE.read_text(encoding="utf-8")
    assert page_with_results(page) == page
    for kind in ("cold", "check", "batch", "scaling"):
        assert f"<!-- results: {kind} -->" in page


def test_contenders_name_each_other_apart() -> None:
    """Contenders have distinct names, by which ratios are stored."""
    everyone = [
        who.BARE,
        who.CLICK,
        who.cascadio("python"),
        who.COLD,
        who.VERIFIED,
        who.EDITED,
        who.EDITED_VERIFIED,
        who.CHECK,
        who.VERSION,
        who.HELP,
        who.UNCHANGED,
        who.PLAIN,
    ]
    assert len({contender.name for contender in everyone}) == len(everyone)


@pytest.mark.slow
def test_copies_in_a_row_do_not_touch(robot_library: Path, diagnostics: ReadDiagnostics) -> None:
    """Copies have paths of their own, the same shapes, and boxes one after the other."""
    single = read_assembly(robot_library / "stepbot_four_bar" / "four_bar.step", ReadOptions(), diagnostics)
    assert single is not None
    row = in_a_row(single, 3)
    assert len(row.components) == 3 * (len(single.components) - 1) + 1
    assert len({one.path for one in row.components}) == len(row.components)
    assert all(row.components[one.parent].index == one.parent for one in row.components[1:])
    boxes = [row.bounds(one.index) for one in row.components if one.parent == 0]
    each = len(boxes) // 3
    parts = [[box for box in boxes[i : i + each] if box is not None] for i in range(0, len(boxes), each)]
    ends = [(min(low[0] for low, _ in part), max(high[0] for _, high in part)) for part in parts]
    assert len(ends) == 3
    assert all(before[1] < after[0] for before, after in pairwise(ends))


@pytest.mark.slow
def test_pieces_are_compared_without_coacd(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where CoACD is not installed, the table has stepbot's columns, and the means of its results."""
    monkeypatch.setattr(collision, "find_spec", lambda _: None)
    shop = Workshop()
    shop.box("cube")
    title, _, row, means = collision.compare_pieces(list(shop.assembly.bodies), [1]).splitlines()
    assert title.count("|") == row.count("|") == 7
    assert row.startswith("| 0 | 12 | 1 | 1.000 |")
    assert means.startswith("stepbot: 1 solids, mean IoU 1.0000, 1 pieces")
