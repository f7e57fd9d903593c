"""The robots of a batch, and the folder of each."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.file import resolved

from ..discovery import robot_name


@dataclass(frozen=True)
class Task:
    """One robot of a batch."""

    name: str
    """Unique in the batch."""
    sidecar: Path
    output: Path


def plan(sidecars: Sequence[Path], folder: Path, found: Diagnostics) -> list[Task]:
    """A task for each sidecar; robots of the same name are prefixed with their sidecar's folder.

    Args:
        sidecars: Without duplicates.
        folder: Receives one folder per robot.
        found: Receives SB008 if two robots would write to the same place.
    """
    names = [robot_name(sidecar) for sidecar in sidecars]
    shared = {name for name, count in Counter(names).items() if count > 1}
    names = [
        f"{resolved(sidecar).parent.name}-{name}" if name in shared else name
        for sidecar, name in zip(sidecars, names, strict=True)
    ]
    first: dict[str, Path] = {}
    for sidecar, name in zip(sidecars, names, strict=True):
        other = first.setdefault(name.casefold(), sidecar)
        if other != sidecar:
            message = f"'{other.as_posix()}' has the same name '{name}' and output folder"
            help = ["rename one of the sidecars or its folder"]
            found.add("SB008", message, Span(sidecar.as_posix()), help=help)
    return [Task(name, sidecar, folder / name) for sidecar, name in zip(sidecars, names, strict=True)]
