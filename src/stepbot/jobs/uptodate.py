"""Checks whether written files are up to date.

Robot files and meshes are compared byte by byte, ``report.json`` only in the parts that depend on the input alone: the
robot, its bodies, names and joints. The verification results depend on the installed engines, and the diagnostics on
options. ``report.html`` is not compared, nor are pictures, whose pixels depend on the processor. No engine is started,
so the result is the same on every machine.
"""

import fnmatch
import json
import os
import shlex
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.formats import FORMATS, default_formats
from stepbot.pipeline.conversion import REPORT, REPORT_PAGE, Options
from stepbot.runtime.file import exists, is_folder, read_regular, resolved
from stepbot.runtime.output_list import MANIFEST, OutputList

from .incremental import check, produce, recorded


def output_folders(below: Path) -> dict[Path, dict[Path, str]]:
    """The output folders at and below a folder, except hidden ones, by the sidecar in their file lists.

    Returns:
        For each sidecar, as an absolute path, the folders that hold files converted from it, by name, each with the
        variant of the sidecar.
    """
    folders: dict[Path, dict[Path, str]] = {}
    for place, subfolders, files in os.walk(below):
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
        if MANIFEST in files:
            folder = Path(place)
            for sidecar in dict.fromkeys(OutputList.read(folder).sidecars.values()):
                folders.setdefault(resolved(folder / sidecar), {})[folder] = _variant(folder)
    return folders


def _variant(folder: Path) -> str:
    """The variant in a folder's report; empty for none, or without a report."""
    try:
        return str(json.loads(read_regular(folder / REPORT)).get("variant", ""))
    except (OSError, ValueError, AttributeError):
        return ""


def check_up_to_date(
    sidecar: Path,
    options: Options,
    diagnostics: Diagnostics,
    *,
    exclude: Iterable[str] = (),
    progress: Callable[[str], None] = lambda stage: None,
) -> None:
    """Compare the files in ``options.output`` with those of a conversion; writes nothing.

    Args:
        diagnostics: Receives faults of the input, and SB007 for each file that differs, or for a missing folder.
        exclude: Globs of files that are not compared, relative to the folder.
    """
    excluded = tuple(exclude)
    folder = options.output
    remedy = [f"`{shlex.join(_command(sidecar, options))}`"]
    if exists(sidecar) and not is_folder(folder):
        faults = Diagnostics()
        check(sidecar, options, faults)
        if faults.has_errors:  # no output folder would help
            diagnostics.extend(faults)
            return
        what = f"output folder of '{sidecar.as_posix()}' does not exist"
        diagnostics.add("SB007", what, Span(folder.as_posix()), help=[*remedy, "choose another folder with `-o DIR`"])
        return
    expected, reported = _expected(sidecar, options, progress)
    if not expected:
        diagnostics.extend(reported)
        return
    files = {name: content for name, content in expected.items() if not _is_excluded(name, (*excluded, "*.png"))}
    if not exists(folder / REPORT):
        files.pop(REPORT, None)
    for name, what in _differences(files, folder):
        diagnostics.add("SB007", what, Span((folder / name).as_posix()), help=remedy)
    for name in _left_over(expected, folder, sidecar):
        if name != REPORT_PAGE and not _is_excluded(name, excluded):
            diagnostics.add("SB007", "no longer written", Span((folder / name).as_posix()), help=[_for_left_over(name)])


def _command(sidecar: Path, options: Options) -> list[str]:
    """The command that writes the files."""
    command = ["stepbot", "convert", sidecar.as_posix(), "-o", options.output.as_posix()]
    if options.variant:
        command += ["--variant", options.variant]
    if options.formats != default_formats():
        command += ["-f", ",".join(options.formats)]
    if options.ros2:
        command += ["--ros2", options.package]
    elif options.package:
        command += ["--package", options.package]
    if options.programs:
        command += ["--for", ",".join(options.programs)]
    return command + (["--gazebo"] if options.gazebo else [])


def _for_left_over(name: str) -> str:
    """What to do with a file that a conversion would not write."""
    from stepbot.formats.learning import FOLDERS, PROGRAMS

    program = next((one for one in PROGRAMS if "/" not in name and name.endswith(f"_{one}.py")), "")
    program = program or next((one for one in FOLDERS if name.startswith(f"{one}/")), "")
    if program:
        return f"remove it, or add {program} to `--for` of `uptodate`"
    of_format = next((one.name for one in FORMATS.values() if "/" not in name and name.endswith(one.suffix)), "")
    return f"remove it, or add {of_format} to `-f` of `uptodate`" if of_format else "remove it"


def _expected(
    sidecar: Path, options: Options, progress: Callable[[str], None]
) -> tuple[Mapping[str, bytes], Iterable[Diagnostic]]:
    """The files of a conversion; none if it would end in errors, which are then reported."""
    for verify in (True, False):  # whichever has been done before
        record = recorded(sidecar, options._replace(verify=verify))
        if record is not None:
            return record.files, record.diagnostics
    conversion = produce(sidecar, options._replace(verify=False), progress)
    return ({} if conversion.diagnostics.has_errors else conversion.files), conversion.diagnostics


def _differences(files: Mapping[str, bytes], folder: Path) -> list[tuple[str, str]]:
    different = []
    for name, content in files.items():
        try:
            there = read_regular(folder / name)
        except OSError:
            different.append((name, "missing"))
            continue
        if there != content and not (name == REPORT and _same_robot(there, content)):
            different.append((name, "differs from the current output"))
    return different


def _same_robot(report: bytes, expected: bytes) -> bool:
    """Whether two reports differ only in verification results and diagnostics."""
    try:
        return _robot_part(json.loads(report)) == _robot_part(json.loads(expected))
    except (ValueError, KeyError, TypeError, AttributeError):  # edited by hand
        return False


def _robot_part(document: Mapping[str, Any]) -> list[Any]:
    """The part of a report that depends on the input only, not on engines, version of stepbot and options."""
    robot = {key: value for key, value in document["robot"].items() if key != "overlaps"}  # set by verification
    return [robot, *(document[key] for key in ("version", "names", "bodies", "joint_table"))]


def _left_over(files: Mapping[str, bytes], folder: Path, sidecar: Path) -> list[str]:
    """Existing files that an earlier run wrote for this sidecar, by its own list."""
    sources = OutputList.read(folder).sidecars
    try:
        written = json.loads(read_regular(folder / MANIFEST))["files"]
        ours = [
            name for name in written if resolved(folder / sources.get(name, resolved(sidecar))) == resolved(sidecar)
        ]
        needed_by_others = {path for name in written if name not in ours for path in written[name]}
        names = sorted({*ours, *(path for name in ours for path in written[name])} - needed_by_others)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):  # unknown origin
        return []
    return [name for name in names if name not in files and exists(folder / name)]


def _is_excluded(name: str, globs: tuple[str, ...]) -> bool:
    return any(fnmatch.fnmatchcase(name, glob) for glob in globs)
