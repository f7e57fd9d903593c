"""Converts and checks changed robots, and returns cached results for unchanged ones.

The cache key includes everything that a result depends on: the sidecar, the STEP file and those that it
refers to, the options, the environment.
A lookup loads neither kernel, engines nor numpy; the pipeline is imported on a cache miss only. Errors of the kernel
or an engine are never cached, because they may be temporary.
"""

import os
import re
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from stepbot.diagnostics import Diagnostic, Diagnostics, Span, StepbotError
from stepbot.pipeline.conversion import Checked, Conversion, Kept, Options, is_description, write
from stepbot.revisions import lock_path
from stepbot.runtime.cache import (
    Cache,
    Digest,
    TypedCache,
    codec_of,
    environment,
    file_digest,
    files_digest,
    keep_own_code,
    own_code,
)
from stepbot.runtime.file import read_regular
from stepbot.step.exchange.input_files import input_digest

if TYPE_CHECKING:
    from stepbot.robot.joint_table import JointRow
    from stepbot.runtime.cache.codec import Codec
    from stepbot.runtime.worker import RemoteError, WorkerDied

_WORDS = re.compile(rb"""[^"'{}\[\],#:\n]+""")
_NAMED_FILE = re.compile(rb".*\.(?:ya?ml|json)\b", re.DOTALL)
"""Name of a file in words of a sidecar's text, such as one of motors: what it may contain is input, too."""
_NO_MATTER = ("output", "timeout", "memory_limit", "cache", "step")
"""Options that do not affect results; the STEP is in the key by its content."""
_NEVER_KEPT = "SB817"
"""Self-collision could not be checked: not an error, but the next run may succeed."""


class Record(NamedTuple):
    """The result of a conversion without errors."""

    files: Mapping[str, bytes]
    hashes: Mapping[str, str]
    """SHA-256 of each file."""
    diagnostics: tuple[Diagnostic, ...]
    ignored: tuple[Diagnostic, ...]
    results: Kept


class _Findings(NamedTuple):
    """The result of a check."""

    diagnostics: tuple[Diagnostic, ...]
    ignored: tuple[Diagnostic, ...]
    checked: tuple[str, int, int, str]
    """A :class:`Checked` without its joint table."""
    joint_table: bytes
    """That, encoded; empty without joints: its records are loaded where there are some."""


def convert(sidecar: Path, options: Options, progress: Callable[[str], None] = lambda stage: None) -> Conversion:
    """Convert one sidecar or load the cached result, and write the files."""
    from stepbot.runtime.output import check_writable

    try:
        check_writable(options.output)
    except StepbotError as error:
        return Conversion(error.diagnostics)
    conversion = produce(sidecar, options, progress)
    progress("save")
    return write(conversion, options.output, sidecar)


def produce(sidecar: Path, options: Options, progress: Callable[[str], None] = lambda stage: None) -> Conversion:
    """Convert one sidecar or load the cached result, without writing files."""
    record = recorded(sidecar, options)
    if record is not None:
        diagnostics = Diagnostics()
        diagnostics.extend(record.diagnostics)
        diagnostics.add_ignored(record.ignored)
        return Conversion(diagnostics, None, record.files, record.results, hashes=record.hashes)
    before = _content(sidecar, options)
    lock = file_digest(lock_path(sidecar, options.variant))
    from stepbot.pipeline.prestart import started_kernel, started_server

    with ExitStack() as running:
        kernel = None if is_description(sidecar) else started_kernel(sidecar, options)
        server = started_server(options) if kernel is None else None  # not in parallel: the kernel would take longer
        for started in (kernel, server):
            if started is not None:
                running.enter_context(started)
        from stepbot.pipeline import stages as pipeline

        conversion = pipeline.produce(sidecar, options, progress, kernel, server)
    unchanged = lock == file_digest(lock_path(sidecar, options.variant))
    if before and before == _content(sidecar, options) and unchanged:
        _keep(conversion, sidecar, before, options)
    return conversion


def failure_of(sidecar: Path, error: "WorkerDied | RemoteError") -> Diagnostics:
    """The diagnostic of a conversion in a process that died, or whose function raised."""
    from stepbot.runtime.worker import WorkerDied

    diagnostics, span = Diagnostics(), Span(sidecar.as_posix())
    if isinstance(error, WorkerDied):
        diagnostics.add("SB902", f"conversion failed: {error.reason}", span, notes=error.last_lines)
    else:
        diagnostics.add(
            "SB901", f"internal error: {error.kind}: {error.text}", span, notes=error.trace.splitlines()[-3:]
        )
    return diagnostics


def recorded(sidecar: Path, options: Options) -> Record | None:
    """The cached result of a conversion with the same input, if any."""
    if options.cache is None:
        return None
    keep_own_code(options.cache)
    content = _content(sidecar, options)
    read = TypedCache(options.cache, tuple[str, ...]).get(_modules_key(sidecar, content)) if content else None
    if read is not None:
        step, geometry = options.step or sidecar, files_digest(map(Path, read))
        return TypedCache(options.cache, Record).get(conversion_key(sidecar, content, step, geometry, options))
    named = options.step or _named_step(sidecar, content, options.cache)
    of_step = input_digest(named) if named is not None else None
    if named is None or of_step is None:
        return None
    return TypedCache(options.cache, Record).get(conversion_key(sidecar, content, named, of_step, options))


def conversion_key(sidecar: Path, content: str, step: Path, geometry: str, options: Options) -> str:
    """Cache key of a conversion.

    Args:
        sidecar: Path of the sidecar, as in messages.
        content: Hash of its bytes.
        step: Path of the STEP, as in messages.
        geometry: Hash of its bytes, and of the files that it refers to.
    """
    digest = Digest("conversion").add(environment(), sidecar.as_posix(), content, str(step), geometry)
    digest.add(file_digest(lock_path(sidecar, options.variant)) or "no lock")
    return digest.add(*_asked(options)).key


