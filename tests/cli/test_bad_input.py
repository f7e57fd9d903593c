"""Invalid input is reported with place, problem and remedy, and the previous output is kept."""

import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from msgspec import Struct

from stepbot.engines import Engine
from stepbot.runtime.temporary import run_folder
from tests import parts
from tests.command_line import COMMAND, LONGEST, convert_once, environment, snapshot

from .conftest import Run, Stepbot

pytestmark = pytest.mark.usefixtures("without_cache")

SIDECAR, STEP = "arm2.robot.yaml", "arm2.step"
CRASH = "tests.unit.runtime.isolated_functions:crash"
PROCESSES = Path("/proc")
ON_LINUX = pytest.mark.skipif(not (PROCESSES / "self" / "task").is_dir(), reason="needs /proc to find the worker")


@pytest.fixture(scope="session")
def good(tmp_path_factory: pytest.TempPathFactory, robot_library: Path) -> Path:
    """The output of a successful conversion."""
    sidecar = robot_library / "stepbot_arm2" / SIDECAR
    return convert_once(tmp_path_factory, "former_arm2", sidecar, "--no-verify").folder


class Desk(Struct, frozen=True):
    """A folder with the output of a successful conversion, for a second one that fails."""

    folder: Path
    temporary: Path
    """The folder for temporary files."""
    stepbot: Stepbot

    def run(self, *arguments: str) -> Run:
        """Run a command; assert that it leaves every file unchanged, no temporary file, and no traceback."""
        before = snapshot(self.folder)
        assert {"out/arm2.urdf", "out/arm2.sdf", "out/arm2.xml", "out/report.json"} <= set(before)
        run = self.stepbot(*arguments)
        assert "Traceback" not in run.err + run.out
        assert "SB901" not in run.err
        self.assert_untouched(before)
        return run

    def assert_untouched(self, before: dict[str, bytes]) -> None:
        """Assert that every file has its former bytes and that no file was added."""
        after = snapshot(self.folder)
        assert sorted(after) == sorted(before)
        assert [name for name in before if after[name] != before[name]] == []
        self.assert_no_temporary_files()

    def assert_no_temporary_files(self) -> None:
        """Assert that the folder for temporary files is empty."""
        assert list(self.temporary.iterdir()) == []


