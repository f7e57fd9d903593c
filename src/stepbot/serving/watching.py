"""Shows targets again whenever one of their files is saved.

A thread reads and shows, within a fraction of a second. A process converts and verifies what is shown, which takes
seconds, and starts again if something else is to be shown meanwhile.
"""

import importlib.util
import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from threading import TIMEOUT_MAX, Event, Lock, Thread

from stepbot.jobs.incremental import failure_of, produce
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.pipeline.loading import hold_geometry
from stepbot.pipeline.prestart import stay_warm
from stepbot.pipeline.scenes import ShownScene
from stepbot.runtime.file import is_folder, resolved
from stepbot.runtime.worker import RemoteError, Worker, WorkerDied

from .session import Session

QUIET = 40
"""Milliseconds without a further change after which files count as saved."""
LOOK = 0.02
"""Seconds between two looks at the files of a page that edits."""
CALM = 0.5
"""Seconds without a further change after which a proof starts: a robot that was just changed is drawn first."""
NICE = 10
"""Priority of the prover's process: what a person waits for comes first."""
LONGEST = 400
"""Milliseconds after which changes count as saved although files still change."""


def can_watch() -> bool:
    """Whether the package that reports saved files is installed."""
    return importlib.util.find_spec("watchfiles") is not None


class Superseded(Exception):
    """A proof was ended because something else is about to be shown."""


class Prover:
    """Converts and verifies what sessions show, the latest state of each, one after the other.

    A process of its own does so, with a low priority: what is shown, and the page, do not wait for it. It keeps the
    geometry and the engines loaded; when a target is read again while it works, it is ended, and starts anew.
    """

    def __init__(self, sessions: Sequence[Session], report: Callable[[Session, Conversion], None]) -> None:
        """Start the thread, in which ``report`` is called with each result."""
        self._report = report
        self._wanted = {id(session): (session, Event()) for session in sessions}
        self._any, self._ended = Event(), False
        self._lock = Lock()
        self._worker: Worker | None = None
        self._is_working = self._is_superseded = False
        for session in sessions:
            session.on_reading = self.supersede
        self._thread = Thread(target=self._run, name="prover", daemon=True)
        self._thread.start()

    def ask(self, session: Session) -> None:
        """Verify what a session shows now."""
        self._wanted[id(session)][1].set()
        self._any.set()

    def supersede(self) -> None:
        """End the proof that runs, if any; it is done again unless something else is shown meanwhile."""
        with self._lock:
            if self._worker is not None and self._is_working:
                self._is_superseded = True
                self._worker.kill()

    def close(self) -> None:
        """Take no further work."""
        self._ended = True
        self._any.set()
        self.supersede()
        self._thread.join()
        if self._worker is not None:
            self._worker.close()

    def _run(self) -> None:
        while not self._ended:
            self._any.wait()
            while self._any.is_set() and not self._ended:
                self._any.clear()
                self._any.wait(CALM)
            for session, wanted in self._wanted.values():
                if wanted.is_set() and not self._ended:
                    wanted.clear()
                    try:
                        conversion = session.prove(self._produce)
                    except Superseded:
                        self.ask(session)
                    else:
                        if conversion is not None:
                            self._report(session, conversion)

    def _produce(self, sidecar: Path, options: Options) -> Conversion:
        with self._lock:
            if self._ended:
                raise Superseded
            if self._worker is None:
                self._worker = Worker(f"{__name__}:{proof.__name__}")
            worker = self._worker
            self._is_working, self._is_superseded = True, False
        try:
            conversion: Conversion = worker.submit(sidecar, options, more=True).result(TIMEOUT_MAX)
        except (WorkerDied, RemoteError) as error:
            with self._lock:
                self._worker, self._is_working = None, False
            worker.close()
            if self._is_superseded:
                raise Superseded from error
            return Conversion(failure_of(sidecar, error))
        with self._lock:
            self._is_working = False
        return conversion


def prepare() -> None:
    """Prepare the prover's process: engines and geometry stay loaded until it ends."""
    if hasattr(os, "nice"):
        os.nice(NICE)
    hold_geometry(prepare)
    stay_warm()


def proof(sidecar: Path, options: Options) -> Conversion:
    """Convert a sidecar, in the prover's process."""
    return produce(sidecar, options)._replace(robot=None)


def follow(session: Session, changed: Callable[[ShownScene], None], ended: Event) -> None:
    """Show a session's target again when another program saves one of its files, until ``ended`` is set.

    It looks at the files 50 times a second, without `watchfiles`; the page's own edits are shown already. ``changed``
    is called after each reading.
    """
    while not ended.wait(LOOK):
        shown = session.refresh()
        if shown is not None:
            changed(shown)


def watch(sessions: Sequence[Session], changed: Callable[[Session, ShownScene], None], ended: Event) -> None:
    """Show each session's target again when one of its files changes, and call ``changed``, until ``ended`` is set."""
    from watchfiles import watch as changes

    while not ended.is_set():
        folders = _folders(sessions)
        for batch in changes(
            *folders, watch_filter=None, debounce=LONGEST, step=QUIET, stop_event=ended, recursive=False
        ):
            paths = {resolved(Path(path)) for _, path in batch}
            for session in sessions:
                if paths & {resolved(path) for path in session.files}:
                    changed(session, session.load())
            if _folders(sessions) != folders:  # a sidecar names a STEP file elsewhere
                break


def _folders(sessions: Iterable[Session]) -> list[Path]:
    """The folders of all files: editors replace a file when they save it, which only its folder reports."""
    return sorted({resolved(path).parent for session in sessions for path in session.files if is_folder(path.parent)})
