"""State of a batch, in ``.stepbot-batch`` in its output folder: one small file per finished robot.

A robot is finished if its input is the same, by content, and every written file still exists unchanged. An interrupted
batch has such a file for each robot that it finished, and resumes with the others.
"""

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from stepbot.pipeline.conversion import Options
from stepbot.runtime.cache import file_digest
from stepbot.runtime.file import read_regular
from stepbot.step.exchange.input_files import input_digest

from ..incremental import conversion_key
from .tasks import Task
from .work import Work

FOLDER = ".stepbot-batch"
_VERSION = 1


@dataclass(frozen=True)
class _Done:
    input: str
    step: str
    files: Mapping[str, str]


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
        sidecar, geometry = file_digest(task.sidecar), input_digest(step)
        if sidecar is None or geometry is None:
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
        document = {"version": _VERSION, "input": work.input, "step": work.step, "files": files}
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
            if document["version"] != _VERSION:
                return None
            files = {str(name): str(digest) for name, digest in document["files"].items()}
            return _Done(str(document["input"]), str(document["step"]), files)
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None


def _sha256(path: Path) -> str:
    try:
        return hashlib.sha256(read_regular(path)).hexdigest()
    except OSError:
        return ""