@pytest.fixture
def desk(good: Path, tmp_path: Path, robot_library: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> Desk:
    """A sidecar, its STEP and the output of a successful conversion."""
    desk = Desk(tmp_path / "desk", tmp_path / "temporary", stepbot)
    shutil.copytree(good, desk.folder / "out")
    for file in (SIDECAR, STEP):
        shutil.copy(robot_library / "stepbot_arm2" / file, desk.folder)
    desk.temporary.mkdir()
    run_folder()  # set for this process, in which the command runs
    monkeypatch.setenv("TMPDIR", str(desk.temporary))
    monkeypatch.setattr(tempfile, "tempdir", str(desk.temporary))
    monkeypatch.chdir(desk.folder)
    return desk


def error(run: Run, code: str, *, remedy: bool = True) -> tuple[str, str]:
    """Place and message of the error with a code; it must have a remedy, and standard output the verdict alone."""
    (verdict,) = run.out.splitlines()
    assert re.fullmatch(
        r"\w+: not converted, \d+ errors?( of \d+ causes?)?(, \d+ warnings?.*)?; .* is (unchanged|written)", verdict
    )
    (block,) = (block for block in run.err.split("\n\n") if f": error[{code}]: " in block)
    place, message = block.lstrip().splitlines()[0].split(f": error[{code}]: ")
    if remedy:
        assert re.search(r"^ *= help: \S", block, re.MULTILINE), f"no remedy in:\n{block}"
    assert re.search(r"^next: stepbot explain SB\d{3}(    .*)?$", run.err.splitlines()[-1])
    return place, message


def assert_place(place: str, file: Path, text: str) -> None:
    """Assert that a place is `file:line:column` and that the text there starts with ``text``."""
    name, line, column = place.rsplit(":", 2)
    assert name == file.name
    assert file.read_text(encoding="utf-8").splitlines()[int(line) - 1][int(column) - 1 :].startswith(text)


# The sidecar


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "code", "there", "says"),
    [
        pytest.param("[forearm]", "[forarm]", "SB301", "forarm]", "did you mean 'forearm'", id="wrong part"),
        pytest.param(
            "lower: -170 deg, upper: 170 deg",
            "lower: 170 deg, upper: -170 deg",
            "SB456",
            "170 deg, upper",
            "swap the limits",
            id="swapped limit",
        ),
        pytest.param("base: fixed", "bases: fixed", "SB120", "bases", "did you mean 'base'", id="unknown key"),
        pytest.param("zero: 30 deg", "zeros: 30 deg", "SB120", "zeros", "did you mean 'zero'", id="unknown key below"),
        pytest.param("base: fixed", "base: fixed\nbase: floating", "SB107", "base: floating", "line 6", id="duplicate"),
        pytest.param("parent: base", "parent: forearm", "SB450", "elbow:", "cycle in the joint tree", id="cycle"),
        pytest.param("parent: base", "parent: upper_arm", "SB450", "upper_arm", "joint 'shoulder'", id="own parent"),
        pytest.param("child: upper_arm", "child: uper_arm", "SB130:link", "uper_arm", "'upper_arm'", id="unknown link"),
        pytest.param("zero: 30 deg", "zero: 30 dag", "SB124", "30 dag", "deg", id="bad unit"),
        pytest.param("zero: 30 deg", "zero: .nan", "SB125", ".nan", "NaN is not allowed", id="nan"),
        pytest.param("mass: 180 g", "mass: -180 g", "SB125", "-180 g", "greater than 0", id="negative mass"),
        pytest.param("[shoulder]", "[shoulder", "SB104", "", "add ']'", id="bracket"),
    ],
)
def test_fault_in_the_sidecar(desk: Desk, old: str, new: str, code: str, there: str, says: str) -> None:
    """An error in the sidecar is reported at its line and column, with a suggestion where there is one; exit code 1."""
    sidecar = desk.folder / SIDECAR
    text = sidecar.read_text(encoding="utf-8")
    assert old in text
    sidecar.write_text(text.replace(old, new, 1), encoding="utf-8", newline="\n")
    run = desk.run("convert", SIDECAR, "-o", "out")
    assert run.code == 1
    place, _ = error(run, code, remedy=code != "SB125")  # the message itself lists the allowed values
    assert_place(place, sidecar, there)
    assert says in run.err


