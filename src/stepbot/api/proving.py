"""``verify``, ``drive`` and ``close_loops``."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from stepbot.diagnostics import Diagnostics, Ignore, Span
from stepbot.runtime.file import read_regular
from stepbot.runtime.memory import DEFAULT_TIMEOUT

from .arguments import AnyPath, DriveResult, Verification, checked, known, reading, several


@checked
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
    found.ignore(Ignore(code, Span("stepbot")) for code in several(ignore))
    report = verify_files(
        [Path(file) for file in files],
        found,
        require=several(require),
        timeout=timeout,
        memory_limit=memory_limit,
        packages=tuple(map(Path, several(package_path))),
    )
    if strict:
        found.make_strict()
    return Verification(found, report)


@checked
def drive(
    target: AnyPath,
    *,
    tests: str | Iterable[str] = (),
    engines: str | Iterable[str] = (),
    limits: AnyPath | None = None,
    timeout: float = DEFAULT_TIMEOUT,
    memory_limit: int | None = None,
    cache: AnyPath | bool = True,
    package_path: AnyPath | Iterable[AnyPath] = (),
) -> DriveResult:
    """Move a robot by its actuators in MuJoCo and PyBullet, and judge how it behaves: ``stepbot drive``.

    Args:
        target: Sidecar, a folder that :func:`convert` wrote, or an MJCF or URDF in one.
        tests: Test to run, or several; empty for all that apply.
        engines: Engine that has to run, or several; empty for those that are installed.
        limits: JSON file whose object ``drive`` has the robot's own limits; None for the default ones.
        timeout: Time limit [s] of the geometry kernel and of each engine.
        memory_limit: Address space [bytes] of worker processes; None for no limit.
        cache: Folder of the cache; True for the user's, False for none.
        package_path: Folder, or several, of the packages that the files name.

    Returns:
        The verdicts and the diagnostics.

    Raises:
        ValueError: There is no such test or engine.
    """
    from stepbot.driving.plan import ENGINES, TESTS
    from stepbot.pipeline.driving import DriveOptions
    from stepbot.pipeline.driving import drive as drive_target

    chosen = DriveOptions(
        known(tests, TESTS, "test"), known(engines, ENGINES, "engine"), Path(limits) if limits is not None else None
    )
    found = Diagnostics()
    driven = drive_target(Path(target), reading("", timeout, memory_limit, cache, package_path), chosen, found)
    return DriveResult(found, driven)


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
