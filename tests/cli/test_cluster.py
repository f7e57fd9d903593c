"""A Dask cluster on this machine: a scheduler and two workers, one of them killed during a batch."""

import importlib.util
import json
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cli.test_current_folder import INSTALLED, set_traps
from tests.command_line import COMMAND, environment, snapshot
from tests.command_line import stepbot_process as stepbot

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="the extra `dask` is not installed"),
]
COPIES = 6


def start(*arguments: str, log: Path) -> subprocess.Popen[bytes]:
    """Start a Dask process whose output goes to a file."""
    command = [sys.executable, "-P", "-m", *arguments]
    with log.open("wb") as file:
        return subprocess.Popen(command, stdout=file, stderr=file, env=environment(), cwd=log.parent)


def wait_for(log: Path, pattern: str) -> str:
    """The first group of a pattern in the output of a process, once it is printed."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        match = re.search(pattern, log.read_text(encoding="utf-8", errors="replace"))
        if match:
            return match[1]
        time.sleep(0.1)
    raise AssertionError(f"nothing like {pattern} in {log.read_text(encoding='utf-8')}")


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Address of a scheduler, and the processes of its two workers."""
    scheduler_log = tmp_path / "scheduler.log"
    options = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    processes = [start("distributed.cli.dask_scheduler", *options, log=scheduler_log)]
    try:
        address = wait_for(scheduler_log, r"(tcp://127\.0\.0\.1:\d+)")
        workers = []
        for number in range(2):
            log = tmp_path / f"worker{number}.log"
            worker = start(
                "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard", log=log
            )
            processes.append(worker)
            workers.append(worker)
            wait_for(log, r"(Registered to)")
        yield address, workers
    finally:
        for process in reversed(processes):
            process.kill()
            process.wait()


def test_killed_worker_loses_nothing(
    tmp_path: Path, robot_library: Path, cluster: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    """Six robots on two workers, one of them killed, are each converted once, with the bytes of `convert`."""
    address, workers = cluster
    source = robot_library / "stepbot_four_bar"
    for number in range(COPIES):
        folder = tmp_path / "lib" / f"robot{number}"
        folder.mkdir(parents=True)
        shutil.copy(source / "four_bar.step", folder)
        shutil.copy(source / "four_bar.robot.yaml", folder / f"robot{number}.robot.yaml")
    fast = ("-f", "urdf", "--no-verify")
    command = [*COMMAND, "batch", "lib", "-o", "out", "--json", "--scheduler", address, *fast]
    with (tmp_path / "batch.json").open("wb") as out, (tmp_path / "batch.txt").open("wb") as err:
        batch = subprocess.Popen(command, cwd=tmp_path, env=environment(), stdout=out, stderr=err)
    deadline = time.monotonic() + 240
    while not list((tmp_path / "out").glob("robot*/report.json")):
        assert time.monotonic() < deadline, (tmp_path / "batch.txt").read_text(encoding="utf-8")
        assert batch.poll() is None, "all was done before a worker could be killed"
        time.sleep(0.05)
    workers[0].kill()
    assert batch.wait(timeout=300) == 0, (tmp_path / "batch.txt").read_text(encoding="utf-8")
    document = json.loads((tmp_path / "batch.json").read_text(encoding="utf-8"))
    assert [robot["name"] for robot in document["robots"]] == [f"robot{number}" for number in range(COPIES)]
    assert document["summary"] == {"converted": COPIES, "unchanged": 0, "failed": 0}
    sidecar = Path("lib") / "robot0" / "robot0.robot.yaml"
    alone = tmp_path / "alone" / "robot0"  # as deep as in the batch: the list has the path from there to the sidecar
    assert stepbot("convert", sidecar, "-o", alone, *fast, cwd=tmp_path).code == 0
    expected = snapshot(alone)
    own = [".stepbot.json", "report.json"]  # the report names the sidecar, and the list has its hash
    for number in range(COPIES):
        found = snapshot(tmp_path / "out" / f"robot{number}")
        assert list(found) == list(expected)
        assert [name for name in found if found[name] != expected[name]] in ([], own)
    assert snapshot(tmp_path / "out" / "robot0") == expected
    again = json.loads(stepbot(*command[3:], cwd=tmp_path).out)
    assert again["summary"] == {"converted": 0, "unchanged": COPIES, "failed": 0}


@pytest.fixture
def marker(tmp_path: Path) -> Path:
    """The file that modules in the folder of scheduler and workers write to when they are imported."""
    set_traps(tmp_path, tmp_path / "marker.txt")
    return tmp_path / "marker.txt"


def test_workers_import_nothing_of_their_folder(
    tmp_path: Path, robot_library: Path, marker: Path, cluster: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    """Child processes of workers do not import modules of the workers' folder."""
    address, _ = cluster
    shutil.copytree(robot_library / "stepbot_four_bar", tmp_path / "lib")
    command = [*INSTALLED, "batch", "lib", "-o", "out", "--json", "--scheduler", address]
    run = subprocess.run(command, cwd=tmp_path, env=environment(), capture_output=True, timeout=300, check=False)
    assert run.returncode == 0, run.stderr.decode("utf-8")
    assert json.loads(run.stdout)["summary"] == {"converted": 1, "unchanged": 0, "failed": 0}
    assert not marker.exists(), marker.read_text(encoding="utf-8")


def test_no_scheduler(tmp_path: Path, robot_library: Path) -> None:
    """An unreachable scheduler is reported in one line."""
    run = stepbot("batch", robot_library, "-o", "out", "--scheduler", "tcp://127.0.0.1:9", cwd=tmp_path)
    assert run.code == 2
    assert "SB009" in run.err
