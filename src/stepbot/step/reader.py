"""Reads STEP files: the kernel runs in a separate process, so that any failure becomes a diagnostic.

reading = start_reading(path, options)      the kernel loads and reads while the caller continues
assembly = reading.finish(diagnostics)      waits; None where nothing can be read, incomplete where files are missing
"""

import ctypes.util
import re
import tempfile
import time
from pathlib import Path

from msgspec import Struct

from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.parallel import Attempt
from stepbot.runtime.temporary import run_folder
from stepbot.runtime.worker import OutOfTime, RemoteError, Worker, WorkerDied

from . import BODY_SECONDS, KERNEL
from .assembly import Assembly, ReadOptions
from .exchange.file_set import StepFile, check_files

_SYSTEM_LIBRARIES = {"libGL.so.1": "libgl1", "libX11.so.6": "libx11-6", "libexpat.so.1": "libexpat1"}
"""Shared libraries that the kernel's wheel requires from the system, and their Debian packages."""
_NOT_LOADED = re.compile(r"DLL load failed|dlopen|\bOCP\b|undefined symbol|GLIBC")
"""Error messages of systems for a kernel that is installed but does not load."""
_LARGE = 30_000_000
"""Size [bytes] of an assembly's files above which the time limit grows in proportion."""
_MISSING_LIBRARY = re.compile(r"(\S+\.so[.\d]*): cannot open shared object file")


class _Order(Struct, frozen=True):
    """A request to the kernel's process."""

    files: tuple[StepFile, ...]
    options: ReadOptions
    memory_limit: int | None
    folder: "tempfile.TemporaryDirectory[str]"
    """File in which that process records the current body."""

    def submit(self, worker: Worker, attempt: Attempt) -> Worker:
        return worker.submit(self.files, self.options, attempt)


class Reading:
    """A STEP file that is being read."""

    def __init__(self, worker: Worker | None, order: _Order | None, place: str, diagnostics: Diagnostics) -> None:
        self._worker, self._order, self._place, self._diagnostics = worker, order, place, diagnostics
        if order is not None and worker is not None:
            self._attempt = Attempt(order.folder.name, BODY_SECONDS)
            order.submit(worker, self._attempt)

    @property
    def pid(self) -> int | None:
        """Id of the kernel's process; None if there is none, or no longer."""
        return self._worker.pid if self._worker is not None else None

    def finish(self, diagnostics: Diagnostics, timeout: float = DEFAULT_TIMEOUT) -> Assembly | None:
        """Wait for the assembly.

        Args:
            timeout: Seconds after which the kernel is stopped, for files of up to 30 MB; in proportion for larger ones.

        Returns:
            None where nothing can be read. Bodies that fail and files that are missing are errors too, with an assembly
            without them.
        """
        diagnostics.extend(self._diagnostics)
        if self._worker is None:
            return None
        try:
            assembly, reported = self._result(timeout * self._size_factor)
        except WorkerDied as death:
            _report_death(death, self._place, timeout, diagnostics)
            return None
        except RemoteError as error:
            if not _report_import(error, diagnostics, self._place):
                raise
            return None
        finally:
            self.close()
        diagnostics.extend(reported)
        return _read_only(assembly) if assembly is not None else None

    def close(self) -> None:
        """Stop reading; safe to call at any time."""
        if self._worker is not None:
            self._worker.close()
            self._worker = None
        if self._order is not None:
            self._order.folder.cleanup()

    @property
    def _size_factor(self) -> float:
        """1 for files of up to 30 MB."""
        files = () if self._order is None else self._order.files
        return max(1.0, sum(file.part21.size for file in files) / _LARGE)

    def _result(self, timeout: float) -> tuple[Assembly | None, tuple[Diagnostic, ...]]:
        """The result of the kernel's process, or of another one that skips the bodies that ended earlier processes."""
        assert self._worker is not None
        deadline, left = time.monotonic() + timeout, timeout
        while True:
            try:
                answer: tuple[Assembly | None, tuple[Diagnostic, ...]] = self._worker.result(left)
            except WorkerDied as death:
                if time.monotonic() >= deadline:  # the last process had what was left of the time
                    raise OutOfTime(timeout, death.last_lines) from death
                again = self._attempt.after(death.reason) if self._order is not None else None
                if again is None or self._order is None:
                    raise
                self._attempt, left = again, max(deadline - time.monotonic(), 0.0)
                self._worker = self._order.submit(Worker(KERNEL, memory_limit=self._order.memory_limit), again)
            else:
                return answer


