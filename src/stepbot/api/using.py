"""``inspect``, ``draft``, ``render``, ``verify``, ``drive`` and ``close_loops``."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Ignore, Span
from stepbot.runtime.file import read_regular, replace_file
from stepbot.runtime.memory import DEFAULT_TIMEOUT

from .arguments import (
    AnyPath,
    Drafted,
    DriveResult,
    Rendered,
    Verification,
    argument,
    checked,
    codes_ignored,
    engines_required,
    known,
    reading,
    several,
)

if TYPE_CHECKING:
    from stepbot.pipeline.stages import Inspection


@checked
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

    return inspect_step(Path(step), reading(encoding, timeout, memory_limit, cache, ()))


@checked
def draft(
    step: AnyPath,
    *,
    output: AnyPath | None = None,
    description: AnyPath | None = None,
    answers: Mapping[str, str] | None = None,
    encoding: str = "",
    timeout: float = DEFAULT_TIMEOUT,
    memory_limit: int | None = None,
    cache: AnyPath | bool = True,
    package_path: AnyPath | Iterable[AnyPath] = (),
) -> Drafted:
    """Draft a sidecar from a STEP file: ``stepbot init``.

    Args:
        step: The STEP file.
        output: File for the sidecar, replaced if it exists; None to write nothing.
        description: URDF, SDFormat or MJCF of the same robot, whose names, joints, limits and masses are taken.
        answers: Answers to the ``questions`` of an earlier draft, by the names of the questions.
        encoding: Code page of names in the STEP.
        timeout: Time limit [s] of the geometry kernel.
        memory_limit: Address space [bytes] of worker processes; None for no limit.
        cache: Folder of the cache; True for the user's, False for none.
        package_path: Folder, or several, of the packages that ``description`` names.

    Returns:
        The draft, the text of the sidecar, and the diagnostics.
    """
    from stepbot.draft.text.sidecar_text import relative_step, sidecar_text
    from stepbot.pipeline.drafting import draft_step, write_draft
    from stepbot.sidecar.starter import starter_name

    path = Path(step)
    sidecar = Path(output) if output is not None else path.parent / starter_name(path)
    options = reading(encoding, timeout, memory_limit, cache, package_path)
    drafting = draft_step(path, options, Path(description) if description is not None else None, answers=answers)
    diagnostics = drafting.diagnostics
    if drafting.draft is None or diagnostics.has_errors:
        return Drafted(diagnostics)
    drafted = replace(drafting.draft, robot=sidecar.name.removesuffix(sidecar.suffix).removesuffix(".robot"))
    if output is None:
        return Drafted(diagnostics, drafted, sidecar_text(drafted, relative_step(path, sidecar), encoding=encoding))
    return Drafted(diagnostics, drafted, write_draft(drafted, sidecar, path, encoding, diagnostics))


@checked
def render(
    target: AnyPath,
    *,
    output: AnyPath | None = None,
    joints: Mapping[str, float] | None = None,
    view: str = "corner",
    labels: bool = False,
    size: tuple[int, int] = (1200, 900),
    samples: int = 3,
    encoding: str = "",
    timeout: float = DEFAULT_TIMEOUT,
    memory_limit: int | None = None,
    cache: AnyPath | bool = True,
    package_path: AnyPath | Iterable[AnyPath] = (),
) -> Rendered:
    """Draw a robot or a STEP file without a window: ``stepbot render``; needs ``stepbot[render]``.

    Args:
        target: Sidecar, STEP file, URDF, SDFormat or MJCF, or a folder that :func:`convert` wrote.
        output: PNG file to write; None to write nothing.
        joints: Positions [rad] or [m] of joints; the others are as drawn, or as loops require.
        view: ``corner``, ``iso``, ``front``, ``left``, ``back``, ``right``, ``top`` or ``bottom``.
        labels: Whether to name links and joints, or components.
        size: Width and height [px].
        samples: Square root of the number of rays for each pixel.
        encoding: Code page of names in the STEP; empty for the sidecar's.
        timeout: Time limit [s] of the geometry kernel.
        memory_limit: Address space [bytes] of worker processes; None for no limit.
        cache: Folder of the cache; True for the user's, False for none.
        package_path: Folder, or several, of the packages that a description names.

    Returns:
        The picture and the diagnostics.

    Raises:
        ModuleNotFoundError: A package of the extra ``render`` is missing.
        ValueError: There is no such view, a name in ``joints`` is not that of a moving joint, or the loops do not
            close there.
        OSError: ``output`` cannot be written.
    """
    from stepbot.pictures.camera import VIEWS
    from stepbot.pictures.picture import NothingToDraw, Sheet, draw, png_bytes
    from stepbot.pipeline.picturing import subject_of

    (chosen,) = known(view, VIEWS, "view", "view")
    diagnostics = Diagnostics()
    options = reading(encoding, timeout, memory_limit, cache, package_path)
    with argument("joints"):
        subject = subject_of(Path(target), options, joints or {}, diagnostics)
    if subject is None or diagnostics.has_errors:
        return Rendered(diagnostics)
    try:
        picture = draw(subject, Sheet(*size, samples=samples, view=VIEWS[chosen], labels=labels))
    except NothingToDraw as error:
        diagnostics.add("SB020", str(error), Span(Path(target).as_posix()))
        return Rendered(diagnostics)
    png = png_bytes(picture.pixels)
    if output is not None:
        replace_file(Path(output), png)
    return Rendered(diagnostics, png)


@checked
def verify(
    *files: AnyPath,
    require: str | Iterable[str] = (),
    strict: bool = False,
    ignore: str | Iterable[str] = (),
    timeout: float = DEFAULT_TIMEOUT,
    memory_limit: int | None = None,
    package_path: AnyPath | Iterable[AnyPath] = (),
    xacro: Mapping[str, str] | None = None,
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
        xacro: Values of the arguments of a xacro, by name.

    Returns:
        The report with every check, and the diagnostics.
    """
    from stepbot.runtime.worker import Workers
    from stepbot.verification.files import verify_files

    diagnostics = Diagnostics()
    diagnostics.ignore(Ignore(code, Span("stepbot")) for code in codes_ignored(ignore))
    report = verify_files(
        [Path(file) for file in files],
        diagnostics,
        require=engines_required(require),
        workers=Workers(timeout, memory_limit),
        packages=tuple(map(Path, several(package_path))),
        xacro=(xacro or {}).items(),
    )
    if strict:
        diagnostics.make_strict()
    return Verification(diagnostics, report)


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
        known(tests, TESTS, "test", "tests"),
        known(engines, ENGINES, "engine", "engines"),
        Path(limits) if limits is not None else None,
    )
    diagnostics = Diagnostics()
    driven = drive_target(Path(target), reading("", timeout, memory_limit, cache, package_path), chosen, diagnostics)
    return DriveResult(diagnostics, driven)


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
