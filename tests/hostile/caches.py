"""Cache entries are truncated, emptied, or have bytes flipped: the output is byte-identical."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from random import Random

from .command import stepbot
from .experiment import Experiment, Setting, Trial
from .robots import files_in, two_versions


def run(setting: Setting) -> Iterator[Trial]:
    """Convert with a full cache in which some or all entries are damaged."""
    version = two_versions()
    sidecar = version.folder / "new.robot.yaml"
    full = setting.folder / "full"
    shutil.copytree(version.cache, full)
    command = ("convert", sidecar, "--cache")
    filled = stepbot(*command, full, "-o", "filled", folder=setting.folder, temporary=setting.folder / "tmp")
    assert filled.code == 0, filled.text
    for number in range(setting.count):
        rng = Random(f"caches:{setting.seed}:{number}")
        place = setting.folder / f"trial{number}"
        shutil.copytree(full, place / "cache")
        entries = sorted(path for path in (place / "cache").rglob("*") if path.is_file())
        for entry in entries if number % 3 == 0 else rng.sample(entries, min(len(entries), 2)):
            _damage(entry, rng)
        ended = stepbot(*command, place / "cache", "-o", "out", folder=place, temporary=place / "tmp")
        faults = list(ended.faults((0,)))
        if files_in(place / "out") != version.new:
            faults.append("the files are not what they are without a cache")
        shutil.rmtree(place)
        yield Trial(f"{setting.seed}:{number}", "same bytes" if not faults else "fault", tuple(faults))


def _damage(entry: Path, rng: Random) -> None:
    data = bytearray(entry.read_bytes())
    way = rng.randrange(3)
    if way == 0 or not data:
        entry.write_bytes(b"")
    elif way == 1:
        entry.write_bytes(data[: rng.randrange(len(data))])
    else:
        for _ in range(rng.choice((1, 1, 16))):
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        entry.write_bytes(data)


EXPERIMENT = Experiment(
    "caches",
    "entries of the cache are emptied, cut off, or have bits flipped: two of them, or all",
    "the same files, to the byte",
    run,
    short=2,
    long=300,
)
