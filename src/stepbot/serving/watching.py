"""Shows targets again whenever one of their files is saved.

Two threads: one reads and shows, within a fraction of a second; the other converts and verifies what is shown, which
takes seconds, and starts again if something else is shown meanwhile.
"""

import importlib.util
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from threading import Event, Thread

from stepbot.pipeline.conversion import Conversion
from stepbot.pipeline.scenes import Shown
from stepbot.runtime.file import is_folder, resolved

from .session import Session

QUIET = 40
"""Milliseconds without a further change after which files count as saved."""
LOOK = 0.02
"""Seconds between two looks at the files of a page that edits."""
LONGEST = 400
"""Milliseconds after which changes count as saved although files still change."""


def can_watch() -> bool:
    """Whether the package that reports saved files is installed."""
    return importlib.util.find_spec("watchfiles") is not None


class Prover:
    """Converts and verifies what sessions show, the latest state of each, one after the other."""

    def __init__(self, sessions: Sequence[Session], report: Callable[[Session, Conversion], None]) -> None:
        """Start the thread.

        Args:
            report: Called with each result, in the thread.
        """
        self._report = report
        self._wanted = {id(session): (session, Event()) for session in sessions}
        self._any, self._ended = Event(), False
        self._thread = Thread(target=self._run, name="prover", daemon=True)
        self._thread.start()

    def ask(self, session: Session) -> None:
        """Verify what a session shows now."""
        self._wanted[id(session)][1].set()
        self._any.set()

    def close(self) -> None:
        """Take no further work."""
        self._ended = True
        self._any.set()

    def _run(self) -> None:
        while True:
            self._any.wait()
            self._any.clear()
            if self._ended:
                return
            for session, wanted in self._wanted.values():
                if wanted.is_set():
                    wanted.clear()
                    conversion = session.prove()
                    if conversion is not None:
                        self._report(session, conversion)


def follow(session: Session, changed: Callable[[Shown], None], ended: Event) -> None:
    """Show a session's target again when another program saves one of its files, until ``ended`` is set.

    It looks at the files 50 times a second, without `watchfiles`; the page's own edits are shown already.

    Args:
        changed: Called after each reading.
        ended: Ends the function.

    Raises:
        KeyboardInterrupt: Ctrl-C.
    """
    while not ended.wait(LOOK):
        shown = session.refresh()
        if shown is not None:
            changed(shown)


def watch(sessions: Sequence[Session], changed: Callable[[Session, Shown], None], ended: Event) -> None:
    """Show each session's target again when one of its files changes, until ``ended`` is set.

    Args:
        changed: Called after each reading.
        ended: Ends the function.

    Raises:
        KeyboardInterrupt: Ctrl-C.
    """
    from watchfiles import watch as changes

    while not ended.is_set():
        folders = _folders(sessions)
        for found in changes(
            *folders, watch_filter=None, debounce=LONGEST, step=QUIET, stop_event=ended, recursive=False
        ):
            paths = {resolved(Path(path)) for _, path in found}
            for session in sessions:
                if paths & {resolved(path) for path in session.files}:
                    changed(session, session.load())
            if _folders(sessions) != folders:  # a sidecar names a STEP file elsewhere
                break


def _folders(sessions: Iterable[Session]) -> list[Path]:
    """The folders of all files: editors replace a file when they save it, which only its folder reports."""
    return sorted({resolved(path).parent for session in sessions for path in session.files if is_folder(path.parent)})
