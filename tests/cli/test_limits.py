"""Limits of time and memory of the process of a command itself, and what it prints while it works."""

import io
import sys
import tempfile
import threading
import time
from pathlib import Path

import click
import pytest

from stepbot.diagnostics import StepbotError
from stepbot.pipeline.conversion import Options
from stepbot.runtime import progress
from stepbot.runtime.parallel import run
from stepbot.runtime.processes import can_fork
from stepbot.runtime.temporary import run_folder
from stepbot_cli import limits
from stepbot_cli.limits import bounded
from stepbot_cli.progress import NO_PROGRESS, how_far, progress_bar


def test_work_that_never_ends_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also if a library catches the exception once."""
    monkeypatch.setattr(limits, "_AGAIN", 0.05)
    caught: list[str] = []

    def work() -> None:
        while True:
            try:
                while True:
                    pass
            except StepbotError as error:
                caught.append(str(error))
                if len(caught) > 1:
                    raise

    with pytest.raises(StepbotError, match=r"SB902.*processor time"), bounded(Options(Path(), timeout=0.05)):
        work()
    assert len(caught) == 2


@pytest.mark.slow
def test_each_stage_has_the_whole_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """A command with many inputs may take longer than the limit, one of them may not."""
    monkeypatch.setenv(NO_PROGRESS, "1")

    def work(seconds: float) -> None:
        end = time.process_time() + seconds
        while time.process_time() < end:
            pass

    with progress_bar(options=Options(Path(), timeout=0.5)) as begin:
        for stage in ("one", "two", "three"):
            begin(stage)
            work(0.25)
        with pytest.raises(StepbotError, match="SB902"):
            work(5.0)


@pytest.mark.skipif(sys.platform != "linux", reason="limits of address space, and its size, are Linux's")
def test_memory_of_the_command_itself_is_bounded() -> None:
    """What it has already does not count; afterwards it has no limit."""
    few, much = 64 << 20, 4 << 30
    with pytest.raises(StepbotError, match="out of memory"), bounded(Options(Path(), memory_limit=few)):
        bytearray(much)
    with pytest.raises(StepbotError, match="out of memory"), bounded(Options(Path(), memory_limit=few)):
        raise ImportError("lib.so: failed to map segment from shared object")
    with pytest.raises(ImportError, match="no module"), bounded(Options(Path(), memory_limit=few)):
        raise ImportError("no module")
    with bounded(Options(Path(), memory_limit=4 * much)):
        assert len(bytearray(few)) == few


@pytest.mark.skipif(sys.platform != "linux", reason="limits of address space, and its size, are Linux's")
def test_a_native_module_that_fails_at_the_limit_is_out_of_memory() -> None:
    """There it may return without an exception; far from the limit that is an error of its own."""
    failure, far = "error return without exception set", 1 << 40

    def fail(taken: int) -> None:
        bytearray(taken)
        raise SystemError(failure)

    with pytest.raises(SystemError, match=failure), bounded(Options(Path(), memory_limit=far)):
        fail(0)
    with pytest.raises(StepbotError, match="out of memory"), bounded(Options(Path(), memory_limit=1 << 30)):
        fail((1 << 30) - (64 << 20))


@pytest.mark.skipif(not can_fork(), reason="without forks one process makes all inputs")
def test_inputs_that_are_done_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """In whatever process; other processes of the run see the count, and nothing is left of it."""
    monkeypatch.setattr(tempfile, "tempdir", str(run_folder()))

    def seen(_number: int) -> tuple[progress.Count, ...]:
        return progress.counts()

    found = run(seen, range(20), processes=2, work="things-made")
    counts = [one for result in found.values() if isinstance(result, tuple) for one in result]
    assert {(one.work, one.total) for one in counts} == {("things-made", 20)}
    assert max(one.done for one in counts) >= 9  # one of two processes made ten at least
    assert progress.counts() == ()


def test_rate_and_remaining_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """In proportion to what is done; nothing is said of the time before the first input is."""
    monkeypatch.setattr(progress, "counts", lambda: (progress.Count("bodies", 120, 1000, 8.0),))
    assert how_far() == "bodies: 120 of 1000, 15/s, 59 s left"
    monkeypatch.setattr(progress, "counts", lambda: (progress.Count("bodies", 0, 1000, 8.0),))
    assert how_far() == ""


def test_a_log_gets_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    """A command that takes long prints its stage and the time, again and again."""
    printed = threading.Event()

    class Log(io.StringIO):
        def flush(self) -> None:
            if "verifying" in self.getvalue():
                printed.set()

    log = Log()
    monkeypatch.setattr(sys, "stderr", log)
    monkeypatch.delenv(NO_PROGRESS)
    monkeypatch.setattr("stepbot_cli.progress.BETWEEN_LINES", 0.01)
    with progress_bar() as begin:
        begin("verify")
        assert printed.wait(60.0)
    assert "stepbot: verifying in the engines, 0 s\n" in log.getvalue()


def test_a_quiet_command_leaves_out_the_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    """`-q` of the command that runs is known from its context."""
    log = io.StringIO()
    monkeypatch.setattr(sys, "stderr", log)
    monkeypatch.delenv(NO_PROGRESS)
    monkeypatch.setattr("stepbot_cli.progress.BETWEEN_LINES", 0.01)
    context = click.Context(click.Command("convert"))
    context.params["quiet"] = True
    with context, progress_bar() as begin:
        begin("verify")
        time.sleep(0.1)
    assert "verifying" not in log.getvalue()
