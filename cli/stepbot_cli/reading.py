"""Options that several commands share: limits, cache, code page, variant, engines, descriptions, data of packages."""

import os
import re
from collections.abc import Callable, Collection, Iterable
from functools import wraps
from math import inf, isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.cache import DEFAULT_LIMIT, Cache, default_folder
from stepbot.runtime.memory import DEFAULT_TIMEOUT, worker_limit

from .command import PATH, names_option
from .diagnostic_text import printable

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options

_SIZE = re.compile(r"(?P<number>\d+(?:\.\d+)?)\s*(?P<prefix>[KMGT]?)i?B?", re.IGNORECASE)
_FACTORS = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}


def size(text: str) -> int:
    """Bytes, from a number with an optional binary prefix.

    Raises:
        click.BadParameter: The text is not a size.
    """
    match = _SIZE.fullmatch(text.strip())
    if match is None:
        raise click.BadParameter(f"'{text}' is not a size such as 4G or 500M")
    return int(float(match["number"]) * _FACTORS[match["prefix"].upper()])


def in_words(count: int) -> str:
    """A size with a unit prefix: ``1.4 GiB``."""
    amount, unit = float(count), "B"
    for larger in ("KiB", "MiB", "GiB", "TiB"):
        if amount < 1024.0:
            break
        amount, unit = amount / 1024.0, larger
    return f"{amount:.1f} {unit}" if unit != "B" else f"{count} B"


SIZE_VARIABLE = "STEPBOT_CACHE_SIZE"

folder_option = click.option(
    "--cache",
    type=PATH,
    metavar="DIR",
    envvar="STEPBOT_CACHE",
    help="Cache folder.  [default: stepbot in the user's cache folder]",
)


def opened(folder: Path | None) -> Cache:
    """The cache in a folder, by default that of the user, with the limit of the environment."""
    limit = size(os.environ[SIZE_VARIABLE]) if os.environ.get(SIZE_VARIABLE) else DEFAULT_LIMIT
    return Cache(folder or default_folder(), limit)


def report_trouble(cache: Cache | None, diagnostics: Diagnostics) -> None:
    """Add a note if results could not be cached."""
    if cache is not None and cache.trouble:
        diagnostics.add("SB006", cache.trouble, Span("stepbot"), help=["choose another folder with `--cache DIR`"])


require_option = names_option(
    "--require", metavar="ENGINE,...", help="Report an error if one of these engines is not installed; may be repeated."
)


def _limit(text: str) -> int | None:
    """A size, or ``none``."""
    if text.strip().lower() == "none":
        return None
    limit = size(text)
    if limit < _LEAST_LIMIT:
        raise click.BadParameter(f"'{text}' is less than 1M; a number without a prefix is of bytes")
    return limit


_LEAST_LIMIT = 1 << 20


def _seconds(text: str) -> float:
    """A time limit [s]."""
    try:
        seconds = float(text)
    except ValueError:
        seconds = nan
    if not (isfinite(seconds) and seconds > 0.0):
        raise click.BadParameter(f"'{text}' is not a positive number of seconds, such as 600 or 0.5")
    return seconds


def _default_limit() -> str:
    """In the format of the option."""
    return str(worker_limit() or "none")


def limit_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the limits of the worker processes."""
    timeout = click.option(
        "--timeout",
        type=_seconds,
        default=DEFAULT_TIMEOUT,
        show_default=True,
        metavar="SECONDS",
        help="Time limit for the geometry kernel, more for STEP files above 30 MB, for each engine, and for the "
        "processor time of the command itself.",
    )
    memory = click.option(
        "--memory-limit",
        type=_limit,
        default=_default_limit,
        metavar="SIZE",
        help="Memory limit for the geometry kernel, each engine and the command itself, such as 4G, or none.  "
        "[default: 3/4 of RAM]",
    )
    return timeout(memory(command))


def _maintainer(context: click.Context, option: click.Parameter, given: str | None) -> str:  # noqa: ARG001
    """The name and address of a maintainer."""
    if not given:
        return ""
    from stepbot.robot.metadata import is_maintainer

    if not is_maintainer(given):
        raise click.BadParameter("expected a name and an address: 'Ada Lovelace <ada@example.com>'")
    return given


_maintainer_option = click.option(
    "--maintainer",
    default="",
    metavar="'NAME <ADDRESS>'",
    callback=_maintainer,
    help="Maintainer that packages state, instead of the one in SIDECAR.",
)
_license_option = click.option(
    "--license", default="", metavar="NAME", help="Licence that packages state, instead of the one in SIDECAR."
)


def metadata_options(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--maintainer`` and ``--license``."""
    return _maintainer_option(_license_option(command))


def _code_page(name: str) -> str:
    if not name:
        return ""
    from stepbot.sidecar.text import UnknownCodePage, code_page

    try:
        return code_page(name)
    except UnknownCodePage as failure:
        raise click.BadParameter("; ".join((str(failure), *failure.hints))) from None


encoding_option = click.option(
    "--encoding",
    type=_code_page,
    default="",
    metavar="CODEPAGE",
    help="Code page of names in the STEP file that are neither ASCII nor UTF-8, such as cp1251 or gbk.",
)


