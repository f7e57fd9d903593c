"""A few trials of each experiment; ``make hostile`` runs thousands."""

import json
import multiprocessing
import shutil
import tempfile
from pathlib import Path
from random import Random

import pytest
from msgspec.structs import replace

from tests.command_line import snapshot, stepbot

from . import __main__ as runner
from . import page, sandbox, xml_damage
from .__main__ import NAMES, experiment
from .command import _is_open, _shared_memory, full_disk
from .disks import NOT_RUN
from .experiment import Experiment, Setting, Trial
from .mutant_files import FILES, FileMutant
from .mutant_files import plan as plan_files
from .mutant_runner import Ended, planned
from .sidecar_damage import KINDS, damaged
from .sidecar_mutant import LIBRARY, SidecarMutant, plan
from .sidecar_tree import read_tree, written

FEW = {"sidecars": 60, "descriptions": 4}
"""Numbers of trials in `make test`, which has the paths of other experiments elsewhere: full disks below, hostile names
in tests/cli/test_inspect.py, tests/cli/test_terminal.py and tests/unit/step/structure, mutants of STEP files in
tests/fuzz, damaged entries in tests/cli/test_cache.py, large trees in tests/unit/step/structure, and processes that are
killed or that share a cache or a folder in tests/unit/runtime and tests/cli/test_bad_input.py. `make test-long` runs
the short form of every experiment."""


@pytest.mark.slow
@pytest.mark.xdist_group("hostile")
@pytest.mark.parametrize(
    ("name", "count"),
    [
        *(pytest.param(name, count, id=name) for name, count in FEW.items()),
        *(pytest.param(name, 0, id=f"{name}, short form", marks=pytest.mark.long) for name in NAMES),
    ],
)
def test_no_fault_is_found(name: str, count: int, tmp_path: Path) -> None:
    """A few trials, or the short form of each experiment, find no traceback, hang, leftover or incomplete file."""
    chosen = experiment(name)
    count = count or chosen.short
    trials = list(chosen.run(Setting(tmp_path, seed=1, count=count)))
    assert len(trials) == count
    if all(trial.outcome == NOT_RUN for trial in trials):
        pytest.skip(NOT_RUN)
    failed = [f"{trial.name}\n" + "\n".join(trial.faults) for trial in trials if trial.faults]
    assert not failed, "\n".join(failed)


