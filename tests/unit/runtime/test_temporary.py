"""The folder of a run's temporary files is removed however the run ends."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from stepbot.runtime.temporary import run_folder
from tests.processes import call_isolated

posix = pytest.mark.skipif(os.name == "nt", reason="no file locks and no SIGKILL on Windows")

RUN = """
import os, shutil, signal, sys, time
from pathlib import Path
from stepbot.runtime.temporary import run_folder
(run_folder() / "model.sdf").write_text("x")
print("ready", flush=True)
if sys.argv[1] == "wait":
    time.sleep(100.0)
if sys.argv[1] == "fail":
    raise RuntimeError
if sys.argv[1] == "late":
    remove = shutil.rmtree
    shutil.rmtree = lambda *given, **more: (os.kill(os.getpid(), signal.SIGTERM), remove(*given, **more))
"""


def start(how: str, temporary: Path) -> "subprocess.Popen[bytes]":
    """A process with a folder below ``temporary`` that waits, ends or fails."""
    environment = {**os.environ, "TMPDIR": str(temporary), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    process = subprocess.Popen(
        [sys.executable, "-c", RUN, how], env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    assert process.stdout is not None
    assert process.stdout.readline().strip() == b"ready"
    return process


def end(process: "subprocess.Popen[bytes]") -> None:
    """Kill the process."""
    process.kill()
    process.wait()
    assert process.stdout is not None
    process.stdout.close()


@pytest.mark.parametrize("how", ["end", "fail", pytest.param("late", marks=posix)])
def test_folder_goes_with_its_run(tmp_path: Path, how: str) -> None:
    """The folder is removed when the run ends, also by an exception, and also if it is asked to end meanwhile."""
    start(how, tmp_path).communicate()
    assert list(tmp_path.iterdir()) == []


@posix
def test_next_run_removes_what_a_killed_one_left(tmp_path: Path) -> None:
    """The folder of a killed run is removed by the next one; those of running ones and foreign ones are kept."""
    (tmp_path / "other").mkdir()
    (tmp_path / "stepbot-run-file").write_text("x")
    killed, running = start("wait", tmp_path), start("wait", tmp_path)
    try:
        assert len(list(tmp_path.glob("stepbot-run-*/model.sdf"))) == 2
        end(killed)
        assert len(list(tmp_path.glob("stepbot-run-*/model.sdf"))) == 2
        start("end", tmp_path).communicate()
        assert len(list(tmp_path.glob("stepbot-run-*/model.sdf"))) == 1
        assert {"other", "stepbot-run-file"} <= {path.name for path in tmp_path.iterdir()}
    finally:
        for process in (killed, running):
            end(process)


@pytest.mark.slow
@posix
def test_runs_that_begin_at_once_take_nothing_from_each_other(tmp_path: Path) -> None:
    """Runs that start at the same time keep their folders."""
    processes = [start("wait", tmp_path) for _ in range(6)]
    time.sleep(0.1)
    try:
        assert len(list(tmp_path.glob("stepbot-run-*/model.sdf"))) == 6
    finally:
        for process in processes:
            end(process)


def test_workers_use_the_folder_of_whoever_started_them() -> None:
    """Workers use the folder of their parent, which removes it even if they are killed."""
    assert Path(call_isolated("tempfile:gettempdir")) == run_folder()
