"""Detection of one changed number in one of a robot's three files, by `stepbot verify` and by a conversion's checks.

Engines crash on some files, so each trial is a fork of this process, which has loaded the engines.
"""

import json
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from itertools import islice
from pathlib import Path
from typing import Any

from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines import Engine, engines_for
from stepbot.engines.observation import EngineCannotRead, EngineRefused, Observation, Request
from stepbot.engines.workers import Fate, Outcome
from stepbot.robot.model import Robot
from stepbot.verification.compare import compare
from stepbot.verification.files import ask
from stepbot.verification.judging import judge
from stepbot.verification.probe import Probe
from tests.simulators.conftest import Folder, write

from .changes import Change, changes
from .judge import CONFIGURATIONS, question
from .trial import Flawed

FORMATS = ("urdf", "sdf", "mjcf")
"""In the order in which the files are verified."""


class Noticed(Struct, frozen=True):
    """The outcome of a change."""

    robot: str
    format: str
    change: Change
    by_verify: str
    """What `stepbot verify` reports about the three files; empty if nothing."""
    by_conversion: str
    """What the verification of a conversion reports about the changed file; empty if nothing."""


def trials(robots: Mapping[str, Callable[[], Robot]], folder: Path, of_each: int) -> Iterator[Noticed]:
    """Change numbers in every file of every robot, one at a time, the same in every run.

    Args:
        robots: The robots by name.
        folder: Folder for the files.
        of_each: Number of changes tried per file.

    Raises:
        Flawed: A difference is reported for unchanged files.
    """
    for name, build in robots.items():
        siblings = Siblings(write(build(), folder / name))
        wrong = [siblings.by_verify({})] + [siblings.by_conversion(one, siblings.files[one]) for one in FORMATS]
        if any(wrong):
            raise Flawed(f"{name}: {'; '.join(filter(None, wrong))}")
        for written_in in FORMATS:
            path = siblings.files[written_in]
            beside = path.with_name(f"changed_{path.name}")  # in the same folder, where its meshes are found too
            for change in islice(changes(path.read_bytes(), f"{name}/{written_in}"), of_each):
                beside.write_bytes(change.content)
                yield Noticed(name, written_in, change, *_in_a_fork(siblings, written_in, beside))
            beside.unlink(missing_ok=True)


def _in_a_fork(siblings: "Siblings", written_in: str, beside: Path) -> tuple[str, str]:
    """What verification and conversion report about a changed file."""
    answers, mine = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(answers)
        try:
            os.dup2(os.open(os.devnull, os.O_RDWR), 2)
            reports = siblings.by_verify({written_in: beside}), siblings.by_conversion(written_in, beside)
            os.write(mine, json.dumps(reports).encode())
        finally:
            os._exit(0)
    os.close(mine)
    with os.fdopen(answers, "rb") as stream:
        received = stream.read()
    os.waitpid(child, 0)
    by_verify, by_conversion = json.loads(received) if received else ("an engine dies", "an engine dies")
    return by_verify, by_conversion


class Siblings:
    """The three files of a robot."""

    def __init__(self, folder: Folder) -> None:
        self.files = {name: folder.written[name].path for name in FORMATS}
        self._asked = {name: question(folder.request(name)) for name in FORMATS}
        self._expected = {name: folder.expected(name, self._asked[name]) for name in FORMATS}
        self._known: dict[str, Observation] = {}

    def by_verify(self, changed: Mapping[str, Path]) -> str:
        """The first error of `stepbot verify` for the files, with some replaced; empty if there is none."""
        formats = {changed.get(name, path): name for name, path in self.files.items()}
        diagnostics = Diagnostics()
        places, probe = {path: path for path in formats}, Probe(self._probed)
        asked = ask(formats, places, probe, probe.files(formats, places), count=CONFIGURATIONS, seconds=0.0)
        outcomes = [
            self._outcome(key, engine, request)
            for key, request in asked.requests.items()
            for engine in engines_for(request.format)
        ]
        judge(outcomes, asked, diagnostics)
        return next((f"{one.code}: {one.message[:200]}" for one in diagnostics if one.severity == "error"), "")

    def by_conversion(self, written_in: str, path: Path) -> str:
        """The first difference that an engine or parser reports between a file and the converted robot."""
        request = replace(self._asked[written_in], file=str(path))
        for engine in engines_for(written_in):
            outcome = self._outcome(path.as_posix(), engine, request)
            if outcome.fate in (Fate.REFUSED, Fate.BROKEN):
                return f"{engine.name}: {outcome.fate}"
            for one in compare(self._expected[written_in], outcome.observation) if outcome.observation else ():
                if one.deviations.failures and not one.not_run:
                    return f"{engine.name}: {one.quantity.value}: {str(one.deviations.failures[0])[:200]}"
        return ""

    def _outcome(self, key: str, engine: Engine, request: Request) -> Outcome:
        def outcome(fate: Fate, **more: Any) -> Outcome:
            return Outcome(key, request.format, engine.name, fate, **more)

        if engine.available() is not None:
            return outcome(Fate.ABSENT, reason="not installed")
        try:
            return outcome(Fate.OBSERVED, observation=self._observe(engine, request))
        except EngineRefused as error:
            return outcome(Fate.REFUSED, reason=str(error))
        except EngineCannotRead as error:
            return outcome(Fate.UNREADABLE, reason=str(error))
        except Exception as error:  # noqa: BLE001 - in verify, too, an engine that fails fails its check
            return outcome(Fate.BROKEN, reason=f"{type(error).__name__}: {error}")

    def _probed(self, engine: Engine, request: Request) -> Observation | None:
        return self._outcome("", engine, request).observation

    def _observe(self, engine: Engine, request: Request) -> Observation:
        """An engine's observation; cached for the same file and request."""
        key = f"{engine.name} {request!r}"
        if key not in self._known or "changed_" in request.file:
            with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                self._known[key] = engine.observer.observe(request)
        return self._known[key]
