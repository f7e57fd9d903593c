"""The kernel in its own process has the same results, and any failure is a diagnostic."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from stepbot.runtime.worker import RemoteError
from stepbot.step import reader
from stepbot.step.assembly import Assembly, ReadOptions
from stepbot.step.reader import read_assembly, start_reading
from tests import parts
from tests.conftest import ReadDiagnostics
from tests.unit.step.in_process import read_here, read_quietly

POSIX = pytest.mark.skipif(os.name != "posix", reason="signals and limits of POSIX")


def content(assembly: Assembly) -> bytes:
    """The content of an assembly as bytes."""
    parts = [repr((assembly.components, assembly.facts, assembly.unit, assembly.unit_scale)).encode()]
    for body in assembly.bodies:
        parts += [body.mesh.vertices.tobytes(), body.mesh.faces.tobytes(), body.face_colors.tobytes()]
        parts.append(repr((body.kind, body.colors, body.exact, body.refined, body.axis_faces, body.defect)).encode())
    return b"|".join(parts)


def test_reading_in_a_process_of_its_own(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """The result equals that of this process, also for a folder with special characters; arrays are read-only."""
    folder = tmp_path / "Größe 螺丝 — new"
    folder.mkdir()
    path = parts.write_nested(folder / "nested 1.step").path
    assembly = read_assembly(path, ReadOptions(), diagnostics)
    assert assembly is not None
    assert list(diagnostics) == []
    here = read_quietly(path)
    assert assembly.components == here.components
    for body, other in zip(assembly.bodies, here.bodies, strict=True):
        assert (body.mesh.vertices == other.mesh.vertices).all()
        assert (body.exact, body.axis_faces) == (other.exact, other.axis_faces)
        with pytest.raises(ValueError, match="read-only"):
            body.mesh.vertices[0, 0] = 1.0


@POSIX
def test_a_kernel_that_is_killed(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A killed kernel is reported with the signal and the file as given."""
    path = parts.write_box(tmp_path / "box.step").path
    reading = start_reading(path, ReadOptions())
    assert reading.pid is not None
    os.kill(reading.pid, signal.SIGKILL)
    assert reading.finish(diagnostics) is None
    (diagnostic,) = diagnostics
    assert (diagnostic.code, diagnostic.span.file) == ("SB902", str(path))
    assert "SIGKILL" in diagnostic.message


