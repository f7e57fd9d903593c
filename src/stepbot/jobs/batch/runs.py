"""Plans and runs a batch; a failed robot does not affect the others.

A file per finished robot states what it was made of. A robot is finished if its input is the same, by content, and each
written file still exists unchanged. An interrupted batch resumes with the others.
"""

import hashlib
import json
import os
import time
from collections import Counter
from collections.abc import Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from enum import StrEnum
from itertools import takewhile
from pathlib import Path

from msgspec import Struct

from stepbot.diagnostics import Diagnostics, Span
from stepbot.pipeline.conversion import Conversion, Options, write
from stepbot.report.plain import plain, unpicked, value_at
from stepbot.runtime.cache import bytes_digest, files_digest
from stepbot.runtime.file import read_regular, resolved
from stepbot.runtime.output import stamp
from stepbot.runtime.worker import RemoteError, WorkerDied
from stepbot.step.exchange.input_files import combined_digest, input_digest, input_files

from ..discovery import output_folder, robot_name, variants_of
from ..incremental import conversion_key, failure_of, sidecar_digest
from .work import Parcel, Work, carry_out, carry_out_parcel


class Task(Struct, frozen=True):
    """One robot of a batch."""

    name: str
    """Unique in the batch."""
    sidecar: Path
    output: Path
    variant: str = ""
    """Variant of the sidecar; empty for the sidecar as it is."""


def plan(sidecars: Sequence[Path], output: Path, diagnostics: Diagnostics) -> list[Task]:
    """A task for each sidecar and each of its variants; robots of one name are prefixed with their sidecar's folder.

    Args:
        sidecars: Without duplicates.
        output: Receives one folder per robot; or a template of these folders, with ``{name}`` in it, as for `uptodate`.
        diagnostics: Receives SB008 if two robots would write to the same place.

    Raises:
        ValueError: The template has another placeholder than ``{name}`` and ``{folder}``.
    """
    planned = [(sidecar, variant) for sidecar in sidecars for variant in ("", *variants_of(sidecar))]
    names = [robot_name(*one) for one in planned]
    shared = {name for name, count in Counter(names).items() if count > 1}
    names = [
        f"{resolved(sidecar).parent.name}-{name}" if name in shared else name
        for (sidecar, _), name in zip(planned, names, strict=True)
    ]
    template = str(output) if _is_template(output) else f"{output}/{{name}}"
    outputs = [output_folder(template, name, sidecar) for (sidecar, _), name in zip(planned, names, strict=True)]
    first: dict[str, tuple[Path, str]] = {}
    for (sidecar, variant), name, folder in zip(planned, names, outputs, strict=True):
        for key in (name.casefold(), f"{folder}/".casefold()):
            other, earlier = first.setdefault(key, (sidecar, variant))
            if (other, earlier) != (sidecar, variant):
                whose = f"variant '{earlier}' of '{other.as_posix()}'" if earlier else f"'{other.as_posix()}'"
                message = f"{whose} has the same name '{name}' and output folder"
                help = ["rename one of the sidecars or its folder"]
                diagnostics.add("SB008", message, Span(sidecar.as_posix()), help=help)
                break
    return [
        Task(name, sidecar, folder, variant)
        for name, (sidecar, variant), folder in zip(names, planned, outputs, strict=True)
    ]


def common_folder(output: Path) -> Path:
    """The folder of a whole batch: that of a template up to its first placeholder."""
    parts = list(takewhile(lambda part: "{" not in part, output.parts))
    return Path(*parts) if _is_template(output) else output


def _is_template(output: Path) -> bool:
    return "{" in str(output)


FOLDER = ".stepbot-batch"
_VERSION = 1


class _Done(Struct, frozen=True):
    input: str
    step: str
    files: dict[str, str]
    read: tuple[str, ...]


