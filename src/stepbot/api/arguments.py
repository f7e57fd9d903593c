"""What the functions take and return: errors that name the right argument, one or several names, options; results."""

from collections.abc import Callable, Iterable
from functools import wraps
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, ParamSpec, TypeVar, cast

from msgspec import Struct

from stepbot.diagnostics import Diagnostics, did_you_mean
from stepbot.formats import FORMATS, default_formats, format_named
from stepbot.pipeline.conversion import Checked, Options
from stepbot.runtime.cache import Cache, default_folder

if TYPE_CHECKING:
    from stepbot.draft.draft import Draft
    from stepbot.driving.driving import Driven
    from stepbot.report.robot import Report

AnyPath = str | PathLike[str]
_One = TypeVar("_One", bound=AnyPath)
_Given = ParamSpec("_Given")
_Result = TypeVar("_Result")
_PATHS = ("sidecar", "step", "output", "description", "target", "limits")
"""Names of arguments that are a path, or None."""
_READ_STEP = "`open_step=True` reads the STEP that the sidecar names"


def checked(function: Callable[_Given, _Result]) -> Callable[_Given, _Result]:
    """The function, with errors about wrong arguments that name the right ones."""
    code = function.__code__
    names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]

    @wraps(function)
    def with_right_names(*given: _Given.args, **named: _Given.kwargs) -> _Result:
        for name, value in named.items():
            if name not in names:
                near = "".join(did_you_mean(name, names)) or f"there are {', '.join(names)}"
                raise TypeError(f"{function.__name__}() has no argument '{name}'; {near}")
            if name in _PATHS and value is not None and not isinstance(value, str | PathLike):
                remedy = f"; {_READ_STEP}" if name == "step" and "open_step" in names else ""
                raise TypeError(f"{function.__name__}({name}=...) takes a path, not {value!r}{remedy}")
        return function(*given, **named)

    return with_right_names


def several(given: "_One | Iterable[_One]") -> "tuple[_One, ...]":
    """One or several: a string is one, not its letters."""
    if isinstance(given, str | PathLike):
        return (cast("_One", given),) if given else ()
    return tuple(given)


def known(given: str | Iterable[str], known: Iterable[str], noun: str) -> tuple[str, ...]:
    """Names among those that there are.

    Raises:
        ValueError: One is not.
    """
    names: tuple[str, ...] = several(given)
    for name in names:
        if name not in known:
            near = "".join(did_you_mean(name, known)) or f"there are {', '.join(known)}"
            raise ValueError(f"no {noun} '{name}'; {near}")
    return names


def reading(
    encoding: str,
    timeout: float,
    memory_limit: int | None,
    cache: AnyPath | bool,
    package_path: AnyPath | Iterable[AnyPath],
) -> Options:
    """Options of functions that write no robot files."""
    return Options(
        output=Path(),
        encoding=encoding,
        timeout=timeout,
        memory_limit=memory_limit,
        cache=cache_at(cache),
        package_path=tuple(map(Path, several(package_path))),
    )


def format_names(given: str | Iterable[str]) -> tuple[str, ...]:
    """Names of formats, aliases resolved; the default ones for none.

    Raises:
        ValueError: One is not a format.
    """
    names: tuple[str, ...] = several(given)
    if not names:
        return default_formats()

    try:
        return tuple(dict.fromkeys(format_named(name).name for name in names))
    except KeyError as error:
        raise ValueError(f"no format {error}; there are {', '.join(FORMATS)}") from None


def cache_at(where: AnyPath | bool) -> Cache | None:
    """The cache in a folder; True for the user's, False for none."""
    if where is False:
        return None
    return Cache(default_folder() if where is True else Path(where))


class CheckResult(Struct, frozen=True):
    """The result of :func:`check`."""

    diagnostics: Diagnostics
    checked: Checked
    """Number of links and joints; the joint table if the STEP was read."""


class Verification(Struct, frozen=True):
    """The result of :func:`verify`."""

    diagnostics: Diagnostics
    report: "Report"


class Drafted(Struct, frozen=True):
    """The result of :func:`draft`."""

    diagnostics: Diagnostics
    draft: "Draft | None" = None
    """Links and joints with their evidence; None after errors."""
    text: str = ""
    """The sidecar."""


class DriveResult(Struct, frozen=True):
    """The result of :func:`drive`."""

    diagnostics: Diagnostics
    driven: "Driven | None" = None
    """The verdict of each test in each engine; None if nothing could be driven."""


class Rendered(Struct, frozen=True):
    """The result of :func:`render`."""

    diagnostics: Diagnostics
    png: bytes = b""
    """The picture as a PNG file; empty after errors."""
