"""The robots of a batch, and the folder of each."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.file import resolved

from ..discovery import output_folder, robot_name


@dataclass(frozen=True)
class Task:
    """One robot of a batch."""

    name: str
    """Unique in the batch."""
    sidecar: Path
    output: Path


def plan(sidecars: Sequence[Path], output: Path, found: Diagnostics) -> list[Task]:
    """A task for each sidecar; robots of the same name are prefixed with their sidecar's folder.

    Args:
        sidecars: Without duplicates.
        output: Receives one folder per robot; or a template of these folders, with ``{name}`` in it, as for `uptodate`.
        found: Receives SB008 if two robots would write to the same place.

    Raises:
        ValueError: The template has another placeholder than ``{name}`` and ``{folder}``.
    """
    names = [robot_name(sidecar) for sidecar in sidecars]
    shared = {name for name, count in Counter(names).items() if count > 1}
    names = [
        f"{resolved(sidecar).parent.name}-{name}" if name in shared else name
        for sidecar, name in zip(sidecars, names, strict=True)
    ]
    template = str(output) if _is_template(output) else f"{output}/{{name}}"
    outputs = [output_folder(template, name, sidecar) for sidecar, name in zip(sidecars, names, strict=True)]
    first: dict[str, Path] = {}
    for sidecar, name, folder in zip(sidecars, names, outputs, strict=True):
        for key in (name.casefold(), f"{folder}/".casefold()):
            other = first.setdefault(key, sidecar)
            if other != sidecar:
                message = f"'{other.as_posix()}' has the same name '{name}' and output folder"
                help = ["rename one of the sidecars or its folder"]
                found.add("SB008", message, Span(sidecar.as_posix()), help=help)
                break
    return [Task(*one) for one in zip(names, sidecars, outputs, strict=True)]


def common_folder(output: Path) -> Path:
    """The folder of a whole batch: that of a template up to its first placeholder."""
    parts = list(takewhile(lambda part: "{" not in part, output.parts))
    return Path(*parts) if _is_template(output) else output


def _is_template(output: Path) -> bool:
    return "{" in str(output)