class State:
    """The finished robots of one output folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder / FOLDER

    def is_done(self, task: Task, options: Options) -> bool:
        """Whether a robot's files exist and were made from its current input."""
        done = self._read(task)
        if done is None:
            return False
        step = Path(done.step)
        geometry = files_digest(map(Path, done.read)) if done.read else input_digest(step)
        sidecar = sidecar_digest(task.sidecar, options.variant)
        if not sidecar or geometry is None:
            return False
        if conversion_key(task.sidecar, sidecar, step, geometry, options) != done.input:
            return False
        return all(_sha256(task.output / name) == digest for name, digest in done.files.items())

    def begin(self, task: Task) -> None:
        """Forget a robot that is converted again."""
        self._path(task).unlink(missing_ok=True)

    def finish(self, task: Task, work: Work) -> None:
        """Record a robot whose files were written."""
        if not work.input:
            return
        files = {name: hashlib.sha256(content).hexdigest() for name, content in sorted(work.files.items())}
        document = {"version": _VERSION, **plain(_Done(work.input, work.step, files, work.read))}
        self._folder.mkdir(parents=True, exist_ok=True)
        path = self._path(task)
        draft = path.with_suffix(f".{os.getpid()}")
        draft.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8", newline="\n")
        draft.replace(path)

    def _path(self, task: Task) -> Path:
        return self._folder / f"{task.name}.json"

    def _read(self, task: Task) -> _Done | None:
        """None if the file is missing or invalid: then the robot is converted."""
        try:
            document = json.loads(read_regular(self._path(task)))
            is_known = value_at(document, "version", int) == _VERSION
            return unpicked(_Done, document, "input step files read") if is_known else None
        except (OSError, ValueError):
            return None


def _sha256(path: Path) -> str:
    try:
        return hashlib.sha256(read_regular(path)).hexdigest()
    except OSError:
        return ""


class Status(StrEnum):
    """Result of one robot."""

    CONVERTED = "converted"
    UNCHANGED = "unchanged"
    """Its input is unchanged, and its files are there."""
    FAILED = "failed"


class Outcome(Struct, frozen=True):
    """Result of one robot, with diagnostics."""

    task: Task
    status: Status
    diagnostics: Diagnostics
    files: int = 0
    """Number of files written in this run."""
    seconds: float = 0.0
    """Time from submission until the files were written."""


def run_batch(
    tasks: Sequence[Task], options: Options, folder: Path, executor: Executor, *, at_once: int, as_bytes: bool = False
) -> Generator[Outcome, None, None]:
    """Convert robots; yields each outcome as soon as it is available. Closing the iterator cancels pending robots.

    Args:
        options: Conversion options; ``output`` is set per task.
        folder: Folder of the batch's state.
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

    diagnostics = Diagnostics()
    step = step_of(task.sidecar, options, diagnostics)
    if step is None:
        return Work({}, tuple(diagnostics))
    try:
        text = read_regular(task.sidecar)
        files = {name: read_regular(path) for name, path in input_files(step).items()}
    except OSError as error:
        diagnostics.add("SB001", f"cannot be read: {error.strerror or error}", Span(str(error.filename)))
        return Work({}, tuple(diagnostics))
    geometry = combined_digest({name: bytes_digest(content) for name, content in files.items()})
    assert geometry is not None  # the first file was read
    key = conversion_key(task.sidecar, sidecar_digest(task.sidecar, options.variant), step, geometry, options)
    return Parcel(task.sidecar.as_posix(), text, str(step), files, options._replace(output=Path()), key)


def _result(future: "Future[Work]", task: Task) -> Work:
    """The outcome of a robot; any failure becomes a diagnostic of that robot only."""
    try:
        return future.result()
    except (WorkerDied, RemoteError) as error:
        diagnostics = failure_of(task.sidecar, error)
    except Exception as error:  # noqa: BLE001 - executors raise what they like, the other robots go on
        diagnostics, (first, *_) = Diagnostics(), (*str(error).splitlines(), "")
        diagnostics.add("SB901", f"internal error: {type(error).__name__}: {first}", Span(task.sidecar.as_posix()))
    return Work({}, tuple(diagnostics))


def _finished(task: Task, work: Work, state: State, began: float) -> Outcome:
    diagnostics = Diagnostics()
    diagnostics.extend(work.diagnostics)
    if (
        not write(Conversion(diagnostics, files=work.files), task.output, task.sidecar).files
        and not diagnostics.has_errors
    ):
        raise AssertionError(f"{task.name}: no files, and no error that states why")
    if not diagnostics.has_errors:
        state.finish(task, work)
    status = Status.FAILED if diagnostics.has_errors else Status.CONVERTED
    return Outcome(task, status, diagnostics, len(work.files), time.monotonic() - began)