def test_all_faults_at_once(desk: Desk) -> None:
    """Four errors in one file are reported in one run, sorted by line."""
    sidecar = desk.folder / SIDECAR
    text = sidecar.read_text(encoding="utf-8")
    for old, new in (
        ("base: fixed", "bass: fixed"),
        ("lower: -170 deg, upper: 170 deg", "lower: 170 deg, upper: -170 deg"),
        ("zero: 30 deg", "zero: 30 dag"),
        ("kind: position", "kind: positon"),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    sidecar.write_text(text, encoding="utf-8", newline="\n")
    run = desk.run("convert", SIDECAR, "-o", "out")
    assert run.code == 1
    found = re.findall(rf"^{SIDECAR}:(\d+):\d+: error\[(SB\d+)\]", run.err, re.MULTILINE)
    assert [code for _, code in found] == ["SB120", "SB456", "SB124", "SB123"]
    assert [int(line) for line, _ in found] == sorted(int(line) for line, _ in found)
    assert run.out == "arm2: not converted, 4 errors; out is unchanged\n"


def test_cycle_without_a_root(desk: Desk) -> None:
    """A cycle of links without a root is reported."""
    sidecar = desk.folder / "pair.robot.yaml"
    sidecar.write_text(
        "version: 1\nrobot: pair\nstep: arm2.step\nbase: fixed\n"
        "links:\n  a: {parts: [base]}\n  b: {parts: [shoulder], rest: true}\n"
        "joints:\n"
        "  one: {type: continuous, parent: a, child: b}\n"
        "  two: {type: continuous, parent: b, child: a}\n",
        encoding="utf-8",
        newline="\n",
    )
    run = desk.run("convert", "pair.robot.yaml", "-o", "out")
    assert run.code == 1
    place, message = error(run, "SB450")
    assert_place(place, sidecar, "")
    assert "a" in message
    assert "b" in message


# The STEP


def cut(part: float) -> Callable[[Path, bytes], object]:
    """A truncated STEP file."""
    return lambda path, good: path.write_bytes(good[: int(len(good) * part)])


def empty_data(path: Path, good: bytes) -> None:
    """A STEP file with a header and nothing behind it."""
    path.write_bytes(good[: good.index(b"DATA;")] + b"DATA;\nENDSEC;\nEND-ISO-10303-21;\n")


@pytest.mark.parametrize(
    ("make", "code", "says"),
    [
        pytest.param(lambda path, good: path.write_text("buy milk\n"), "SB201", "ISO-10303-21", id="text"),
        pytest.param(lambda path, good: path.write_bytes(b"PK\x03\x04" + bytes(300)), "SB201", "damaged", id="zip"),
        pytest.param(lambda path, good: path.write_text("solid x\nendsolid x\n"), "SB201", "mesh", id="mesh"),
        pytest.param(lambda path, good: path.write_bytes(b""), "SB201", "empty", id="empty"),
        pytest.param(lambda path, good: path.write_bytes(b"\n \n"), "SB201", "", id="blank"),
        pytest.param(empty_data, "SB201", "DATA", id="empty data"),
        pytest.param(lambda path, good: parts.write_empty(path), "SB205", "no geometry", id="no geometry"),
        pytest.param(cut(0.02), "SB201", "unexpected end of file", id="header cut"),
        pytest.param(cut(0.5), "SB201", "unexpected end of file", id="cut"),
        pytest.param(cut(0.9999), "SB201", "unexpected end of file", id="end cut"),
        pytest.param(
            lambda path, good: parts.write_external_reference(path), "SB203", "elsewhere.step", id="external references"
        ),
    ],
)
def test_step_that_cannot_be_read(desk: Desk, make: Callable[[Path, bytes], object], code: str, says: str) -> None:
    """An unreadable STEP file is reported by name, with its kind and a remedy; exit code 1."""
    step = desk.folder / STEP
    make(step, step.read_bytes())
    run = desk.run("convert", SIDECAR, "-o", "out")
    assert run.code == 1
    place, message = error(run, code)
    assert place.split(":")[0] == STEP
    assert says in message + run.err


def test_step_that_is_not_there(desk: Desk) -> None:
    """A missing STEP file is reported at its name in the sidecar, with a similar name beside it; exit code 2."""
    (desk.folder / STEP).rename(desk.folder / "arm_2.step")
    run = desk.run("convert", SIDECAR, "-o", "out")
    assert run.code == 2
    place, _ = error(run, "SB001")
    assert_place(place, desk.folder / SIDECAR, STEP)
    assert "did you mean 'arm_2.step'?" in run.err


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (("convert", "arm3.robot.yaml", "-o", "out"), "arm3.robot.yaml"),
        (("convert", SIDECAR, "--step", "arm3.step", "-o", "out"), "arm3.step"),
        (("convert", SIDECAR, "--step", "out", "-o", "out"), "out"),
        (("convert", "out", "-o", "out"), "out"),
        (("verify", "out/arm3.urdf"), "out/arm3.urdf"),
        (("convert", "."), "."),
        (("convert", ""), "."),
        (("init", "/"), "/"),
    ],
    ids=["sidecar", "step", "folder as step", "folder as sidecar", "robot file", "current folder", "nothing", "root"],
)
def test_file_that_is_not_there(desk: Desk, arguments: tuple[str, ...], place: str) -> None:
    """A missing argument file is reported by the name given; exit code 2."""
    run = desk.run(*arguments)
    assert run.code == 2
    assert f"{place}: error[SB001]: " in run.err
    assert "stepbot explain SB001" in run.err


# The kernel


