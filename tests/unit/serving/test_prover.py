"""What is shown is proven in a process of its own, which makes way for what is to be shown next."""

import os
import queue
import shutil
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from stepbot.pipeline.conversion import Conversion, Options
from stepbot.runtime.cache import Cache
from stepbot.serving.session import Session
from stepbot.serving.watching import CALM, Prover

PATIENCE = 120.0

pytestmark = pytest.mark.slow


@pytest.fixture
def shown(robot_library: Path, tmp_path: Path) -> Iterator[Session]:
    """The small arm, read."""
    folder = tmp_path / "arm"
    shutil.copytree(robot_library / "stepbot_arm2", folder)
    session = Session(folder / "arm2.robot.yaml", Options(output=Path(), cache=Cache(tmp_path / "cache")))
    session.load()
    yield session
    session.close()


@pytest.fixture
def proofs(shown: Session) -> Iterator[tuple[Prover, "queue.Queue[Conversion]"]]:
    """A prover of it, and what it reports."""
    reported: queue.Queue[Conversion] = queue.Queue()
    prover = Prover([shown], lambda _, conversion: reported.put(conversion))
    yield prover, reported
    prover.close()


def working(prover: Prover) -> int:
    """The id of the process, once it converts."""
    end = time.monotonic() + PATIENCE
    while (worker := prover._worker) is None or not prover._is_working:
        assert time.monotonic() < end
        time.sleep(0.005)
    return worker.pid


def test_a_proof_makes_way_for_the_next_robot(shown: Session, proofs: tuple[Prover, "queue.Queue[Conversion]"]) -> None:
    """Reading the target ends the proof that runs; the robot that is shown then is proven, once."""
    prover, reported = proofs
    prover.ask(shown)
    first = working(prover)
    shown.load()
    conversion = reported.get(timeout=PATIENCE)
    assert conversion.report is not None
    assert not conversion.diagnostics.has_errors
    assert {row.engine for row in conversion.report.rows()} >= {"mujoco"}
    assert reported.empty()
    with pytest.raises(ProcessLookupError):
        os.kill(first, 0)


def test_the_process_stays_for_the_next_proof(shown: Session, proofs: tuple[Prover, "queue.Queue[Conversion]"]) -> None:
    """It keeps what it loaded; a proof that has ended is not done again because the target is read."""
    prover, reported = proofs
    prover.ask(shown)
    first = working(prover)
    reported.get(timeout=PATIENCE)
    shown.target.write_text(shown.target.read_text(encoding="utf-8") + "\n# changed\n", encoding="utf-8")
    shown.load()
    prover.ask(shown)
    assert working(prover) == first
    assert not reported.get(timeout=PATIENCE).diagnostics.has_errors


def test_a_process_that_dies_is_an_error(shown: Session, proofs: tuple[Prover, "queue.Queue[Conversion]"]) -> None:
    """The reason is reported at the sidecar, and the next proof has another process."""
    prover, reported = proofs
    prover.ask(shown)
    os.kill(working(prover), signal.SIGKILL)
    [died] = reported.get(timeout=PATIENCE).diagnostics
    assert (died.code, died.span.file) == ("SB902", shown.target.as_posix())
    assert "SIGKILL" in died.message
    prover.ask(shown)
    assert not reported.get(timeout=PATIENCE).diagnostics.has_errors


def test_a_sidecar_with_errors_is_not_proven(shown: Session, proofs: tuple[Prover, "queue.Queue[Conversion]"]) -> None:
    """A save with errors ends the proof, and its errors are not reported twice; the repaired one is proven."""
    prover, reported = proofs
    good = shown.target.read_text(encoding="utf-8")
    prover.ask(shown)
    working(prover)
    shown.target.write_text(good.replace("links:", "lnks:"), encoding="utf-8")
    assert shown.load().diagnostics.has_errors
    with pytest.raises(queue.Empty):
        reported.get(timeout=4 * CALM)
    shown.target.write_text(good, encoding="utf-8")
    shown.load()
    prover.ask(shown)
    assert not reported.get(timeout=PATIENCE).diagnostics.has_errors
