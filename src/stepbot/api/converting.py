"""``convert`` and ``check``."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from stepbot.diagnostics import Diagnostics
from stepbot.formats.sdformat.model_name import model_name
from stepbot.formats.urdf.package import package_of
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.runtime.memory import DEFAULT_TIMEOUT

from .arguments import (
    AnyPath,
    CheckResult,
    argument,
    cache_at,
    checked,
    code_page_of,
    codes_ignored,
    engines_required,
    format_names,
    several,
)


@checked
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
    programs: str | Iterable[str] = (),
    base: str = "",
    package_path: AnyPath | Iterable[AnyPath] = (),
    xacro: Mapping[str, str] | None = None,
    assume_inertia: float = 0.0,
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
        programs: Program for learning, or several, that get a Python file which loads the robot; their formats are
            written, too.
        base: ``fixed`` or ``floating``, for a URDF, which does not state it; empty for fixed, with a warning.
        package_path: Folder, or several, of the packages that a URDF, SDFormat or MJCF names in ``package://`` and ``model://``.
        xacro: Values of the arguments of a xacro, by name.
        assume_inertia: Density [kg/m^3] from which links of a URDF, SDFormat or MJCF without possible mass properties
            get some from their geometry, each reported; 0 to reject such files.

    Returns:
        The files by path relative to ``output``, the report, and the diagnostics. After an error the previous files in
            ``output`` are unchanged.

    Raises:
        ValueError: A name in ``formats`` is not a format, in ``programs`` not a program, in ``require`` not an engine,
            in ``ignore`` not a code; ``encoding`` is not a code page; ``package`` or ``ros2`` is not the name of a
            package; both are given, or URDF is not written. ``maintainer`` is not a name and an address. For
            ``gazebo``, SDFormat is not written, or the folder's name cannot be that of a model. The message starts with
            the argument.
        TypeError: An argument has a wrong type, or there is none of this name.
    """
    from stepbot.formats.learning import formats_for, program_names
    from stepbot.jobs.incremental import convert as convert_unless_unchanged
    from stepbot.robot.metadata import is_maintainer

    if maintainer and not is_maintainer(maintainer):
        raise ValueError(f"maintainer: '{maintainer}' is not a name and an address: Ada Lovelace <ada@example.com>")
    if base not in ("", "fixed", "floating"):
        raise ValueError(f"base: '{base}' is neither 'fixed' nor 'floating'")
    if assume_inertia < 0.0:
        raise ValueError(f"assume_inertia: {assume_inertia!r} is not a density")
    if require and not verify:
        raise ValueError("require and verify=False cannot be combined")
    with argument("programs"):
        loaded_by = program_names(several(programs))
    path, written = Path(sidecar), formats_for(loaded_by, format_names(formats))
    name = path.name.removesuffix(path.suffix).removesuffix(".robot")
    folder = Path(output) if output is not None else Path(name)
    with argument("package" if package else "ros2"):
        meshes_of = package_of(package, ros2, written)
    with argument("gazebo"):
        model = model_name(folder, written) if gazebo else ""
    options = Options(
        output=folder,
        formats=written,
        step=Path(step) if step is not None else None,
        encoding=code_page_of(encoding),
        verify=verify,
        strict=strict,
        require=engines_required(require),
        ignore=codes_ignored(ignore),
        timeout=timeout,
        memory_limit=memory_limit,
        cache=cache_at(cache),
        html=html,
        package=meshes_of,
        ros2=bool(ros2),
        maintainer=maintainer,
        license=license,
        gazebo=model,
        programs=loaded_by,
        base=base,
        package_path=tuple(map(Path, several(package_path))),
        xacro=tuple((xacro or {}).items()),
        assume_inertia=assume_inertia,
    )
    return convert_unless_unchanged(path, options)


@checked
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

    diagnostics = Diagnostics()
    options = Options(
        output=Path(),
        step=Path(step) if step is not None else None,
        ignore=codes_ignored(ignore),
        timeout=timeout,
        memory_limit=memory_limit,
        cache=cache_at(cache),
    )
    outcome = check_unless_unchanged(Path(sidecar), options, diagnostics, open_step=open_step or step is not None)
    return CheckResult(diagnostics, outcome)