def start_reading(
    path: Path, options: ReadOptions, *, memory_limit: int | None = None, kernel: Worker | None = None
) -> Reading:
    """Start to read a STEP file; returns at once.

    Args:
        path: The file; diagnostics use this path.
        memory_limit: Address space [bytes] of the kernel's process; None for no limit.
        kernel: A process started in advance; None to start one.
    """
    diagnostics = Diagnostics()
    place = str(path)
    worker = kernel or Worker(KERNEL, memory_limit=memory_limit)
    try:
        files = check_files(path, place, diagnostics, options.encoding)
        if files is not None:
            folder = tempfile.TemporaryDirectory(dir=run_folder(), ignore_cleanup_errors=True)
            return Reading(worker, _Order(files, options, memory_limit, folder), place, diagnostics)
    except BaseException:  # Ctrl-C: the process is no longer needed
        worker.close()
        raise
    worker.close()
    return Reading(None, None, place, diagnostics)


def read_assembly(path: Path, options: ReadOptions, diagnostics: Diagnostics) -> Assembly | None:
    """Read a STEP file; None where nothing can be read. Errors in ``diagnostics``: the assembly is incomplete."""
    return start_reading(path, options).finish(diagnostics)


def _report_death(death: WorkerDied, place: str, timeout: float, diagnostics: Diagnostics) -> None:
    again = "open the file in another CAD program and export it again"
    if isinstance(death, OutOfTime):
        message = f"the geometry kernel was stopped while reading the file: {death.reason}"
        remedies = [f"allow more time: `--timeout {4.0 * timeout:g}`", again]
    else:
        message = f"the geometry kernel died while reading the file: {death.reason}"
        remedies = [again, "raise `--memory-limit`"]
    diagnostics.add("SB902", message, Span(place), help=remedies, notes=death.last_lines)


def _report_import(error: RemoteError, diagnostics: Diagnostics, place: str) -> bool:
    """Whether the kernel could not be loaded, and what is missing."""
    if error.kind == "ModuleNotFoundError" and "OCP" in error.text:
        diagnostics.add(
            "SB003", "the geometry kernel is not installed", Span(place), help=["pip install cadquery-ocp-novtk"]
        )
        return True
    named = _MISSING_LIBRARY.findall(error.text)
    if error.kind != "ImportError" or not (named or _NOT_LOADED.search(error.text)):
        return False  # a failed import of stepbot's own code is a bug
    missing = [library for library in _SYSTEM_LIBRARIES if library in named or not _loads(library)] if named else []
    others = [library for library in named if library not in missing]
    packages = " ".join(_SYSTEM_LIBRARIES[library] for library in missing)
    what = ", ".join([*missing, *others]) or error.text
    remedies = [f"on Debian or Ubuntu: apt-get install {packages}"] if missing else []
    remedies += [f"install the system package that provides {library}" for library in others]
    diagnostics.add("SB002", f"the geometry kernel failed to load: {what} is missing", Span(place), help=remedies)
    return True


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def _read_only(assembly: Assembly) -> Assembly:
    """Make arrays read-only, since they are shared; they are writable when received from the process."""
    for body in assembly.bodies:
        for array in (body.mesh.vertices, body.mesh.faces, body.face_colors):
            array.setflags(write=False)
    return assembly
