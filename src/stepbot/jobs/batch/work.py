"""One robot of a batch: what runs in a process of its own, here or on another machine."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.runtime.cache import Cache, default_folder, file_digest
from stepbot.runtime.temporary import run_folder
from stepbot.version import __version__

from ..incremental import conversion_key, produce


@dataclass(frozen=True)
class Work:
    """What came of one robot; nothing is written yet."""

    files: Mapping[str, bytes]
    diagnostics: tuple[Diagnostic, ...]
    step: str = ""
    """The STEP that was read, as the sidecar's folder reaches it; empty where there was none."""
    input: str = ""
    """Key of all that the files depend on; empty where they are not to be taken for the last word."""


@dataclass(frozen=True)
class Parcel:
    """A robot's input as bytes, for a machine that does not see its files."""

    sidecar: str
    """Path as the user knows it."""
    text: bytes
    step: str
    """Path as the user knows it."""
    geometry: bytes
    options: Options
    """Without a cache: the other machine has its own."""
    input: str
    """Key of all that the files depend on."""
    version: str = __version__


def carry_out(sidecar: Path, options: Options) -> Work:
    """Convert a robot whose files this machine sees."""
    before = file_digest(sidecar)
    conversion = produce(sidecar, options)
    if before is None or before != file_digest(sidecar):
        return Work(conversion.files, tuple(conversion.diagnostics))
    step = options.step or (sidecar.parent / conversion.named if conversion.named else None)
    if step is None or not conversion.geometry or conversion.diagnostics.has_errors:
        return Work(conversion.files, tuple(conversion.diagnostics))
    key = conversion_key(sidecar, before, step, conversion.geometry, options)
    return Work(conversion.files, tuple(conversion.diagnostics), str(step), key)


def carry_out_parcel(parcel: Parcel) -> Work:
    """Convert a robot that came as bytes; messages name the files as their owner knows them."""
    if parcel.version != __version__:
        found = Diagnostics()
        message = f"version mismatch: worker has stepbot {__version__}, client has {parcel.version}"
        found.add("SB009", message, Span(parcel.sidecar), help=["install the same version of stepbot on all machines"])
        return Work({}, tuple(found))
    from stepbot.pipeline import stages as pipeline

    with TemporaryDirectory(dir=run_folder()) as folder:
        sidecar = _put(Path(folder) / "sidecar", parcel.sidecar, parcel.text)
        step = _put(Path(folder) / "step", parcel.step, parcel.geometry)
        # Whole conversions are known by their paths, geometry and observations by content alone: those are found again.
        options = replace(parcel.options, step=step, cache=Cache(default_folder()) if parcel.options.cache else None)
        conversion = pipeline.produce(sidecar, options)
        known = {sidecar.as_posix(): parcel.sidecar, str(step): parcel.step}
        is_done = not conversion.diagnostics.has_errors
        return Work(conversion.files, _renamed(conversion, known), parcel.step, parcel.input if is_done else "")


def _put(folder: Path, name: str, content: bytes) -> Path:
    folder.mkdir()
    path = folder / Path(name).name
    path.write_bytes(content)
    return path


def _renamed(conversion: Conversion, known: Mapping[str, str]) -> tuple[Diagnostic, ...]:
    return tuple(
        replace(one, span=replace(one.span, file=known.get(one.span.file, one.span.file)))
        for one in conversion.diagnostics
    )
