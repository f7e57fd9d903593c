"""The assembly of a STEP file and trimesh's mass properties: from the cache, or read by the kernel.

Cache entries depend on the bytes of the file and of those that it refers to, and on the read options, not on the
sidecar as a whole: editing a joint does not read the STEP again. Only results without errors are cached.
"""

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path

from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.geometry.mesh_worker import MESH_WORKER, report_death
from stepbot.geometry.volume import VolumeProperties
from stepbot.runtime.cache import Cache, Digest, TypedCache, codec_of, environment
from stepbot.runtime.file import open_regular, resolved
from stepbot.runtime.worker import Worker, WorkerDied
from stepbot.step.assembly import Assembly, ReadOptions
from stepbot.step.exchange.input_files import input_digest, input_files
from stepbot.step.reader import Reading, start_reading

from .conversion import Options
from .prestart import note_read


def input_hashes(files: Mapping[str, Path]) -> dict[str, str]:
    """SHA-256 of each file by its name in the report.

    Empty if one is gone or unreadable by now: then it is unknown which version was read.
    """
    hashes = {}
    for name, path in files.items():
        try:
            with open_regular(path) as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
        except OSError:
            return {}
        hashes[name.encode("utf-8", "backslashreplace").decode()] = digest
    return hashes


def input_names(first: Path, others: Iterable[Path]) -> dict[str, Path]:
    """Each file by its path relative to the folder of the first.

    Those outside of it have their own names, with as many of the folders above them as tell them apart.
    """
    main = resolved(first)
    named: dict[str, Path] = {}
    for path in dict.fromkeys((main, *(resolved(other) for other in others))):
        inside = path.is_relative_to(main.parent)
        name, folders = path.relative_to(main.parent).as_posix() if inside else path.name, 1
        while name in named:
            folders += 1
            name = "/".join(path.parts[-folders:])
        named[name] = path
    return named


class Geometry(Struct, frozen=True, eq=False):
    """An assembly with its mass properties."""

    assembly: Assembly
    measures: tuple[VolumeProperties | None, ...]
    """trimesh's mass properties of the mesh of each body; None for a mesh that encloses no volume."""
    diagnostics: tuple[Diagnostic, ...]
    """Diagnostics of the file."""


class Loading:
    """A geometry that is being loaded."""

    def __init__(
        self, step: Path, what: ReadOptions, options: Options, diagnostics: Diagnostics, kernel: Worker | None = None
    ) -> None:
        """Look it up in the cache, or start the kernel; returns at once.

        Args:
            step: The STEP file; diagnostics use this path.
            diagnostics: Receives faults of a file that is rejected without starting the kernel.
            kernel: A process started in advance; None to start one if needed.

        Raises:
            StepbotError: The file is rejected.
        """
        self._step, self._timeout = step, options.timeout
        self._diagnostics = Diagnostics()
        self._assembly: Assembly | None = None
        self._cached = _GeometryCache(options.cache, step, what)
        self._known = self._cached.get()
        self._reading: Reading | None = None
        self.mesh_worker: Worker | None = None
        """The process that measures the meshes, for further mesh computations; None if the geometry was cached."""
        if self._known is not None:
            self._diagnostics.extend(self._known.diagnostics)
        else:
            self._reading = start_reading(step, what, memory_limit=options.memory_limit, kernel=kernel)
            if self._reading.pid is None:
                self._reading.finish(diagnostics)
                diagnostics.raise_if_errors()
            # It imports while the kernel works; this process does not need trimesh.
            self.mesh_worker = Worker(MESH_WORKER, memory_limit=options.memory_limit)

    def assembly(self, diagnostics: Diagnostics) -> Assembly:
        """Wait for the assembly and start to measure its bodies; diagnostics go to ``diagnostics``.

        Raises:
            StepbotError: There are errors.
        """
        assembly = self.incomplete_assembly(diagnostics)
        diagnostics.raise_if_errors()
        assert assembly is not None  # otherwise there is an error with the reason
        return assembly

    def incomplete_assembly(self, diagnostics: Diagnostics) -> Assembly | None:
        """The same, and after an error what could be read: an assembly without the parts of missing files, or None."""
        if self._known is not None:
            assembly: Assembly | None = self._known.assembly
        else:
            assert self._reading is not None  # otherwise the geometry was cached
            assert self.mesh_worker is not None
            assembly = self._assembly = self._reading.finish(self._diagnostics, timeout=self._timeout)
            if assembly is not None:
                self.mesh_worker.submit("measures", tuple(body.mesh for body in assembly.bodies), more=True)
        diagnostics.extend(self._diagnostics)
        return assembly

    def measures(self, diagnostics: Diagnostics) -> tuple[VolumeProperties | None, ...]:
        """trimesh's mass properties of each body of the assembly, which must have been awaited before."""
        if self._known is None:
            self._known = self._measured(diagnostics)
        return self._known.measures

    @property
    def content(self) -> str:
        """Hash of the file that was read and of those that it refers to; empty if one changed meanwhile."""
        return self._cached.content

    def inputs(self) -> dict[str, str]:
        """SHA-256 of each file that was read, by its path relative to the folder of the first one.

        Empty if one changed meanwhile: then it is unknown which version was read.
        """
        assert self._known is not None  # the assembly and its measures were waited for
        names = (self._step.name, *self._known.assembly.external_files)
        hashes = input_hashes({name: self._step.parent / name for name in names})
        return hashes if self.content else {}

    def close(self) -> None:
        """Stop reading; safe to call at any time."""
        for running in (self._reading, self.mesh_worker):
            if running is not None:
                running.close()

    def _measured(self, diagnostics: Diagnostics) -> Geometry:
        assert self.mesh_worker is not None  # otherwise the geometry was cached
        assert self._assembly is not None  # it has been awaited
        try:
            geometry = Geometry(self._assembly, self.mesh_worker.result(self._timeout), tuple(self._diagnostics))
        except WorkerDied as death:
            report_death(death, "measures the meshes", Span(str(self._step)), diagnostics)
            return Geometry(self._assembly, (None,) * len(self._assembly.bodies), tuple(self._diagnostics))
        if not self._diagnostics.has_errors:
            self._cached.put(geometry)
        return geometry


