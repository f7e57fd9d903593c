"""Workers that are forked from processes that stay."""

import os
import sys
from pathlib import Path

import pytest

from stepbot.geometry.mesh_worker import MESH_WORKER
from stepbot.pipeline.prestart import WarmProcesses, warm_processes
from stepbot.runtime.worker import Worker, are_spawned, spawned, started_by

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")


def parent_of(worker: Worker) -> int:
    """The process id of the parent of a worker's process."""
    text = (Path("/proc") / str(worker.pid) / "stat").read_text()
    return int(text.rpartition(")")[2].split()[1])


@pytest.mark.slow
def test_workers_have_one_parent_that_stays() -> None:
    """Two workers of the same function are forked from one process, which ends with the others."""
    with started_by(spawned), warm_processes():
        assert not are_spawned()
        parents = []
        for _ in range(2):
            with Worker(MESH_WORKER) as worker:
                assert worker.submit("measures", (), more=True).result() == ()
                parents.append(parent_of(worker))
    assert parents[0] == parents[1] != os.getpid()
    assert not (Path("/proc") / str(parents[0])).exists()


def test_other_workers_are_new_interpreters() -> None:
    """A worker that no conversion needs is a child of this process."""
    processes = WarmProcesses()
    with started_by(processes.start), Worker("os:getcwd") as worker:
        assert parent_of(worker) == os.getpid()
        assert worker.submit().result() == str(Path.cwd())
    processes.close()
