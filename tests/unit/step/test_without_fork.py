"""Without fork the bodies are the same, and one that hangs or crashes is stopped and reported by name."""

import time
from pathlib import Path
from typing import Any

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.runtime.parallel import Attempt
from stepbot.runtime.processes import NO_FORK, can_fork
from stepbot.runtime.worker import OutOfTime, WorkerDied
from stepbot.step import reader
from stepbot.step.assembly import ReadOptions
from tests import parts
from tests.conftest import ReadDiagnostics
from tests.unit.step.test_process import content


@pytest.fixture(autouse=True)
def without_fork(monkeypatch: pytest.MonkeyPatch) -> None:
    """Disable fork, as on macOS and Windows."""
    monkeypatch.setenv(NO_FORK, "1")
    assert not can_fork()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kernel", "seconds", "reason"),
    [
        pytest.param("hanging", 5.0, "time limit of 5 s exceeded", marks=pytest.mark.long),
        ("dying", 120.0, "exit code 7"),
    ],
)
def test_a_body_that_ends_the_kernel(
    kernel: str,
    seconds: float,
    reason: str,
    tmp_path: Path,
    diagnostics: ReadDiagnostics,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A body that ends the kernel is an error with its component and the reason; the other bodies are read."""
    monkeypatch.setattr(reader, "KERNEL", f"tests.unit.step.stuck_kernel:{kernel}")
    monkeypatch.setattr(reader, "BODY_SECONDS", seconds)
    path = parts.write_nested(tmp_path / "nested.step").path
    assembly = reader.read_assembly(path, ReadOptions(), diagnostics)
    assert assembly is not None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB213"
    assert diagnostic.message.startswith("'slide:1/knob' (1 more like it): ")
    assert reason in diagnostic.message
    assert [len(body.mesh.faces) > 0 for body in assembly.bodies].count(False) == 1


@pytest.mark.slow
def test_a_kernel_that_ends_over_no_body(
    tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A kernel that ends before any body is not started again: one error for the file."""
    monkeypatch.setattr(reader, "KERNEL", "tests.unit.step.stuck_kernel:leaving")
    assert reader.read_assembly(parts.write_nested(tmp_path / "nested.step").path, ReadOptions(), diagnostics) is None
    assert diagnostics.codes() == ["SB902"]


@pytest.mark.slow
def test_all_time_is_bounded(tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch) -> None:
    """A body that hangs for longer than the file's time limit ends the reading."""
    monkeypatch.setattr(reader, "KERNEL", "tests.unit.step.stuck_kernel:hanging")
    path = parts.write_nested(tmp_path / "nested.step").path
    assert reader.start_reading(path, ReadOptions()).finish(diagnostics, timeout=4.0) is None
    (diagnostic,) = diagnostics
    assert (diagnostic.code, "no result after" in diagnostic.message) == ("SB902", True)


class _Stuck:
    """A kernel process that dies over its first body; the next one hangs for the rest of the time."""

    started = 0
    pid = 0

    def __init__(self, *_: object, **__: object) -> None:
        _Stuck.started += 1

    def submit(self, *arguments: Any) -> "_Stuck":
        self.attempt: Attempt = arguments[-1]
        return self

    def result(self, timeout: float) -> None:
        if not self.attempt.died:
            Path(self.attempt.folder, "at hand").write_text("0", encoding="ascii")
            Path(self.attempt.folder, "late").touch()
            time.sleep(0.1)
            raise WorkerDied("ended with exit code 7 and no result", ())
        time.sleep(timeout)
        raise OutOfTime(timeout, ())

    def close(self) -> None:
        """Do nothing."""


@pytest.mark.slow
def test_limit_in_the_message_is_the_one_that_was_given(
    tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The message has the given time limit, not the rest that earlier processes left."""
    monkeypatch.setattr(reader, "Worker", _Stuck)
    path = parts.write_box(tmp_path / "box.step").path
    assert reader.start_reading(path, ReadOptions()).finish(diagnostics, timeout=0.5) is None
    assert _Stuck.started == 2
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB902"
    assert diagnostic.message.endswith("no result after 0.5 s")


@pytest.mark.slow
def test_the_same_assembly(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Assemblies read with and without fork have the same bytes."""
    path = parts.write_nested(tmp_path / "nested.step").path
    without = reader.read_assembly(path, ReadOptions(), Diagnostics())
    monkeypatch.delenv(NO_FORK)
    with_fork = reader.read_assembly(path, ReadOptions(), Diagnostics())
    assert without is not None
    assert with_fork is not None
    assert content(without) == content(with_fork)
