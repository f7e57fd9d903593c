"""The functions that ``import stepbot`` offers; see ``docs/api.md``.

Each function does the same as the command of the same name and returns what that command prints. No function prints, or
raises for invalid input: results carry their diagnostics. To get exceptions instead, call
``result.diagnostics.raise_if_errors()``.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

from stepbot.diagnostics import Diagnostic, Diagnostics, Ignore, Span, StepbotError
from stepbot.formats import FORMATS, default_formats, format_named
from stepbot.formats.sdformat.model_name import model_name
from stepbot.formats.urdf.package import package_of
from stepbot.pipeline.conversion import Checked, Conversion, Options
from stepbot.runtime.cache import Cache, default_folder
from stepbot.runtime.file import read_regular
from stepbot.runtime.limits import DEFAULT_TIMEOUT

if TYPE_CHECKING:
    from stepbot.pipeline.stages import Inspection
    from stepbot.report.record import Report

AnyPath = str | PathLike[str]
_One = TypeVar("_One", bound=AnyPath)


@dataclass(frozen=True)
class CheckResult:
    """The result of :func:`check`."""

    diagnostics: Diagnostics
    checked: Checked
    """Number of links and joints; the joint table if the STEP was read."""


@dataclass(frozen=True)
class Verification:
    """The result of :func:`verify`."""

    diagnostics: Diagnostics
    report: "Report"


def convert(
    sidecar: AnyPath,
    *,
    output: AnyPath | None = None,
    formats: str | Iterable[str] = (),
    step: AnyPath | None = None,
    encoding: str = "",
    verify: bool = True,
    strict: bool = False,
    require: str | Iterable[str] = (),
    ignore: str | Iterable[str] = (),
    timeout: float = DEFAULT_TIMEOUT,
    memory_limit: int | None = None,
    cache: AnyPath | bool = True,
    html: bool = False,
    package: str = "",
    ros2: str = "",
    maintainer: str = "",
    license: str = "",
    gazebo: bool = False,
    base: str = "",
    package_path: AnyPath | Iterable[AnyPath] = (),
) -> Conversion:
    """Convert the robot that a sidecar describes, verify the files, and write them: ``stepbot convert``.

    Args:
        sidecar: The sidecar, or a URDF, SDFormat or MJCF in its place.
        output: Folder for the files; None for a folder in the current one, named after the sidecar.
        formats: Name or alias of a format, or several; empty for the default ones.
        step: STEP file to read instead of the one named in the sidecar.
        encoding: Code page of names in the STEP; empty for the sidecar's.
        verify: Whether to load the files in engines and compare the results.
        strict: Whether warnings are errors.
        require: Engine, or several, whose absence is an error.
        ignore: Code of warnings and notes, or several, to suppress.
        timeout: Time limit [s] of the geometry kernel and of each engine.
        memory_limit: Address space [bytes] of worker processes; None for no limit.
        cache: Folder of the cache; True for the user's, False for none.
        html: Whether to write the report as a page, too.
        package: ROS package that the URDF names in the paths of its meshes; empty for paths relative to the file.
        ros2: Make ``output`` the ROS 2 package ``<ros2>_description``; empty to write robot files alone.
        maintainer: Name and address for packages, ``Ada Lovelace <ada@example.com>``; empty for the sidecar's.
        license: Licence for packages; empty for the sidecar's.
        gazebo: Make ``output`` a Gazebo model, found by the name of the folder.
        base: ``fixed`` or ``floating``, for a URDF, which does not say; empty for fixed, with a warning.
        package_path: Folder, or several, of the packages that a URDF, SDFormat or MJCF names in ``package://`` and ``model://``.

    Returns:
        The files by path relative to ``output``, the report, and the diagnostics. After an error the previous files in
            ``output`` are unchanged.

    Raises:
        ValueError: A name in ``formats`` is not a format, or ``package`` or ``ros2`` not the name of a package; both
            are given, or URDF is not written. ``maintainer`` is not a name and an address. For ``gazebo``, SDFormat is
            not written, or the folder's name cannot be that of a model.
    """
    from stepbot.jobs.incremental import convert as convert_unless_unchanged
    from stepbot.robot.metadata import is_maintainer

    if maintainer and not is_maintainer(maintainer):
        raise ValueError(f"'{maintainer}' is not a name and an address: Ada Lovelace <ada@example.com>")
    path, written = Path(sidecar), _format_names(formats)
    name = path.name.removesuffix(path.suffix).removesuffix(".robot")
    folder = Path(output) if output is not None else Path(name)
    options = Options(
        output=folder,
        formats=written,
        step=Path(step) if step is not None else None,
        encoding=encoding,
        verify=verify,
        strict=strict,
        require=_several(require),
        ignore=_several(ignore),
        timeout=timeout,
        memory_limit=memory_limit,
        cache=_cache(cache),
        html=html,
        package=package_of(package, ros2, written),
        ros2=bool(ros2),
        maintainer=maintainer,
        license=license,
        gazebo=model_name(folder, written) if gazebo else "",
        base=base,
        package_path=tuple(map(Path, _several(package_path))),
    )
    return convert_unless_unchanged(path, options)


def check(
    sidecar: AnyPath,
    *,
    open_step: bool = False,
    step: AnyPath | None = None,
    ignore: str | Iterable[str] = (),
    timeout: float = DEFAULT_TIMEOUT,
    memory_limit: int | None = None,
    cache: AnyPath | bool = True,
) -> CheckResult:
    """Check a sidecar without writing anything: ``stepbot check``.

    Args:
        sidecar: The sidecar.
        open_step: Whether to read the STEP, bind all paths and find all axes.
        step: STEP file to read instead of the one named in the sidecar.
        ignore: Code of warnings and notes, or several, to suppress.
        timeout: Time limit [s] of the geometry kernel.
        memory_limit: Address space [bytes] of worker processes; None for no limit.
        cache: Folder of the cache; True for the user's, False for none.

    Returns:
        The diagnostics; the numbers of links and joints, and the joint table if the STEP was read.
    """
    from stepbot.jobs.incremental import check as check_unless_unchanged

    found = Diagnostics()
    options = Options(
        output=Path(),
        step=Path(step) if step is not None else None,
        ignore=_several(ignore),
        timeout=timeout,
        memory_limit=memory_limit,
        cache=_cache(cache),
    )
    checked = check_unless_unchanged(Path(sidecar), options, found, open_step=open_step or step is not None)
    return CheckResult(found, checked)


def inspect(
    step: AnyPath,
    *,
    encoding: str = "",
    timeout: float = DEFAULT_TIMEOUT,
    memory_limit: int | None = None,
    cache: AnyPath | bool = True,
) -> "Inspection":
    """Read a STEP file, or the one named in a sidecar: ``stepbot inspect``.

    Args:
        step: STEP file or sidecar.
        encoding: Code page of names in the STEP; empty for the sidecar's.
        timeout: Time limit [s] of the geometry kernel.
        memory_limit: Address space [bytes] of worker processes; None for no limit.
        cache: Folder of the cache; True for the user's, False for none.

    Returns:
        The assembly with its components, bodies and axis lines, or None after an error; trimesh's mass properties of
            each body; and the diagnostics.
    """
    from stepbot.pipeline.stages import inspect as inspect_step

    options = Options(output=Path(), encoding=encoding, timeout=timeout, memory_limit=memory_limit, cache=_cache(cache))
    return inspect_step(Path(step), options)


def verify(
    *files: AnyPath,
    require: str | Iterable[str] = (),
    strict: bool = False,
    ignore: str | Iterable[str] = (),
    timeout: float = DEFAULT_TIMEOUT,
    memory_limit: int | None = None,
    package_path: AnyPath | Iterable[AnyPath] = (),
) -> Verification:
    """Load URDF, SDFormat and MJCF files in all engines and compare the results: ``stepbot verify``.

    Args:
        files: The files, not necessarily written by stepbot; several are compared as one robot.
        require: Engine, or several, whose absence is an error.
        strict: Whether warnings are errors.
        ignore: Code of warnings and notes, or several, to suppress.
        timeout: Time limit [s] of each engine.
        memory_limit: Address space [bytes] of worker processes; None for no limit.
        package_path: Folder, or several, of the packages that a URDF or SDFormat names in ``package://`` and ``model://``.

    Returns:
        The report with every check, and the diagnostics.
    """
    from stepbot.verification import verify_files

    found = Diagnostics()
    found.ignore(Ignore(code, Span("stepbot")) for code in _several(ignore))
    report = verify_files(
        [Path(file) for file in files],
        found,
        require=_several(require),
        timeout=timeout,
        memory_limit=memory_limit,
        packages=tuple(map(Path, _several(package_path))),
    )
    if strict:
        found.make_strict()
    return Verification(found, report)


def close_loops(body: int, report: AnyPath | Mapping[str, Any], client: int = 0) -> list[int]:
    """Add the loop closures of a robot to PyBullet, which reads them from no file.

    Args:
        body: Id returned by ``pybullet.loadURDF``. Its joints must be at positions that close the loops.
        report: ``report.json`` of the robot, as a path or as the parsed document.
        client: Id returned by ``pybullet.connect``.

    Returns:
        Ids of the constraints; none for a robot without closures.

    Raises:
        KeyError: The body does not have a link that a closure refers to.
        OSError: The report cannot be read.
        ValueError: The report is not JSON.
    """
    from stepbot.robot.pybullet_closures import add_constraints

    document = report if isinstance(report, Mapping) else json.loads(read_regular(Path(report)).decode("utf-8"))
    return add_constraints(body, document["robot"]["pybullet"], client)


def _several(given: "_One | Iterable[_One]") -> "tuple[_One, ...]":
    """One or several: a string is one, not its letters."""
    if isinstance(given, str | PathLike):
        return (cast("_One", given),) if given else ()
    return tuple(given)


def _format_names(given: str | Iterable[str]) -> tuple[str, ...]:
    names: tuple[str, ...] = _several(given)
    if not names:
        return default_formats()

    try:
        return tuple(dict.fromkeys(format_named(name).name for name in names))
    except KeyError as error:
        raise ValueError(f"no format {error}; there are {', '.join(FORMATS)}") from None


def _cache(where: AnyPath | bool) -> Cache | None:
    if where is False:
        return None
    return Cache(default_folder() if where is True else Path(where))


__all__ = [
    "CheckResult",
    "Conversion",
    "Diagnostic",
    "Diagnostics",
    "StepbotError",
    "Verification",
    "check",
    "close_loops",
    "convert",
    "inspect",
    "verify",
]
