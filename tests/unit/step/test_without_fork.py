"""Where processes cannot be forked: the same bodies, and one that hangs or kills the kernel is stopped and named."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.runtime.processes import NO_FORK, can_fork
from stepbot.step import reader
from stepbot.step.assembly import ReadOptions
from tests import parts
from tests.conftest import ReadDiagnostics
from tests.unit.step.test_process import content


@pytest.fixture(autouse=True)
def without_fork(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on macOS and Windows."""
    monkeypatch.setenv(NO_FORK, "1")
    assert not can_fork()


@pytest.mark.parametrize(
    ("kernel", "seconds", "reason"),
    [("hanging", 5.0, "time limit of 5 s exceeded"), ("dying", 120.0, "exit code 7")],
)
def test_a_body_that_ends_the_kernel(
    kernel: str, seconds: float, reason: str, tmp_path: Path, found: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An error names its component and the reason; the other bodies are there."""
    monkeypatch.setattr(reader, "KERNEL", f"tests.unit.step.stuck_kernel:{kernel}")
    monkeypatch.setattr(reader, "BODY_SECONDS", seconds)
    path = parts.write_nested(tmp_path / "nested.step").path
    assembly = reader.read_assembly(path, ReadOptions(), found)
    assert assembly is not None
    (diagnostic,) = found
    assert diagnostic.code == "SB213"
    assert diagnostic.message.startswith("'slide:1/knob' (1 more like it): ")
    assert reason in diagnostic.message
    assert [len(body.mesh.faces) > 0 for body in assembly.bodies].count(False) == 1


def test_a_kernel_that_ends_over_no_body(
    tmp_path: Path, found: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is not started again: one error for the file."""
    monkeypatch.setattr(reader, "KERNEL", "tests.unit.step.stuck_kernel:leaving")
    assert reader.read_assembly(parts.write_nested(tmp_path / "nested.step").path, ReadOptions(), found) is None
    assert found.codes() == ["SB902"]


def test_all_time_is_bounded(tmp_path: Path, found: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch) -> None:
    """A body that hangs for longer than the whole file may take ends the reading."""
    monkeypatch.setattr(reader, "KERNEL", "tests.unit.step.stuck_kernel:hanging")
    path = parts.write_nested(tmp_path / "nested.step").path
    assert reader.start_reading(path, ReadOptions()).finish(found, timeout=10.0) is None
    (diagnostic,) = found
    assert (diagnostic.code, "no result after" in diagnostic.message) == ("SB902", True)


def test_the_same_assembly(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With fork and without: the same bytes."""
    path = parts.write_nested(tmp_path / "nested.step").path
    without = reader.read_assembly(path, ReadOptions(), Diagnostics())
    monkeypatch.delenv(NO_FORK)
    with_fork = reader.read_assembly(path, ReadOptions(), Diagnostics())
    assert without is not None
    assert with_fork is not None
    assert content(without) == content(with_fork)
