"""State of a batch, in ``.stepbot-batch`` in its output folder: one small file per finished robot.

A robot is finished if its input is the same, by content, and every written file still exists unchanged. An interrupted
batch has such a file for each robot that it finished, and resumes with the others.
"""

import hashlib
import json
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span
from stepbot.pipeline.conversion import Options
from stepbot.runtime.cache import files_digest
from stepbot.runtime.file import read_regular, resolved
from stepbot.step.exchange.input_files import input_digest

from ..discovery import output_folder, robot_name, variants_of
from ..incremental import conversion_key, sidecar_digest
from .work import Work


@dataclass(frozen=True)
class Task:
    """One robot of a batch."""

    name: str
    """Unique in the batch."""
    sidecar: Path
    output: Path
    variant: str = ""
    """Variant of the sidecar; empty for the sidecar as it is."""


def plan(sidecars: Sequence[Path], output: Path, found: Diagnostics) -> list[Task]:
    """A task for each sidecar and each of its variants; robots of one name are prefixed with their sidecar's folder.

    Args:
        sidecars: Without duplicates.
        output: Receives one folder per robot; or a template of these folders, with ``{name}`` in it, as for `uptodate`.
        found: Receives SB008 if two robots would write to the same place.

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
            other, of = first.setdefault(key, (sidecar, variant))
            if (other, of) != (sidecar, variant):
                whose = f"variant '{of}' of '{other.as_posix()}'" if of else f"'{other.as_posix()}'"
                message = f"{whose} has the same name '{name}' and output folder"
                help = ["rename one of the sidecars or its folder"]
                found.add("SB008", message, Span(sidecar.as_posix()), help=help)
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


@dataclass(frozen=True)
class _Done:
    input: str
    step: str
    files: Mapping[str, str]
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
        document = {"version": _VERSION, "input": work.input, "step": work.step, "files": files, "read": work.read}
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
            read = tuple(map(str, document.get("read", ())))
            return _Done(str(document["input"]), str(document["step"]), files, read)
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None


def _sha256(path: Path) -> str:
    try:
        return hashlib.sha256(read_regular(path)).hexdigest()
    except OSError:
        return ""