def check(sidecar: Path, options: Options, diagnostics: Diagnostics, *, open_step: bool = False) -> Checked:
    """Check a sidecar on its own or, with ``open_step``, against the STEP file; writes nothing.

    A URDF, SDFormat or MJCF is read with its meshes; its result is not cached.
    """
    cache = None if is_description(sidecar) else options.cache
    keep_own_code(cache)
    key = _check_key(sidecar, options, open_step)
    kept = TypedCache(cache, _Findings).get(key) if key else None
    if kept is not None:
        diagnostics.extend(kept.diagnostics)
        diagnostics.add_ignored(kept.ignored)
        named, links, joints, robot = kept.checked
        return Checked(named, links, joints, _rows().decode(kept.joint_table) if kept.joint_table else (), robot)
    from stepbot.pipeline import stages as pipeline

    before, local = _content(sidecar, options._replace(cache=cache)), Diagnostics()
    checked = pipeline.check(sidecar, options, local, open_step=open_step)
    diagnostics.extend(local)
    diagnostics.add_ignored(local.ignored)
    if not before or before != _content(sidecar, options._replace(cache=cache)):
        return checked
    if checked.named:
        TypedCache(cache, str).put(_name_key(before), checked.named)
    # Without the STEP, all results come from the sidecar's text; the kernel may fail for temporary reasons.
    if not (open_step and local.has_errors):
        after = _check_key(sidecar, options, open_step)
        if after and key in ("", after):
            named, links, joints, table, robot, _ = checked
            rows = _rows().encode(table) if table else b""
            kept = _Findings(tuple(local), local.ignored, (named, links, joints, robot), rows)
            TypedCache(cache, _Findings).put(after, kept)
    return checked


def _rows() -> "Codec[tuple[JointRow, ...]]":
    from stepbot.robot.joint_table import JointRow

    return codec_of(tuple[JointRow, ...])


def _keep(conversion: Conversion, sidecar: Path, content: str, options: Options) -> None:
    if conversion.named:
        TypedCache(options.cache, str).put(_name_key(content), conversion.named)
    report, summary, diagnostics = conversion.report, conversion.summary, conversion.diagnostics
    if not conversion.geometry or report is None or summary is None:
        return
    if diagnostics.has_errors or any(diagnostic.code == _NEVER_KEPT for diagnostic in diagnostics):
        return
    from stepbot.report.results import Results
    from stepbot.runtime.output_list import content_hashes

    encoded = codec_of(Results).encode(report)
    step = options.step or (sidecar if conversion.read else sidecar.parent / conversion.named)
    if conversion.read:
        names = tuple(path.as_posix() for path in conversion.read)
        TypedCache(options.cache, tuple[str, ...]).put(_modules_key(sidecar, content), names)
    key = conversion_key(sidecar, content, step, conversion.geometry, options)
    hashes = content_hashes(conversion.files)
    record = Record(conversion.files, hashes, tuple(diagnostics), diagnostics.ignored, Kept(encoded, summary))
    TypedCache(options.cache, Record).put(key, record)


def _content(sidecar: Path, options: Options) -> str:
    """What :func:`sidecar_digest` gives; empty without a cache."""
    return sidecar_digest(sidecar, options.variant) if options.cache is not None else ""


def sidecar_digest(sidecar: Path, variant: str) -> str:
    """Hash of a sidecar's text, its variant, and the files that it names beside it; empty if it cannot be read."""
    content = file_digest(sidecar) or ""
    if not content:
        return ""
    named = named_files(read_regular(sidecar).replace(b"\\", b"/"))
    others = sorted((name, file_digest(sidecar.parent / name) or "") for name in named)
    return Digest("content").add(content, variant, repr(others)).key if others or variant else content


def named_files(text: bytes) -> set[str]:
    """What may be names of YAML and JSON files in a text, in linear time."""
    matches = map(_NAMED_FILE.match, _WORDS.findall(text))
    return {os.fsdecode(one[0].strip()).replace("\0", "") for one in matches if one is not None}


def _named_step(sidecar: Path, content: str, cache: Cache | None) -> Path | None:
    """The STEP that a sidecar refers to, if it was read before."""
    named = TypedCache(cache, str).get(_name_key(content)) if content else None
    return sidecar.parent / named if named else None


def _name_key(content: str) -> str:
    return Digest("name of STEP").add(own_code(), content).key


def _modules_key(sidecar: Path, content: str) -> str:
    """Key of the names of the files that a composed robot depends on."""
    return Digest("files of modules").add(own_code(), sidecar.as_posix(), content).key


def _asked(options: Options) -> list[str]:
    names = [name for name in options._fields if name not in _NO_MATTER]
    return [f"{name}={getattr(options, name)!r}" for name in names]


def _check_key(sidecar: Path, options: Options, open_step: bool) -> str:
    """Key of a check's result; empty without a cache, or if a file is unreadable or unknown."""
    content = _content(sidecar, options)
    if not content:
        return ""
    digest = Digest("check").add(own_code(), sidecar.as_posix(), content, repr(options.ignore))
    if not open_step:
        return digest.key
    source = options.step or _named_step(sidecar, content, options.cache)
    geometry = input_digest(source) if source is not None else None
    if geometry is None:
        return ""
    lock = file_digest(lock_path(sidecar, options.variant)) or "no lock"
    return digest.add(environment(), str(source), geometry, lock, *_asked(options)).key