_held: dict[str, Geometry] = {}
"""The geometry read last, by its key in the cache, while somebody keeps it in memory."""
_holders: set[int] = set()


def hold_geometry(holder: object) -> None:
    """Keep the geometry that is read last in memory for a holder: a page shows the same files again and again."""
    _holders.add(id(holder))


def release_geometry(holder: object) -> None:
    """Keep it no longer for a holder; without holders it is released."""
    _holders.discard(id(holder))
    if not _holders:
        _held.clear()


class _GeometryCache:
    """The cache entry of one file with one set of read options."""

    def __init__(self, cache: Cache | None, step: Path, what: ReadOptions) -> None:
        self._cache, self._results, self._step = cache, TypedCache(cache, Geometry), step
        self._state = _state(step)
        self._content = input_digest(step) or ""
        self._key = ""
        if cache is not None and self._content:
            asked = codec_of(ReadOptions).encode(what)
            self._key = Digest("geometry").add(environment(), self._content, step.name, asked).key

    @property
    def content(self) -> str:
        return self._content if _state(self._step) == self._state else ""

    def get(self) -> Geometry | None:
        kept = _held.get(self._key)
        if kept is None and self._key:
            kept = self._results.get(self._key)
            if kept is not None and _holders:
                _held.clear()
                _held[self._key] = kept
        return _renamed(kept, self._names(kept)) if kept is not None else None

    def put(self, geometry: Geometry) -> None:
        """Store it, unless a file was changed during the read: then it is unknown which version was read."""
        if self.content:
            names = {place: name for name, place in self._names(geometry).items()}
            self._results.put(self._key, _renamed(geometry, names))
            note_read(self._cache, self._content)

    def _names(self, geometry: Geometry) -> dict[str, str]:
        """The path of each file in diagnostics, by its name in the cache: entries do not depend on the path."""
        others = {name: str(self._step.parent / name) for name in geometry.assembly.external_files}
        return {**others, "": str(self._step)}


def _state(step: Path) -> tuple[tuple[str, int, int], ...]:
    """Names, times and sizes of the files of an assembly; those that are missing are left out."""
    state = []
    for name, path in input_files(step).items():
        try:
            status = path.stat()
        except OSError:
            continue
        state.append((name, status.st_mtime_ns, status.st_size))
    return tuple(state)


def _renamed(geometry: Geometry, names: Mapping[str, str]) -> Geometry:
    """The same geometry with other paths in its diagnostics."""

    def moved(diagnostics: tuple[Diagnostic, ...]) -> tuple[Diagnostic, ...]:
        return tuple(d._replace(span=d.span._replace(file=names.get(d.span.file, d.span.file))) for d in diagnostics)

    assembly = replace(geometry.assembly, diagnostics=moved(geometry.assembly.diagnostics))
    return Geometry(assembly, geometry.measures, moved(geometry.diagnostics))
