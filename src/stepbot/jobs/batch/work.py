"""One robot of a batch: the function that runs in a separate process, here or on another machine."""

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.runtime.cache import Cache, default_folder
from stepbot.runtime.temporary import run_folder
from stepbot.version import __version__

from ..incremental import conversion_key, produce, sidecar_digest

_KEPT = ExitStack()
"""Never closed: the processes that it keeps end with this one."""


@dataclass(frozen=True)
class Work:
    """The result for one robot; nothing is written yet."""

    files: Mapping[str, bytes]
    diagnostics: tuple[Diagnostic, ...]
    step: str = ""
    """The STEP that was read, relative to the sidecar's folder; empty if there was none."""
    input: str = ""
    """Key of everything that the files depend on; empty if the result must not be reused."""
    read: tuple[str, ...] = ()
    """The files that a composed robot depends on."""


@dataclass(frozen=True)
class Parcel:
    """A robot's input as bytes, for a machine without access to its files."""

    sidecar: str
    """The user's path."""
    text: bytes
    step: str
    """The user's path."""
    files: Mapping[str, bytes]
    """The STEP, and then the files that it refers to, by their names relative to its folder."""
    options: Options
    """Without a cache: the other machine has its own."""
    input: str
    """Key of everything that the files depend on."""
    version: str = __version__


def prepare() -> None:
    """In a process that converts one robot after the other: keep what it loads for the next one."""
    from stepbot.pipeline.prestart import warm_processes

    _KEPT.enter_context(warm_processes())


def carry_out(sidecar: Path, options: Options) -> Work:
    """Convert a robot whose files are on this machine."""
    before = sidecar_digest(sidecar, options.variant)
    conversion = produce(sidecar, options)
    if not before or before != sidecar_digest(sidecar, options.variant):
        return Work(conversion.files, tuple(conversion.diagnostics))
    step = options.step or (sidecar.parent / conversion.named if conversion.named else None)
    if conversion.read:
        step = step or sidecar
    if step is None or not conversion.geometry or conversion.diagnostics.has_errors:
        return Work(conversion.files, tuple(conversion.diagnostics))
    key = conversion_key(sidecar, before, step, conversion.geometry, options)
    read = tuple(path.as_posix() for path in conversion.read)
    return Work(conversion.files, tuple(conversion.diagnostics), str(step), key, read)


def carry_out_parcel(parcel: Parcel) -> Work:
    """Convert a robot that was sent as bytes; messages use the user's file names."""
    if parcel.version != __version__:
        found = Diagnostics()
        message = f"version mismatch: worker has stepbot {__version__}, client has {parcel.version}"
        found.add("SB009", message, Span(parcel.sidecar), help=["install the same version of stepbot on all machines"])
        return Work({}, tuple(found))
    from stepbot.pipeline import stages as pipeline

    with TemporaryDirectory(dir=run_folder()) as folder:
        sidecar = _put(Path(folder) / "sidecar", parcel.sidecar, parcel.text)
        step = _put_all(Path(folder) / "step", parcel.files)
        # Whole conversions are cached by path, geometry and observations by content only: the latter are reused.
        options = parcel.options._replace(step=step, cache=Cache(default_folder()) if parcel.options.cache else None)
        conversion = pipeline.produce(sidecar, options)
        owner = Path(parcel.step).parent
        known = {sidecar.as_posix(): parcel.sidecar}
        known |= {str(step.parent / name): str(owner / name) for name in parcel.files}
        is_done = not conversion.diagnostics.has_errors
        return Work(conversion.files, _renamed(conversion, known), parcel.step, parcel.input if is_done else "")


def _put(folder: Path, name: str, content: bytes) -> Path:
    folder.mkdir()
    path = folder / Path(name).name
    path.write_bytes(content)
    return path


def _put_all(folder: Path, files: Mapping[str, bytes]) -> Path:
    """The first file, written with the others beside it."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder / next(iter(files))


def _renamed(conversion: Conversion, known: Mapping[str, str]) -> tuple[Diagnostic, ...]:
    return tuple(
        one._replace(span=one.span._replace(file=known.get(one.span.file, one.span.file)))
        for one in conversion.diagnostics
    )