def test_run_during_which_the_code_changes_does_not_count(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A run during which stepbot's code changes is not counted, since files of two versions may differ."""
    codes = iter("ab")
    monkeypatch.setattr(runner, "_code", lambda: next(codes))
    monkeypatch.setattr(runner, "trials_of", lambda *given: [Trial("a", "robot", ("differs",))])
    assert runner.main(["--only", "names"]) == 2
    assert "does not count" in capsys.readouterr().out


@pytest.mark.skipif(not Path("/dev/shm").is_dir(), reason="the system has no folder of shared memory")
def test_semaphores_of_other_processes_are_not_left_behind() -> None:
    """A semaphore is in use until its owner lets go; a file that nobody has mapped is left behind."""
    before = _shared_memory()
    semaphore = multiprocessing.get_context("spawn").Semaphore()
    made = [name for name in _shared_memory() - before if name.startswith("sem.")]
    assert made
    assert all(map(_is_open, made)), f"{semaphore} is in use"
    with tempfile.NamedTemporaryFile(dir="/dev/shm") as file:
        assert not _is_open(Path(file.name).name)
    assert _is_open(Path(file.name).name), "it is gone"


@pytest.mark.long
def test_tree_of_a_sidecar_is_written_as_it_was_read(tmp_path: Path) -> None:
    """Every sidecar of the library keeps its meaning when its tree is written without damage."""
    sources = sorted(LIBRARY.glob("*/*.robot.yaml"))
    assert sources
    for source in sources:
        copy = tmp_path / source.name
        copy.write_text(written(read_tree(source)), encoding="utf-8")
        assert read_tree(copy) == read_tree(source), source


@pytest.mark.long
def test_damage_depends_on_the_name_alone_and_changes_the_sidecar() -> None:
    """The same seed gives the same bytes, and each kind of damage changes most sidecars."""
    base = read_tree(LIBRARY / "stepbot_arm2" / "arm2.robot.yaml")
    sound = written(base)
    for kind in KINDS:
        contents = [damaged(base, kind, Random(f"{kind}{seed}")) for seed in range(30)]
        assert contents == [damaged(base, kind, Random(f"{kind}{seed}")) for seed in range(30)]
        assert len(set(contents) - {sound.encode()}) > 15, kind
    assert written(base) == sound


@pytest.mark.slow
@pytest.mark.parametrize("name", ["arm.urdf", "leg.xml", "cell.sdf"])
def test_damage_to_a_description_depends_on_the_name_alone(name: str) -> None:
    """The same seed gives the same bytes; each kind changes most files, and leaves the tree as it is."""
    base = xml_damage.parse((Path(__file__).parent / "foreign" / name).read_bytes())
    sound = xml_damage.etree.tostring(base)
    for kind in xml_damage.KINDS:
        contents = [xml_damage.damaged(base, kind, Random(f"{kind}{seed}")) for seed in range(12)]
        assert contents == [xml_damage.damaged(base, kind, Random(f"{kind}{seed}")) for seed in range(12)], kind
        assert len(set(contents) - {sound}) > 6, kind
    assert xml_damage.etree.tostring(base) == sound


def test_mutants_of_files_are_of_every_group_with_a_command_each(tmp_path: Path) -> None:
    """Groups come in turn; a name gives its mutant and its command."""
    for name in ("sidecar-a", "step-a", "urdf-a", "sdf-a", "mjcf-a", "mesh-urdf"):
        (tmp_path / name).mkdir()
    mutants = plan_files(tmp_path, 110, 3)
    assert {mutant.group for mutant in mutants} == {*FILES}
    assert [FileMutant.named(mutant.name) for mutant in mutants] == mutants
    assert [planned(mutant, "main.x") for mutant in mutants] == [planned(mutant, "main.x") for mutant in mutants]


def test_every_forbidden_end_of_a_command_is_a_fault() -> None:
    """Tracebacks, internal errors, other exit codes, hangs, control characters, and JSON that is none."""
    sound = Ended(1, "", "x.urdf: error[SB814]: not XML", hung=False, seconds=1.0, memory=1 << 28)
    assert not sound.faults()
    diagnostic = {"code": "SB814", "message": "a\nb", "file": "x", "severity": "note", "help": []}
    for changes in (
        {"code": -11},
        {"code": 3},
        {"code": 2, "err": "no"},
        {"err": "Traceback (most recent call last):\n"},
        {"err": "error[SB901]: x"},
        {"err": "\x1b[31m"},
        {"hung": True},
        {"seconds": 1e3},
        {"memory": 1 << 40},
        {"out": "{"},
        {"out": '{"deviation": NaN}'},
        {"out": json.dumps({"diagnostics": [diagnostic]})},
    ):
        assert replace(sound, **changes).faults(), changes


def test_sandbox_notices_whatever_changes(tmp_path: Path) -> None:
    """Files that are new, gone, or others; their times and permissions; links; what may change is left out."""
    base = tmp_path / "base"
    base.mkdir()
    (base / "main.urdf").write_text("<robot/>")
    place = tmp_path / "place"
    sandbox.build(place, base, base)
    before = sandbox.entries(place)
    assert not sandbox.changed(before, sandbox.entries(place), ())
    (place / "outside" / "kept.txt").chmod(0o600)
    (place / "work" / "out" / "main.urdf").write_text("<robot name='x'/>")
    (place / "work" / "out" / "notes.txt").unlink()
    (place / "work" / "linked.stl").unlink()
    (place / "home" / ".cache").mkdir()
    expected = ["'home/.cache' is new", "'outside/kept.txt' is another", "'work/linked.stl' is gone"]
    of_output = ["'work/out/main.urdf' is another", "'work/out/notes.txt' is gone"]
    after = sandbox.entries(place)
    assert sandbox.changed(before, after, ()) == [*expected, *of_output]
    assert sandbox.changed(before, after, ("work/out",)) == [*expected, of_output[1]]


def test_plan_names_each_mutant() -> None:
    """Each pair of sidecar and kind comes before any twice, and a name gives its mutant."""
    mutants = plan(["a", "b"], 2 * len(KINDS), 3)
    assert len({(mutant.base, mutant.kind) for mutant in mutants}) == 2 * len(KINDS)
    assert [SidecarMutant.named(mutant.name) for mutant in mutants] == mutants


def test_page_keeps_rows_of_experiments_that_did_not_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A row is replaced only by a run of its experiment; defects are counted."""
    monkeypatch.setattr(page, "PAGE", tmp_path / "reliability.md")
    first, second = (
        Experiment(name, "done", "expected", lambda setting: iter(()), short=1, long=2, repaired=(f"{name} broke",))
        for name in ("first", "second")
    )
    known = [first, second]
    page.write_row(second, [Trial("a", "refused"), Trial("b", "robot", ("hangs",))], known)
    page.write_row(first, [Trial("a", "robot")], known)
    page.write_row(first, [Trial("a", "refused")], known)
    rows = [line for line in page.PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    assert rows == [
        "| `first` | done | expected | 1 (2) | 1 refused | 0 |",
        "| `second` | done | expected | 2 (2) | 1 refused, 1 robot | 1 |",
    ]
    assert "- `first`: first broke" in page.PAGE.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("which", ["output", "cache"])
def test_full_disk_in_this_process(which: str, tmp_path: Path) -> None:
    """No room for the output is SB004, and the former files stay; without room in the cache, the result is the same."""
    for suffix in (".robot.yaml", ".step"):
        shutil.copy(LIBRARY / "stepbot_arm2" / f"arm2{suffix}", tmp_path)
    sidecar, disk = tmp_path / "arm2.robot.yaml", tmp_path / "disk"
    folders = {"output": tmp_path / "out", "cache": tmp_path / "cache"} | {which: disk / which}
    command = ("convert", "-v", sidecar, "--no-verify", "-o", folders["output"], "--cache", folders["cache"])
    disk.mkdir()
    with full_disk(disk, 32 << 20) as mounted:
        if not mounted:
            pytest.skip(NOT_RUN)
        first = stepbot(*command, cwd=tmp_path)
        assert first.code == 0, first.err
        former = snapshot(folders["output"])
        _fill(disk)
        text = sidecar.read_text(encoding="utf-8")
        sidecar.write_text(text.replace("1010 kg/m^3", "1020 kg/m^3"), encoding="utf-8")
        run = stepbot(*command, cwd=tmp_path)
        if which == "output":
            assert run.code == 2, run.err
            assert "error[SB004]" in run.err
            assert snapshot(folders["output"]) == former
        else:
            assert run.code == 0, run.err
            assert "SB006" in run.err
            assert snapshot(folders["output"]) != former
        assert "No space left" in run.err


def _fill(disk: Path) -> None:
    with (disk / "full").open("wb", buffering=0) as file:
        while True:
            try:
                file.write(bytes(4096))
            except OSError:
                return
