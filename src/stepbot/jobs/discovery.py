"""Finds sidecars by path, in folders, and in lists."""

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from shlex import join

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.file import is_folder, read_regular, resolved

_SIDECAR = re.compile(r"(?:^|\.)robot\.ya?ml$")
"""Names of sidecars, as in the hooks for pre-commit."""
_LIST = ".txt"
_HAS_VARIANTS = re.compile(r"(?m)^[\"']?variants[\"']?\s*:")


def find_sidecars(named: Iterable[Path], diagnostics: Diagnostics) -> list[Path]:
    """The sidecars of a list of paths, without duplicates, in order.

    Args:
        named: Sidecars; folders, for all sidecars below them except in hidden folders; or ``.txt`` files that list any
            of these, one per line, relative to the list. A line may be empty or begin with ``#``.
        diagnostics: Receives SB001 for an unreadable list, and for a folder without sidecars.
    """
    sidecars: dict[Path, None] = {}
    for path in without_lists(named, diagnostics):
        sidecars.update(dict.fromkeys(_in_folder(path, diagnostics) if is_folder(path) else [path]))
    return list(sidecars)


def without_lists(named: Iterable[Path], diagnostics: Diagnostics) -> Iterator[Path]:
    """The sidecars and folders of a list of paths, with what lists name in place of the lists (SB001: unreadable)."""
    waiting, read = list(named)[::-1], set[Path]()
    while waiting:
        path = waiting.pop()
        if path.suffix != _LIST or is_folder(path):
            yield path
        elif resolved(path) not in read:  # lists may name each other
            read.add(resolved(path))
            waiting += _listed(path, diagnostics)[::-1]


def _listed(path: Path, diagnostics: Diagnostics) -> list[Path]:
    try:
        lines = read_regular(path).decode("utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        diagnostics.add("SB001", f"cannot read the list of sidecars: {error}", Span(path.as_posix()))
        return []
    entries = [line.strip() for line in lines]
    return [path.parent / entry for entry in entries if entry and not entry.startswith("#")]


def _in_folder(folder: Path, diagnostics: Diagnostics) -> list[Path]:
    below = _below(folder)
    if not below:
        from stepbot.pipeline.conversion import is_description
        from stepbot.robot.step_names import is_step_name

        inside = sorted(folder.iterdir())
        drafts = [
            f"`{join(['stepbot', 'init', one.as_posix()])}` drafts one" for one in inside if is_step_name(one.name)
        ]
        named = [f"batch takes descriptions by their path: '{one.as_posix()}'" for one in inside if is_description(one)]
        help = ["sidecars are named `<robot>.robot.yaml`", *drafts[:1], *named[:1]]
        diagnostics.add("SB001", "no sidecars in this folder", Span(folder.as_posix()), help=help)
    return below


def _below(folder: Path) -> list[Path]:
    sidecars = []
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        sidecars += [Path(place, name) for name in sorted(files) if _SIDECAR.search(name)]
    return sidecars


def variants_of(sidecar: Path) -> tuple[str, ...]:
    """The names of a sidecar's variants; none if it cannot be read, which its conversion reports."""
    try:
        text = read_regular(sidecar).decode("utf-8")
    except (OSError, UnicodeDecodeError):
        return ()
    if not _HAS_VARIANTS.search(text):  # most sidecars: nothing is imported
        return ()
    from stepbot.sidecar.variants import variant_names

    return variant_names(text)


def robot_name(sidecar: Path, variant: str = "") -> str:
    """Name of a sidecar's output: ``arm`` of ``arm.robot.yaml`` or ``arm/robot.yaml``, ``arm_long`` of a variant."""
    name = sidecar.name.removesuffix(sidecar.suffix).removesuffix(".robot")
    name = (resolved(sidecar).parent.name or name) if name == "robot" else name
    return f"{name}_{variant}" if variant else name


def output_folder(template: str, name: str, sidecar: Path) -> Path:
    """The folder that ``-o`` names for one of several robots.

    Args:
        template: Path in which ``{name}`` is the robot and ``{folder}`` the folder of its sidecar.

    Raises:
        ValueError: The template has another placeholder, or a single brace.
    """
    from string import Formatter

    values = {"name": name, "folder": sidecar.parent.as_posix()}
    try:
        fields = {
            (field, spec, conversion) for _, field, spec, conversion in Formatter().parse(template) if field is not None
        }
    except ValueError:
        fields = {("", "", None)}
    if not fields <= {(known, "", None) for known in values}:
        raise ValueError(f"'{template}' contains a placeholder other than {{name}} and {{folder}}")
    return Path(template.format(**values))