def test_a_kernel_that_does_not_end(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A kernel that exceeds its time limit is stopped, with a remedy."""
    reading = start_reading(parts.write_box(tmp_path / "box.step").path, ReadOptions())
    assert reading.finish(diagnostics, timeout=0.001) is None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB902"
    assert diagnostic.message == "the geometry kernel was stopped while reading the file: no result after 0.001 s"
    assert diagnostic.help[0] == "allow more time: `--timeout 0.004`"


@POSIX
@pytest.mark.parametrize(("share", "limit"), [(2.0, "0.02"), (0.25, "0.08")])
def test_time_limit_grows_with_the_file(
    tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch, share: float, limit: str
) -> None:
    """Above a size the kernel may take longer in proportion; the remedy is in units of the option."""
    path = parts.write_box(tmp_path / "box.step").path
    monkeypatch.setattr(reader, "_LARGE", share * path.stat().st_size)
    reading = start_reading(path, ReadOptions())
    assert reading.pid is not None
    os.kill(reading.pid, signal.SIGSTOP)  # a kernel that is warm reads a box in less than the limit
    assert reading.finish(diagnostics, timeout=0.02) is None
    (diagnostic,) = diagnostics
    assert diagnostic.message.endswith(f"no result after {limit} s")
    assert diagnostic.help[0] == "allow more time: `--timeout 0.08`"


@POSIX
@pytest.mark.skipif(sys.platform == "darwin", reason="macOS does not limit address space")
def test_a_kernel_without_memory(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """With too little memory to load, the kernel ends in a diagnostic without a traceback."""
    path = parts.write_box(tmp_path / "box.step").path
    assert start_reading(path, ReadOptions(), memory_limit=120_000_000).finish(diagnostics) is None
    assert diagnostics.codes()[0] in ("SB902", "SB002")


@POSIX
@pytest.mark.skipif(sys.platform == "darwin", reason="macOS does not limit address space")
def test_a_body_without_memory(tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch) -> None:
    """For a body that exceeds the memory limit, the message names the limit, not an invalid body."""
    from stepbot.step import worker

    def greedy(source: object, request: object) -> None:
        bytearray(1 << 60)

    monkeypatch.setattr(worker, "read_body", greedy)
    assert read_here(parts.write_box(tmp_path / "box.step").path, diagnostics) is not None
    (diagnostic,) = diagnostics
    assert (diagnostic.code, "out of memory" in diagnostic.message) == ("SB213", True)
    assert "--memory-limit" in diagnostic.help[0]


def test_files_that_are_refused_at_once(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A file that is not STEP is not passed to the kernel; finishing twice reports it once."""
    path = tmp_path / "notes.txt"
    path.write_text("buy milk\n", encoding="utf-8")
    reading = start_reading(path, ReadOptions())
    assert reading.pid is None
    assert reading.finish(diagnostics) is None
    assert reading.finish(diagnostics) is None
    assert diagnostics.codes() == ["SB201"]
    reading.close()


def test_reading_can_be_given_up(tmp_path: Path) -> None:
    """Closing ends the process."""
    reading = start_reading(parts.write_box(tmp_path / "box.step").path, ReadOptions())
    reading.close()
    assert reading.pid is None
    reading.close()


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (
            RemoteError("ImportError", "libGL.so.1: cannot open shared object file: No such file or directory", ""),
            "SB002",
            ("libGL.so.1", "libgl1"),
        ),
        (
            RemoteError("ImportError", "libfoo.so.2: cannot open shared object file: No such file or directory", ""),
            "SB002",
            ("libfoo.so.2", "libfoo.so.2"),
        ),
        (RemoteError("ModuleNotFoundError", "No module named 'OCP'", ""), "SB003", ("not installed", "pip install")),
    ],
)
def test_a_kernel_that_does_not_load(
    error: RemoteError, code: str, words: tuple[str, str], diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A missing library is reported with its Debian package; libraries that exist are not listed."""
    monkeypatch.setattr(reader, "_loads", lambda library: True)
    assert reader._report_import(error, diagnostics, "arm.step")
    (diagnostic,) = diagnostics
    assert diagnostic.code == code
    assert words[0] in diagnostic.message
    assert words[1] in diagnostic.help[0]


def test_all_missing_libraries_are_reported_at_once(
    diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All missing libraries are reported, although the loader names only the first."""
    monkeypatch.setattr(reader, "_loads", lambda library: library == "libexpat.so.1")
    error = RemoteError("ImportError", "libGL.so.1: cannot open shared object file: No such file or directory", "")
    assert reader._report_import(error, diagnostics, "arm.step")
    (diagnostic,) = diagnostics
    assert diagnostic.help == ("on Debian or Ubuntu: apt-get install libgl1 libx11-6",)


def test_bugs_stay_bugs(diagnostics: ReadDiagnostics) -> None:
    """An error unrelated to loading is not reported as a missing library."""
    assert not reader._report_import(RemoteError("KeyError", "'x'", ""), diagnostics, "arm.step")


@POSIX
@pytest.mark.skipif(sys.platform == "darwin", reason="bodies are not made in processes of their own")
def test_a_body_that_kills_the_kernel(
    tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A crash over one body is an error that names its component; the other bodies are read."""
    from stepbot.runtime import parallel
    from stepbot.step import worker
    from stepbot.step.shapes.bodies import BodyRequest, ReadBody, read_body
    from stepbot.step.structure.source import BodySource

    def crash_on_spheres(source: BodySource, request: BodyRequest) -> ReadBody:
        made = read_body(source, request)
        if not made.body.axis_faces and len(made.body.mesh.faces) > 12:
            os.kill(os.getpid(), signal.SIGKILL)
        return made

    monkeypatch.setattr(worker, "read_body", crash_on_spheres)
    monkeypatch.setattr(worker, "thread_count", lambda: 1)  # as in the kernel's process; those of the tests stay idle
    monkeypatch.setattr(parallel, "core_count", lambda: 2)
    assembly = read_here(parts.write_nested(tmp_path / "nested.step").path, diagnostics)
    assert assembly is not None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB213"
    assert diagnostic.message.startswith("'slide:1/knob' (1 more like it): ")
    assert "SIGKILL" in diagnostic.message
    assert [len(body.mesh.faces) > 0 for body in assembly.bodies].count(False) == 1


SCRIPT = """
import hashlib, sys
from pathlib import Path
from stepbot.runtime import parallel
from tests.unit.step.in_process import read_quietly
from tests.unit.step.test_process import content
parallel.core_count = lambda: int(sys.argv[2])
print(hashlib.sha256(content(read_quietly(Path(sys.argv[1])))).hexdigest())
"""


@pytest.mark.long  # tests/cli/test_determinism.py compares a whole robot
def test_the_same_bytes_whatever_the_process(tmp_path: Path) -> None:
    """Hash seed, number of processes and working directory do not change the bytes."""
    path = parts.write_nested(tmp_path / "nested.step").path
    root = Path(__file__).parents[3]
    digests = set()
    for seed, processes in (("0", 1), ("1", 2), ("12345", 3)):
        environment = {
            **os.environ,
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": os.pathsep.join([str(root), str(root / "src")]),
        }
        command = [sys.executable, "-c", SCRIPT, str(path), str(processes)]
        folder = tmp_path / seed
        folder.mkdir()
        done = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True, check=True)
        digests.add(done.stdout.split()[-1])
    assert len(digests) == 1
