"""``stepbot batch``: every robot once, independently of the others."""

import json
import os
import shutil
import signal
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from stepbot.jobs.batch.runs import Status, Task, run_batch
from stepbot.jobs.batch.work import ProcessPerThread
from stepbot.pipeline.conversion import Options
from tests.command_line import snapshot

from .conftest import Stepbot

FAST = ("-f", "urdf", "--no-verify")


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, robot_library: Path) -> Path:
    """A folder with two robots that convert and one that does not."""
    for name in ("arm2", "four_bar"):
        (tmp_path / "lib" / name).mkdir(parents=True)
        for suffix in (".robot.yaml", ".step"):
            shutil.copy(robot_library / f"stepbot_{name}" / f"{name}{suffix}", tmp_path / "lib" / name)
    (tmp_path / "lib" / "bad.robot.yaml").write_text("version: 1\nrobot: bad\nstep: no.step\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("STEPBOT_NO_CACHE", "")
    monkeypatch.setenv("STEPBOT_CACHE", str(tmp_path / "kept"))
    return tmp_path / "lib"


def statuses(document: dict[str, Any]) -> dict[str, str]:
    """The status of each robot."""
    return {robot["name"]: robot["status"] for robot in document["robots"]}


@pytest.mark.slow
def test_a_failed_robot_does_not_stop_the_others_and_is_repeated(library: Path, stepbot: Stepbot) -> None:
    """A failed robot does not stop the others; the next run skips finished robots and repeats changed ones."""
    run = stepbot("batch", "lib", "-o", "out", "--json", "--junit", "ci/junit.xml", *FAST)
    document = json.loads(run.out)
    assert run.code == document["exit_code"] == 1
    assert statuses(document) == {"bad": "failed", "arm2": "converted", "four_bar": "converted"}
    assert document["summary"] == {"converted": 2, "unchanged": 0, "failed": 1}
    assert document["robots"][0]["diagnostics"][0]["code"] == "SB121"
    root = ET.parse("ci/junit.xml").getroot()
    assert [suite.get("name") for suite in root] == ["bad", "arm2", "four_bar"]
    assert root.get("failures") == "1"

    for name in ("arm2", "four_bar"):
        sidecar = f"lib/{name}/{name}.robot.yaml"
        assert stepbot("convert", sidecar, "-o", f"alone/{name}", *FAST).code == 0
        assert snapshot(Path("out", name)) == snapshot(Path("alone", name))

    (library / "bad.robot.yaml").unlink()
    run = stepbot("batch", "lib", "-o", "out", *FAST)
    assert run.code == 0
    assert "2 robots in out: 0 converted, 2 unchanged, 0 failed" in run.out

    Path("out/arm2/arm2.urdf").write_text("by hand", encoding="utf-8")
    run = stepbot("batch", "lib", "-o", "out", *FAST)
    assert run.code == 1
    assert "'arm2.urdf' was edited since stepbot wrote it" in run.err
    assert Path("out/arm2/arm2.urdf").read_text(encoding="utf-8") == "by hand"
    Path("out/arm2/arm2.urdf").unlink()
    with (library / "four_bar" / "four_bar.step").open("a", encoding="utf-8") as step:
        step.write("\n")
    document = json.loads(stepbot("batch", "lib", "-o", "out", "--json", *FAST).out)
    assert statuses(document) == {"arm2": "converted", "four_bar": "converted"}
    assert snapshot(Path("out/arm2")) == snapshot(Path("alone/arm2"))
    document = json.loads(stepbot("batch", "lib", "-o", "out", "--json", "-f", "mjcf", "--no-verify").out)
    assert set(statuses(document).values()) == {"converted"}, "other options, other files"


@pytest.mark.slow
def test_same_names(library: Path, stepbot: Stepbot) -> None:
    """Robots of one name are distinguished by their folders; if these are equal too, nothing is converted."""
    text = (library / "bad.robot.yaml").read_text(encoding="utf-8")
    for folder in ("a", "b", "a/b"):
        (library / folder).mkdir(parents=True, exist_ok=True)
        (library / folder / "robot.yaml").write_text(text, encoding="utf-8")
    run = stepbot("batch", "lib/a/robot.yaml", "lib/b/robot.yaml", "-o", "out", "--json")
    assert statuses(json.loads(run.out)) == {"a": "failed", "b": "failed"}
    run = stepbot("batch", "lib/b/robot.yaml", "lib/a/b/robot.yaml", "-o", "out", "--json")
    assert statuses(json.loads(run.out)) == {"b-b": "failed"} or run.code == 2
    assert not Path("out").exists() or not list(Path("out").glob("*.yaml"))


def test_nothing_to_do(library: Path, stepbot: Stepbot) -> None:
    """A folder without sidecars is an error."""
    Path("empty").mkdir()
    assert stepbot("batch", "empty", "-o", "out").code == 2


def dies(sidecar: Path, options: Options) -> None:
    """End the process as a crash in native code does."""
    os.kill(os.getpid(), signal.SIGKILL)


def raises(sidecar: Path, options: Options) -> None:
    """Raise an exception."""
    raise ZeroDivisionError("a bug")


class Broken(ProcessPerThread):
    """An executor that runs another function for robots of one name."""

    how = staticmethod(dies)

    def submit(self, function: Any, /, *arguments: Any, **named: Any) -> Future[Any]:
        """Submit the other function for that robot."""
        return super().submit(self.how if "arm2" in str(arguments[0]) else function, *arguments, **named)


class Raising(Broken):
    """An executor whose robots raise."""

    how = staticmethod(raises)


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal on this system")
@pytest.mark.parametrize(("kind", "code"), [(Broken, "SB902"), pytest.param(Raising, "SB901", marks=pytest.mark.long)])
def test_crash_is_one_robots_own(library: Path, kind: type[Broken], code: str) -> None:
    """A robot whose process dies or raises fails; the others are converted."""
    tasks = [Task(n, Path(f"lib/{n}/{n}.robot.yaml"), Path("out", n)) for n in ("arm2", "four_bar")]
    options = Options(Path("out"), ("urdf",), verify=False)
    with kind(2, []) as executor:
        outcomes = {o.task.name: o for o in run_batch(tasks, options, Path("out"), executor, at_once=2)}
    assert outcomes["arm2"].status is Status.FAILED
    assert [one.code for one in outcomes["arm2"].diagnostics] == [code]
    assert outcomes["four_bar"].status is Status.CONVERTED


def test_exception_of_an_executor_is_one_robots_own(library: Path) -> None:
    """What an executor raises is reported with the first line of its text."""

    class Failing(ThreadPoolExecutor):
        def submit(self, function: Any, /, *arguments: Any, **named: Any) -> Future[Any]:  # noqa: ARG002
            return super().submit(raises, *arguments, **named)

    tasks = [Task("arm2", library / "arm2" / "arm2.robot.yaml", Path("out", "arm2"))]
    with Failing(1) as executor:
        (outcome,) = run_batch(tasks, Options(Path("out"), ("urdf",), verify=False), Path("out"), executor, at_once=1)
    assert outcome.status is Status.FAILED
    (diagnostic,) = outcome.diagnostics
    assert (diagnostic.code, diagnostic.message) == ("SB901", "internal error: ZeroDivisionError: a bug")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "as_bytes"), [("threads", False), pytest.param("spawned", True, marks=pytest.mark.long)]
)
def test_any_executor(library: Path, stepbot: Stepbot, kind: str, as_bytes: bool) -> None:
    """Threads and spawned processes, with input by path or by bytes, write the files of `convert`."""
    task = Task("arm2", Path("lib/arm2/arm2.robot.yaml"), Path("out/arm2"))
    options = Options(Path("out"), ("urdf",), verify=False)
    other: Executor = (
        ThreadPoolExecutor(1) if kind == "threads" else ProcessPoolExecutor(1, mp_context=get_context("spawn"))
    )
    with other:
        (outcome,) = run_batch([task], options, Path("out"), other, at_once=1, as_bytes=as_bytes)
    assert outcome.status is Status.CONVERTED, list(outcome.diagnostics)
    assert stepbot("convert", str(task.sidecar), "-o", "alone/arm2", *FAST).code == 0
    assert snapshot(Path("out/arm2")) == snapshot(Path("alone/arm2"))
    (unchanged,) = run_batch([task], options, Path("out"), other, at_once=1)
    assert unchanged.status is Status.UNCHANGED