@pytest.mark.slow
def test_kernel_that_takes_too_long(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel that exceeds --timeout is stopped; the message names the option; exit code 2."""
    monkeypatch.setattr("stepbot.pipeline.prestart.KERNEL", "tests.unit.runtime.isolated_functions:hang")
    run = desk.run("convert", SIDECAR, "-o", "out", "--timeout", "2")
    assert run.code == 2
    place, message = error(run, "SB902")
    assert place == STEP
    assert "no result after 2 s" in message
    assert "--timeout" in run.err


def children(pid: int) -> list[int]:
    """The child processes of a process."""
    try:
        threads = list((PROCESSES / str(pid) / "task").iterdir())
        return [int(word) for thread in threads for word in (thread / "children").read_text().split()]
    except OSError:  # ended meanwhile
        return []


def command_of(pid: int) -> bytes:
    """The command line of a process; empty if it has ended."""
    try:
        return (PROCESSES / str(pid) / "cmdline").read_bytes()
    except OSError:
        return b""


def is_running(pid: int) -> bool:
    """Whether a process runs and is not a zombie."""
    try:
        return (PROCESSES / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def wait_for(what: Callable[[], list[int]], command: "subprocess.Popen[bytes]") -> list[int]:
    """The first result of a function that is not empty."""
    deadline = time.monotonic() + LONGEST
    while not (found := what()):
        assert time.monotonic() < deadline, "no such process"
        assert command.poll() is None, "the command ended before its worker was seen"
        time.sleep(0.002)
    return found


@contextmanager
def start(desk: Desk, *options: str) -> "Iterator[subprocess.Popen[bytes]]":
    """Start a conversion in the background; kill it at the end of the test if it still runs.

    The test, which has the higher priority, sees what it waits for in time however busy the machine is.
    """
    with subprocess.Popen(
        ["nice", "-n", "5", *COMMAND, "convert", SIDECAR, "-o", "out", *options],
        cwd=desk.folder,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as command:
        try:
            yield command
        finally:
            command.kill()


def assert_ended(*processes: int) -> None:
    """Check that processes have ended, or end soon: an idle worker first loads, then finds that its parent has."""
    deadline = time.monotonic() + LONGEST
    while (left := [pid for pid in processes if is_running(pid)]) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not left


def kernels(command: "subprocess.Popen[bytes]") -> list[int]:
    """The kernel processes below a command."""
    return [pid for pid in children(command.pid) if b"stepbot.step.worker" in command_of(pid)]


@pytest.mark.slow
@ON_LINUX
@pytest.mark.parametrize(
    "busy", [pytest.param(False, id="while it loads"), pytest.param(True, id="while it works", marks=pytest.mark.long)]
)
def test_kernel_that_dies(desk: Desk, busy: bool) -> None:
    """A kernel killed by SIGKILL is reported with the signal and the file being read; exit code 2."""
    before = snapshot(desk.folder)
    with start(desk, *(["--no-verify"] if busy else [])) as command:
        (kernel,) = wait_for(lambda: kernels(command), command)
        below = wait_for(lambda: children(kernel), command) if busy and len(os.sched_getaffinity(0)) > 1 else []
        os.kill(kernel, signal.SIGKILL)
        out, err = command.communicate(timeout=LONGEST)
    assert command.returncode == 2
    run = Run(command.returncode, out.decode(), err.decode())
    assert "Traceback" not in run.err
    place, message = error(run, "SB902")
    assert place == STEP
    assert "SIGKILL" in message
    desk.assert_untouched(before)
    assert_ended(kernel, *below)


@pytest.mark.slow
@ON_LINUX
def test_body_that_kills_the_kernel(desk: Desk) -> None:
    """A body whose process is killed is made again, as a mesh alone: a warning, or an error where more is needed."""
    if len(os.sched_getaffinity(0)) < 2:
        pytest.skip("one core: bodies are read in the kernel's own process")
    before = snapshot(desk.folder)
    with start(desk, "--no-verify") as command:
        (kernel,) = wait_for(lambda: kernels(command), command)
        os.kill(wait_for(lambda: children(kernel), command)[0], signal.SIGKILL)
        out, err = command.communicate(timeout=LONGEST)
    run = Run(command.returncode, out.decode(), err.decode())
    assert "Traceback" not in run.err
    if "SIGKILL" not in run.err:  # the process died between two bodies; another one continued with the rest
        assert run.code == 0, run.err
        return
    lost = re.search(r"warning\[SB(?:233|213)\]: '([^']+)'.*SIGKILL", run.err)
    assert lost, run.err
    if run.code == 1:  # a joint needs an axis of the body, or its mesh encloses no volume
        assert re.search(r"error\[SB(4\d\d|507)\]", run.err)
        desk.assert_untouched(before)
        return
    assert run.code == 0, run.err
    report = json.loads((desk.folder / "out/report.json").read_bytes())
    (body,) = (body for body in report["bodies"] if body["name"] == lost[1])
    assert body["exact"] is None
    (whole,) = (b for b in json.loads(before["out/report.json"])["bodies"] if b["name"] == lost[1])
    assert body["mesh"]["mass"] == pytest.approx(whole["exact"]["mass"], rel=1e-3)


@pytest.mark.slow
@pytest.mark.mujoco
def test_engine_that_dies(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """After an engine dies, the output goes to a separate folder; the message names file and engine."""
    observed = Engine.observe_function.fget
    assert observed is not None
    crashing = property(lambda engine: CRASH if engine.name == "mujoco" else observed(engine))
    monkeypatch.setattr(Engine, "observe_function", crashing)
    before = snapshot(desk.folder)
    run = desk.stepbot("convert", SIDECAR, "-o", "out")
    assert run.code == 1, run.err
    assert "Traceback" not in run.err
    for suffix in ("urdf", "xml"):
        assert f"arm2.{suffix}: error[SB802]: mujoco: killed by SIGSEGV" in run.err
    assert re.match(
        r"arm2: not converted, \d errors( of \d causes?)?(, \d warnings?.*)?; out is unchanged\narm2: 5 links", run.out
    )
    assert re.search(r"NOT PROVEN: (URDF|MJCF) differs from the CAD in MuJoCo", run.out)
    after = snapshot(desk.folder)
    assert {name: after[name] for name in before} == before
    written = {name for name in after if name not in before}
    assert {name.split("/")[0] for name in written} == {"out.failed"}
    assert {name.removeprefix("out.failed/") for name in written} == {
        name.removeprefix("out/") for name in before if name.startswith("out/")
    }


@pytest.mark.slow
@ON_LINUX
@pytest.mark.parametrize(
    ("sent", "busy"),
    [
        pytest.param(signal.SIGINT, False, id="Ctrl-C while it loads", marks=pytest.mark.long),
        pytest.param(signal.SIGINT, True, id="Ctrl-C while it works"),
        pytest.param(signal.SIGTERM, True, id="SIGTERM", marks=pytest.mark.long),
        pytest.param(signal.SIGKILL, True, id="SIGKILL", marks=pytest.mark.long),  # tests/hostile/kills.py
    ],
)
def test_interrupted(desk: Desk, sent: signal.Signals, busy: bool) -> None:
    """A signal ends the command and all its child processes; no file changes."""
    before = snapshot(desk.folder)
    with start(desk, *([] if busy else ["--no-verify"])) as command:
        (kernel,) = wait_for(lambda: kernels(command), command)
        if busy and len(os.sched_getaffinity(0)) > 1:
            wait_for(lambda: children(kernel), command)
        below = [pid for child in children(command.pid) for pid in (child, *children(child))]
        command.send_signal(sent)
        out, err = command.communicate(timeout=LONGEST)
    assert command.returncode == (-sent if sent == signal.SIGKILL else 128 + sent)
    assert b"Traceback" not in err
    assert (b"interrupted" in err) == (sent == signal.SIGINT)
    assert out == b""
    if sent == signal.SIGKILL:  # a killed process cleans up nothing; the next run does
        assert snapshot(desk.folder) == before
        with start(desk, "--no-verify") as following:
            following.communicate(timeout=LONGEST)
        desk.assert_no_temporary_files()
    else:
        desk.assert_untouched(before)
    assert_ended(*below)
