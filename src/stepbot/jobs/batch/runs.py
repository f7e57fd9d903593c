"""Runs a batch; a failed robot does not affect the others."""

import time
from collections.abc import Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span
from stepbot.pipeline.conversion import Conversion, Options, write
from stepbot.runtime.cache import bytes_digest
from stepbot.runtime.file import read_regular
from stepbot.runtime.output import stamp
from stepbot.runtime.worker import RemoteError, WorkerDied
from stepbot.step.exchange.input_files import combined_digest, input_files

from ..incremental import conversion_key, sidecar_digest
from .state import State, Task
from .work import Parcel, Work, carry_out, carry_out_parcel


class Status(StrEnum):
    """Result of one robot."""

    CONVERTED = "converted"
    UNCHANGED = "unchanged"
    """Its input is unchanged, and its files are there."""
    FAILED = "failed"


@dataclass(frozen=True)
class Outcome:
    """Result of one robot, with diagnostics."""

    task: Task
    status: Status
    diagnostics: Diagnostics
    files: int = 0
    """Number of files written in this run."""
    seconds: float = 0.0
    """Time from submission until the files were written."""


def run_batch(
    tasks: Sequence[Task],
    options: Options,
    folder: Path,
    executor: Executor,
    *,
    at_once: int,
    as_bytes: bool = False,
) -> Generator[Outcome, None, None]:
    """Convert robots; yields each outcome as soon as it is available. Closing the iterator cancels pending robots.

    Args:
        options: Conversion options; ``output`` is set per task.
        folder: Folder of the batch's state.
        executor: Runs the conversions.
        at_once: Number of robots that the executor works on at a time; a few more are submitted.
        as_bytes: Whether input is sent with the tasks, for machines without access to the files.
    """
    state = State(folder)
    running: dict[Future[Work], tuple[Task, float]] = {}
    waiting = iter(tasks)
    left = True
    try:
        while left or running:
            while left and len(running) < 2 * at_once:
                task = next(waiting, None)
                if task is None:
                    left = False
                elif state.is_done(task, options._replace(variant=task.variant)):
                    stamp(task.output)
                    yield Outcome(task, Status.UNCHANGED, Diagnostics())
                else:
                    state.begin(task)
                    running[_submitted(executor, task, options, as_bytes)] = (task, time.monotonic())
            if running:
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in sorted(done, key=lambda one: running[one][1]):
                    task, began = running.pop(future)
                    yield _finished(task, _result(future, task), state, began)
    finally:
        for future in running:
            future.cancel()


def _submitted(executor: Executor, task: Task, options: Options, as_bytes: bool) -> Future[Work]:
    own = options._replace(output=task.output, variant=task.variant)
    parcel = _parcel(task, own) if as_bytes else None
    if isinstance(parcel, Work):
        ready: Future[Work] = Future()
        ready.set_result(parcel)
        return ready
    if parcel is not None:
        return executor.submit(carry_out_parcel, parcel)
    return executor.submit(carry_out, task.sidecar, own)


def _parcel(task: Task, options: Options) -> Parcel | Work:
    """A robot's input as bytes; or the errors of the sidecar."""
    from stepbot.pipeline.stages import step_of

    found = Diagnostics()
    step = step_of(task.sidecar, options, found)
    if step is None:
        return Work({}, tuple(found))
    try:
        text = read_regular(task.sidecar)
        files = {name: read_regular(path) for name, path in input_files(step).items()}
    except OSError as error:
        found.add("SB001", f"cannot be read: {error.strerror or error}", Span(str(error.filename)))
        return Work({}, tuple(found))
    geometry = combined_digest({name: bytes_digest(content) for name, content in files.items()})
    assert geometry is not None  # the first file was read
    key = conversion_key(task.sidecar, sidecar_digest(task.sidecar, options.variant), step, geometry, options)
    return Parcel(task.sidecar.as_posix(), text, str(step), files, options._replace(output=Path()), key)


def _result(future: "Future[Work]", task: Task) -> Work:
    """The outcome of a robot; any failure becomes a diagnostic of that robot only."""
    found, span = Diagnostics(), Span(task.sidecar.as_posix())
    try:
        return future.result()
    except WorkerDied as death:
        found.add("SB902", f"conversion failed: {death.reason}", span, notes=death.last_lines)
    except RemoteError as error:
        found.add("SB901", f"internal error: {error.kind}: {error.text}", span, notes=error.trace.splitlines()[-3:])
    except Exception as error:  # noqa: BLE001 - executors raise what they like, the other robots go on
        found.add("SB901", f"internal error: {type(error).__name__}: {str(error).splitlines()[:1]}", span)
    return Work({}, tuple(found))


def _finished(task: Task, work: Work, state: State, began: float) -> Outcome:
    found = Diagnostics()
    found.extend(work.diagnostics)
    if not write(Conversion(found, files=work.files), task.output, task.sidecar).files and not found.has_errors:
        raise AssertionError(f"{task.name}: no files, and no error that says why")
    if not found.has_errors:
        state.finish(task, work)
    status = Status.FAILED if found.has_errors else Status.CONVERTED
    return Outcome(task, status, found, len(work.files), time.monotonic() - began)
