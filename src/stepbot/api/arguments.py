"""What the functions take and return: errors that name the right argument, one or several names, options; results."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import wraps
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from types import UnionType
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar, Union, cast, get_args, get_origin

from msgspec import Struct

from stepbot.diagnostics import Diagnostics, code_to_ignore, did_you_mean
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
_READ_STEP = "`open_step=True` reads the STEP that the sidecar names"
_WORDS = {str: "a string", bool: "True or False", int: "a whole number", float: "a number"}
_POSITIVE = ("timeout", "memory_limit", "size", "samples")
"""Arguments that are larger than 0."""


def checked(function: Callable[_Given, _Result]) -> Callable[_Given, _Result]:
    """The function, with errors about wrong arguments that name the right ones."""
    code, forms = function.__code__, function.__annotations__
    names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    takes_files = len(code.co_varnames) > len(names) and code.co_varnames[len(names)] == "files"

    @wraps(function)
    def with_right_names(*given: _Given.args, **named: _Given.kwargs) -> _Result:
        call, unnamed = function.__name__, names[: code.co_argcount]
        if takes_files and not given:
            raise TypeError(f"{call}() takes one file or several")
        if len(given) > code.co_argcount and not takes_files:
            others = ", ".join(f"{name}=" for name in names[code.co_argcount :])
            raise TypeError(f"{call}() takes '{', '.join(unnamed)}' alone without its name; the others are {others}")
        for name in named:
            if name not in names:
                near = "".join(did_you_mean(name, names)) or f"there are {', '.join(names)}"
                raise TypeError(f"{call}() has no argument '{name}'; {near}")
        files = [("files", file) for file in given] if takes_files else []
        for name, value in (*files, *zip(unnamed, given, strict=False), *named.items()):
            if not _fits(value, forms[name]):
                remedy = f"; {_READ_STEP}" if name == "step" and "open_step" in names else ""
                raise TypeError(f"{call}({name}=...) takes {_words(forms[name])}, not {value!r}{remedy}")
            numbers = value if isinstance(value, tuple | list) else (value,)
            if name in _POSITIVE and any(number is not None and not number > 0 for number in numbers):
                raise ValueError(f"{call}({name}=...) takes what is larger than 0, not {value!r}")
        return function(*given, **named)

    return with_right_names


def _fits(value: object, form: Any) -> bool:
    """Whether an argument is of the form in its annotation; of what can be read only once, the entries are unknown."""
    kind, parts = get_origin(form) or form, get_args(form)
    if kind is UnionType or kind is Union:
        return any(_fits(value, part) for part in parts)
    if kind is type(None):
        return value is None
    if kind in (int, float):
        return isinstance(value, Real if kind is float else Integral) and not isinstance(value, bool)
    if kind is tuple:
        return isinstance(value, tuple | list) and len(value) == len(parts) and all(map(_fits, value, parts))
    if kind is Mapping:
        return isinstance(value, Mapping) and all(_fits(k, parts[0]) and _fits(v, parts[1]) for k, v in value.items())
    if kind is Iterable:
        several = isinstance(value, Iterable) and not isinstance(value, str | bytes | PathLike | Mapping)
        return several and (not isinstance(value, Collection) or all(_fits(one, parts[0]) for one in value))
    return isinstance(value, kind)


def _words(form: Any) -> str:
    """What an argument may be: ``a string, or several``."""
    kind, parts = get_origin(form) or form, get_args(form)
    if kind is UnionType or kind is Union:
        of_one = [part for part in parts if get_origin(part) is not Iterable and part is not type(None)]
        is_path = any(get_origin(part) is PathLike for part in of_one)
        words = ["a path"] if is_path else []
        words += [_words(part) for part in of_one if not (is_path and (part is str or get_origin(part) is PathLike))]
        words += ["several"] if any(get_origin(part) is Iterable for part in parts) else []
        return " or ".join(words)
    if kind is Mapping:
        return f"a mapping from {_words(parts[0])} to {_words(parts[1])}"
    return " and ".join(map(_words, parts)) if kind is tuple else str(_WORDS.get(kind, kind))


@contextmanager
def argument(name: str) -> Iterator[None]:
    """Name the argument in an error about its value."""
    try:
        yield
    except ValueError as error:
        raise ValueError(str(error) if str(error).startswith(name) else f"{name}: {error}") from None


def several(given: "_One | Iterable[_One]") -> "tuple[_One, ...]":
    """One or several: a string is one, not its letters."""
    if isinstance(given, str | PathLike):
        return (cast("_One", given),) if given else ()
    return tuple(given)


def known(given: str | Iterable[str], known: Iterable[str], noun: str, argument: str) -> tuple[str, ...]:
    """Names among those that there are.

    Args:
        argument: The name of the argument, for errors.

    Raises:
        ValueError: One is not.
    """
    names: tuple[str, ...] = several(given)
    for name in names:
        if name not in known:
            near = "".join(did_you_mean(name, known)) or f"there are {', '.join(known)}"
            raise ValueError(f"{argument}: no {noun} '{name}'; {near}")
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
        encoding=code_page_of(encoding),
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
        raise ValueError(f"formats: no format {error}; there are {', '.join(FORMATS)}") from None


def engines_required(given: str | Iterable[str]) -> tuple[str, ...]:
    """Names of engines whose absence is an error.

    Raises:
        ValueError: There is no such engine.
    """
    from stepbot.engines import engines

    return known(given, tuple(engine.name for engine in engines()), "engine", "require")


def codes_ignored(given: str | Iterable[str]) -> tuple[str, ...]:
    """Codes of warnings and notes to suppress.

    Raises:
        ValueError: There is no such code, or it is one of errors.
    """
    codes: tuple[str, ...] = several(given)
    with argument("ignore"):
        return tuple(map(code_to_ignore, codes))


def code_page_of(name: str) -> str:
    """The usual name of a code page; empty for none.

    Raises:
        ValueError: There is no such code page.
    """
    if not name:
        return ""
    from stepbot.sidecar.text import code_page

    with argument("encoding"):
        return code_page(name)


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
