"""``convert`` and ``batch`` are interrupted, terminated or killed at random moments."""

import os
import shutil
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random

from msgspec import Struct
from msgspec.structs import replace

from .command import Ended, start, stepbot
from .experiment import Experiment, Setting, Trial
from .robots import Versions, files_in, two_versions

_SIGNALS = ("SIGKILL", "SIGTERM", "SIGINT")
_BATCH = ("stepbot_arm2", "stepbot_four_bar")
_CODES = {"SIGKILL": (-9,), "SIGTERM": (143, -15), "SIGINT": (130, -2)}
"""Accepted exit codes: Python is killed by the signal itself before it has a handler for it."""


def run(setting: Setting) -> Iterator[Trial]:
    """Start, send the signal after a random time, inspect the remains, and run again."""
    batch: _Batch | None = None
    for number in range(setting.count):
        rng = Random(f"kills:{setting.seed}:{number}")
        sent = _SIGNALS[number % len(_SIGNALS)]
        is_batch = number % 4 == 3
        place = setting.folder / f"trial{number}"
        place.mkdir()
        what = "batch" if is_batch else "convert"
        if is_batch:
            batch = batch or _batch_files(setting.folder / "batch", {name: two_versions(name) for name in _BATCH})
            outcome, faults = _batch(place, batch, sent, rng)
        else:
            outcome, faults = _convert(place, two_versions(_BATCH[0]), sent, rng)
        shutil.rmtree(place)
        yield Trial(f"{what}:{sent}:{setting.seed}:{number}", outcome, tuple(faults))


def _convert(place: Path, version: Versions, sent: str, rng: Random) -> tuple[str, list[str]]:
    output, cache = place / "out", place / "cache"
    version.put_old(output)
    if rng.random() < 0.8:  # without it, the kernel runs for most of the time
        shutil.copytree(version.cache, cache)
    command = ("convert", version.folder / "new.robot.yaml", "-o", output, "--cache", cache)
    ended = _ended_by(sent, command, place, rng.uniform(0.0, 1.2 * version.seconds))
    faults = _faults(ended, sent) + version.torn(output)
    kept = files_in(output)
    if sent != "SIGKILL" and kept not in (version.old, version.new):
        faults.append(f"neither the old folder nor the new one: {sorted(kept)}")
    again = stepbot(*command, folder=place, temporary=place / "tmp")
    faults += [*again.faults((0,)), *_left(place)]
    if files_in(output) != version.new:
        faults.append(f"after another run the folder is not the new one: {_difference(files_in(output), version.new)}")
    return _outcome(ended, kept == version.new), faults


class _Batch(Struct, frozen=True):
    """Robots that are converted together, each with its own version."""

    robots: dict[str, Versions]
    new: dict[str, dict[str, bytes]]
    """Expected files: reports name a sidecar by the path given."""


def _batch_files(place: Path, versions: dict[str, Versions]) -> _Batch:
    place.mkdir()
    command = _put_batch(place, versions)
    ended = stepbot(*command, folder=place, temporary=place / "tmp")
    assert ended.code == 0, ended.text
    new = {name: files_in(place / "out" / name) for name in versions}
    return _Batch({name: replace(one, new=new[name]) for name, one in versions.items()}, new)


def _put_batch(place: Path, versions: dict[str, Versions]) -> tuple[str, ...]:
    """Put a batch with its old output into a folder; returns the command that converts it."""
    for name, version in versions.items():
        source = place / "robots" / name
        source.mkdir(parents=True)
        shutil.copy(version.folder / "new.robot.yaml", source / f"{name}.robot.yaml")
        shutil.copy(next(version.folder.glob("*.step")), source)
        version.put_old(place / "out" / name)
    shutil.copytree(versions[_BATCH[0]].cache, place / "cache")
    return ("batch", "robots", "-o", "out", "--cache", "cache")


def _batch(place: Path, batch: _Batch, sent: str, rng: Random) -> tuple[str, list[str]]:
    command = _put_batch(place, batch.robots)
    ended = _ended_by(sent, command, place, rng.uniform(0.0, 2.5 * batch.robots[_BATCH[0]].seconds))
    faults = _faults(ended, sent)
    kept = {name: files_in(place / "out" / name) for name in batch.robots}
    for name, version in batch.robots.items():
        faults += version.torn(place / "out" / name)
    again = stepbot(*command, folder=place, temporary=place / "tmp")
    faults += [*again.faults((0,)), *_left(place)]
    for name, files in batch.new.items():
        if files_in(place / "out" / name) != files:
            difference = _difference(files_in(place / "out" / name), files)
            faults.append(f"after another run {name} is not the new one: {difference}")
    return _outcome(ended, kept == batch.new), faults


def _ended_by(sent: str, command: tuple[str | Path, ...], place: Path, seconds: float) -> Ended:
    running = start(*command, folder=place, temporary=place / "tmp")
    time.sleep(seconds)
    if running.process.poll() is None:
        number = getattr(signal, sent)
        # A terminal sends Ctrl-C to all processes of the group, `kill` to one.
        (os.killpg if sent == "SIGINT" else os.kill)(running.process.pid, number)
    return running.wait()


def _faults(ended: Ended, sent: str) -> list[str]:
    """Defects before the next run, which may find temporary files of a run that could not remove them."""
    found = ended.faults((0, *_CODES[sent]))
    return [fault for fault in found if ended.code >= 0 or not fault.startswith("left behind: temporary")]


def _left(place: Path) -> list[str]:
    """Remains after the next run, which uses the same folder for temporary files."""
    return [f"another run leaves temporary file {path.name}" for path in (place / "tmp").iterdir()]


def _outcome(ended: Ended, is_new: bool) -> str:
    if ended.code == 0:
        return "ended before"
    return "new files" if is_new else "old files, or some of each"


def _difference(kept: dict[str, bytes], wanted: dict[str, bytes]) -> list[str]:
    return sorted(name for name in {*kept, *wanted} if kept.get(name) != wanted.get(name))


EXPERIMENT = Experiment(
    "kills",
    "`convert` and `batch` end by SIGKILL, SIGTERM or SIGINT at a random moment",
    "each file is the old or the new one, after SIGTERM and SIGINT all of them; no process, temporary file or shared "
    "memory is left; the next run ends as if nothing had happened",
    run,
    short=2,
    long=400,
    repaired=(
        "engines that were ended by SIGTERM or SIGKILL left their copies of robots in the folder for temporary files",
        "Ctrl-C while the command line was imported printed a traceback",
        "SIGTERM while a native module was imported aborted the process (SIGABRT)",
    ),
)
