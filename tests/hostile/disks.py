"""The disk of the output, of the cache, or of temporary files fills up during a conversion."""

import os
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from random import Random

from .command import full_disk, stepbot
from .experiment import Experiment, Setting, Trial
from .robots import Versions, files_in, two_versions

_WHICH = ("output", "cache", "temporary")
_PAGE = 4096
"""Block size [bytes] of a file system in memory."""


def run(setting: Setting) -> Iterator[Trial]:
    """Convert with one folder on a disk with space for nothing, for some files, or for nearly all."""
    version = two_versions()
    for number in range(setting.count):
        rng = Random(f"disks:{setting.seed}:{number}")
        which = _WHICH[number % len(_WHICH)]
        place = setting.folder / f"trial{number}"
        disk = place / "disk"
        disk.mkdir(parents=True)
        # About a twentieth of the trials have no space at all.
        room = max(rng.uniform(-0.05, 1.0), 0.0) * (_needed(version.new) if which == "output" else 400_000)
        size = int(room) + (_needed(version.old) if which == "output" else 2 * _PAGE)
        with full_disk(disk, size) as mounted:
            outcome, faults = _tried(version, which, place, disk) if mounted else (NOT_RUN, [])
        shutil.rmtree(place)
        yield Trial(f"{which}:{setting.seed}:{number}", outcome, tuple(faults))


NOT_RUN = "not run: this user may not mount a file system"


def _tried(version: Versions, which: str, place: Path, disk: Path) -> tuple[str, list[str]]:
    folders = {"output": place / "out", "cache": place / "cache", "temporary": place / "tmp"}
    folders[which] = disk / which
    output, cache = folders["output"], folders["cache"]
    version.put_old(output)
    if which != "cache":
        shutil.copytree(version.cache, cache)
    command = ("convert", "-v", version.folder / "new.robot.yaml", "-o", output, "--cache", cache)
    ended = stepbot(*command, folder=place, temporary=folders["temporary"])
    faults = list(ended.faults((0,) if which == "cache" else (0, 2)))
    wanted = version.old if ended.code else version.new
    if files_in(output) != wanted:
        faults.append(f"after exit code {ended.code} the files are {sorted(files_in(output))}")
    faults += [f"leaves '{path}' behind" for path in _unfinished(output, cache)]
    if which == "output" and ended.code and "SB004" not in ended.text:
        faults.append(f"SB004 is not reported\n{ended.text[-1000:]}")
    if which == "cache" and not os.statvfs(disk).f_bavail and "SB006" not in ended.text:
        faults.append(f"SB006 is not reported\n{ended.text[-1000:]}")
    if ended.code and "No space left" not in ended.text:
        faults.append(f"does not say that there is no space left\n{ended.text[-1000:]}")
    return f"{which} {'refused' if ended.code else 'converted'}", faults


def _unfinished(output: Path, cache: Path) -> list[Path]:
    """Files that are being written."""
    return [*output.glob(".stepbot-*"), *cache.rglob(".new-*")]


def _needed(files: Mapping[str, bytes]) -> int:
    """Size [bytes] of a disk in memory for these files and their folders."""
    return sum(-(-len(content) // _PAGE) * _PAGE for content in files.values()) + 4 * _PAGE


EXPERIMENT = Experiment(
    "disks",
    "`convert` with the disk full of the output, the cache or temporary files: a file system of a random size",
    "SB004 with the reason, the old files, and nothing left over; where the cache is full, SB006 and the new files",
    run,
    short=2,
    long=150,
)