_FIELDS = (
    *("timeout", "memory_limit", "encoding", "strict", "ignore", "require", "verify", "html", "programs"),
    *("maintainer", "license", "package_path", "base", "xacro", "assume_inertia"),
)
"""Parameters of commands that are fields of their ``options``."""


def working_options(command: Callable[..., int]) -> Callable[..., int]:
    """Add the limits of workers and the cache; the command receives them, and :data:`_FIELDS`, as ``options``."""

    @wraps(command)
    def with_options(*, cache: Path | None, no_cache: bool, **others: Any) -> int:
        from stepbot.pipeline.conversion import Options

        fields = {name: others.pop(name) for name in _FIELDS if name in others}
        return command(options=Options(output=Path(), cache=None if no_cache else opened(cache), **fields), **others)

    off = click.option("--no-cache", is_flag=True, envvar="STEPBOT_NO_CACHE", help="Disable the cache.")
    return limit_options(folder_option(off(with_options)))


def variant_option(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--variant`` to the ``options`` that :func:`reading_options` makes."""

    @wraps(command)
    def with_variant(*, options: "Options", variant: str, **others: Any) -> int:
        named = next(others[key] for key in ("sidecar", "sidecars", "target", "step") if key in others)
        for path in named if isinstance(named, tuple) else (named,):
            if variant and path.suffix.lower() not in (".yaml", ".yml") and not path.is_dir():
                raise click.UsageError(f"--variant requires a sidecar; {printable(path.name)} is not one")
        if variant and others.get("edit"):
            raise click.UsageError("--variant cannot be edited: the page writes the sidecar as it is")
        return command(options=options._replace(variant=variant), **others)

    help = "Variant of the sidecar, by its name under `variants`."
    return click.option("--variant", default="", metavar="NAME", help=help)(with_variant)


def reading_options(command: Callable[..., int]) -> Callable[..., int]:
    """The same, and the code page of STEP files."""
    return encoding_option(working_options(command))


_base_option = click.option(
    "--base",
    type=click.Choice(["fixed", "floating"]),
    callback=lambda _context, _parameter, given: given or "",
    help="Whether the base of a converted URDF is fixed to the world: the format does not say.",
)
xacro_option = click.option(
    "--xacro",
    multiple=True,
    metavar="NAME:=VALUE",
    callback=lambda _context, _parameter, given: tuple(map(_argument, given)),
    help="Value of an argument of a xacro; may be repeated.",
)
_inertia_option = click.option(
    "--assume-inertia",
    metavar="DENSITY",
    callback=lambda _context, _parameter, text: _density(text),
    help="Compute mass properties that a description lacks, or states impossibly, from its geometry and this density: "
    "1000, '2.7 g/cm^3'. Each is reported.",
)
folders_option = click.option(
    "--package-path",
    "package_path",
    multiple=True,
    type=PATH,
    metavar="DIR",
    help="Folder of packages that a description names in package:// or model://, or of files that an MJCF includes.",
)


def package_path_option(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--package-path`` and ``--xacro``."""
    return folders_option(xacro_option(command))


def description_options(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--base``, ``--assume-inertia`` and ``--package-path``, too."""
    return package_path_option(_base_option(_inertia_option(command)))


def _argument(text: str) -> tuple[str, str]:
    """Name and value of an argument, as ROS writes it, or with a plain equals sign."""
    name, sign, value = text.partition(":=") if ":=" in text else text.partition("=")
    if not (sign and name.strip()):
        raise click.BadParameter(f"'{text}' is not NAME:=VALUE: `--xacro ur_type:=ur5e`")
    return name.strip(), value


def _density(text: str | None) -> float:
    """A density [kg/m^3], as in a sidecar; 0 for none."""
    if text is None:
        return 0.0
    from stepbot.sidecar.units import DENSITY, UnitError, read_quantity

    try:
        density = read_quantity(text, DENSITY).value
    except UnitError as error:
        raise click.BadParameter(str(error)) from error
    if not 0.0 < density < inf:
        raise click.BadParameter(f"'{text}' is not a density above 0")
    return density


def reject_descriptions(what: str, paths: Iterable[Path]) -> None:
    """Reject an option or a command, ``what``, that applies to sidecars alone.

    Raises:
        click.UsageError: One of the files is a URDF, SDFormat or MJCF.
    """
    from stepbot.pipeline.conversion import is_description

    for path in filter(is_description, paths):
        name = printable(path.name)
        remedy = f"`stepbot init CAD.step --from {name}` drafts a sidecar of a STEP file from it"
        raise click.UsageError(f"{what} needs a sidecar: {name} is a robot description; {remedy}")


def reject_one_step_for_all(step: Path | None, named: Collection[Path], paths: Collection[Path]) -> None:
    """Reject `--step` for the sidecars of a folder: each would be compared with that STEP, or locked.

    Args:
        named: The sidecars and folders of the command line.
        paths: The sidecars that these are or contain.
    """
    if step is not None and len(paths) > 1 and not {*paths} <= {*named}:
        first = printable(min(paths).as_posix())
        help = f"name the one that describes it, for example `--step {printable(step.as_posix())} {first}`"
        raise click.UsageError(f"--step {printable(step.name)}: {len(paths)} sidecars were found; {help}")
