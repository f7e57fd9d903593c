"""What ``stepbot drive`` drives: a sidecar's robot, a folder that was written, or one file of it."""

import json
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.driving.driving import Driven, drive_files, missing_engines, report_missing_engines
from stepbot.driving.limits import Demands, InvalidLimits, demands
from stepbot.driving.plan import ENGINES
from stepbot.formats import FORMATS
from stepbot.robot.step_names import is_step_name
from stepbot.runtime.file import exists, is_file, is_folder, read_regular
from stepbot.runtime.output import write_atomically
from stepbot.runtime.temporary import run_folder
from stepbot.verification.admission import located

from .conversion import REPORT, Options
from .sidecars import SIDECAR_SUFFIXES, report_missing

_LIMITS_FILE = (
    'a file of limits is `{"drive": {"limits": {"step": {"overshoot": [15, "reason"]}}}}`; '
    "beside `limits`: `tests`, `cube` [kg], `objects`"
)


class DriveOptions(Struct, frozen=True):
    """How to drive a robot."""

    tests: tuple[str, ...] = ()
    """Tests to run; empty for all that apply."""
    engines: tuple[str, ...] = ()
    """Engines that have to run; empty for those that are installed."""
    limits: Path | None = None
    """File with an object ``drive``; None for the default limits."""


def drive(
    target: Path,
    options: Options,
    chosen: DriveOptions,
    diagnostics: Diagnostics,
    progress: Callable[[str], None] = lambda stage: None,
) -> Driven | None:
    """Drive a target; None if it could not be driven.

    Args:
        target: Sidecar, output folder, or MJCF or URDF in one.
        options: Options of the conversion of a sidecar; limits of the engines.
    """
    if not exists(target):
        report_missing(target, diagnostics)
        return None
    demanded = read_demands(chosen.limits, diagnostics)
    missing = missing_engines(chosen.engines or ENGINES)
    if missing and (chosen.engines or len(missing) == len(ENGINES)):
        report_missing_engines(missing, diagnostics)
    if demanded is None or diagnostics.has_errors:
        return None
    with ExitStack() as kept:
        if target.suffix.lower() in SIDECAR_SUFFIXES or is_step_name(target.name):  # which a conversion rejects
            folder = Path(kept.enter_context(TemporaryDirectory(dir=run_folder())))
            if not _convert(target, folder, options, diagnostics, progress):
                return None
            target = folder
        progress("drive")
        copies = Path(kept.enter_context(TemporaryDirectory(dir=run_folder())))
        return _drive_written(target, chosen, missing, demanded, copies, options, diagnostics)


def read_demands(path: Path | None, diagnostics: Diagnostics) -> Demands | None:
    """The limits in a file's object ``drive``, and the default ones; None after SB833."""
    if path is None:
        return demands(None)
    span = Span(path.as_posix())
    try:
        content = json.loads(read_regular(path).decode("utf-8"))
        if not isinstance(content, dict):
            raise InvalidLimits("the file is not an object")
        return demands(content.get("drive"))
    except OSError as error:
        diagnostics.add("SB833", f"cannot be read: {error.strerror or error}", span, help=[_LIMITS_FILE])
    except ValueError as error:  # JSON, encoding or content
        diagnostics.add("SB833", str(error), span, help=[_LIMITS_FILE])
    return None


def _convert(
    sidecar: Path, folder: Path, options: Options, diagnostics: Diagnostics, progress: Callable[[str], None]
) -> bool:
    from .stages import produce

    formats = tuple(name for name in FORMATS if name in ENGINES.values())
    conversion = produce(sidecar, options._replace(formats=formats, verify=False), progress)
    diagnostics.extend(diagnostic for diagnostic in conversion.diagnostics if diagnostic.severity == "error")
    if conversion.diagnostics.has_errors:
        return False
    write_atomically(conversion.files, folder)
    return True


def _drive_written(
    target: Path,
    chosen: DriveOptions,
    missing: Mapping[str, str],
    demanded: Demands,
    copies: Path,
    options: Options,
    diagnostics: Diagnostics,
) -> Driven | None:
    """Drive a folder, or one file of a folder; ``copies`` receives files with absolute paths of meshes in packages."""
    folder = target if is_folder(target) else target.parent
    document = _report(folder, target, diagnostics)
    if document is None:
        return None
    engines = chosen.engines or tuple(ENGINES)
    files = _files(document, folder, target, engines)
    if not files:
        wanted = " or ".join(_suffix(name) for name in engines)
        diagnostics.add("SB833", f"no file {wanted} of the report's robot", Span(target.as_posix()))
        return None
    not_run = {engine: reason for engine, reason in missing.items() if engine in files}
    if len(not_run) == len(files):
        report_missing_engines(not_run, diagnostics)
        return None
    files = {engine: path for engine, path in files.items() if engine not in not_run}
    formats = {path: ENGINES[engine] for engine, path in files.items()}
    timeout, memory_limit = options.timeout, options.memory_limit
    places, _ = located(formats, options.package_path, copies, diagnostics, options.workers)
    if len(places) < len(formats):
        return None
    files = {engine: places[path] for engine, path in files.items()}
    try:
        driven = drive_files(
            document, files, demanded, diagnostics, tests=chosen.tests, timeout=timeout, memory_limit=memory_limit
        )
        return replace(driven, not_run={**not_run, **driven.not_run})
    except (KeyError, TypeError, ValueError) as error:
        diagnostics.add("SB833", f"{REPORT} is not the report of a robot: {error}", Span((folder / REPORT).as_posix()))
    return None


def _report(folder: Path, target: Path, diagnostics: Diagnostics) -> dict[str, Any] | None:
    """The report of a folder; None after SB833."""
    place = Span((folder / REPORT).as_posix())
    try:
        document = json.loads(read_regular(folder / REPORT).decode("utf-8"))
    except OSError:
        diagnostics.add("SB833", f"no {REPORT} in '{folder.as_posix()}'", Span(target.as_posix()))
        return None
    except ValueError as error:
        diagnostics.add("SB833", f"{REPORT} is not JSON: {error}", place)
        return None
    if not isinstance(document, dict) or not isinstance(document.get("robot"), dict):
        diagnostics.add("SB833", f"{REPORT} has no robot", place)
        return None
    if not isinstance(document.get("files"), list):
        diagnostics.add("SB833", f"{REPORT} is not the report of a robot: no list of files", place)
        return None
    return document


def _files(document: Mapping[str, Any], folder: Path, target: Path, engines: Iterable[str]) -> dict[str, Path]:
    """For each engine the file that it drives."""
    name = str(document["robot"].get("name", ""))
    listed = {one.get("path") for one in document["files"] if isinstance(one, Mapping)}
    files = {engine: folder / f"{name}{_suffix(engine)}" for engine in engines}
    chosen = {engine: path for engine, path in files.items() if is_file(path) and path.name in listed}
    if is_folder(target):
        return chosen
    return {engine: path for engine, path in chosen.items() if path.name == target.name}


def _suffix(engine: str) -> str:
    """Suffix of the file that an engine drives."""
    return FORMATS[ENGINES[engine]].suffix
