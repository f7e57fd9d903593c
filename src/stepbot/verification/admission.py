"""Rejects files that engines must not read: with entities, includes from other folders, pipes or devices."""

from collections.abc import Mapping
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines.file_references import Refusal
from stepbot.runtime.worker import Start, Worker, WorkerDied

_REFUSALS = "stepbot.engines.file_references:refusals"


def admitted(
    formats: Mapping[Path, str],
    found: Diagnostics,
    *,
    timeout: float,
    memory_limit: int | None = None,
    start: Start | None = None,
) -> dict[Path, str]:
    """The files that engines may read, each with its format.

    Args:
        formats: The files and their formats.
        found: Receives SB820, SB821 and SB822 for rejected files.
        timeout: Time limit [s] of the check of one file.
        memory_limit: Address space [bytes] of the process that checks; None for no limit.
        start: Starts that process; None to start a new interpreter.
    """
    kept = {}
    for path, written_in in formats.items():
        with Worker(_REFUSALS, memory_limit=memory_limit, start=start) as worker:
            try:
                refusals: tuple[Refusal, ...] = worker.submit(str(path), written_in).result(timeout)
            except WorkerDied as death:
                message = f"the process that reads the file's references died: {death.reason}"
                found.add("SB902", message, Span(path.as_posix()), notes=death.last_lines)
                continue
        for one in refusals:
            found.add(one.code, one.message, Span(Path(one.file).as_posix(), one.line))
        if not refusals:
            kept[path] = written_in
    return kept
