"""Six conversions at once, with one cache and into one folder."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from random import Random

from .command import start
from .experiment import Experiment, Setting, Trial
from .robots import Versions, files_in, two_versions

AT_ONCE = 6


def run(setting: Setting) -> Iterator[Trial]:
    """Convert one version six times, or both versions, with the geometry cached or not."""
    version = two_versions()
    for number in range(setting.count):
        rng = Random(f"concurrent:{setting.seed}:{number}")
        place = setting.folder / f"trial{number}"
        place.mkdir()
        yield Trial(f"{setting.seed}:{number}", *_tried(version, place, number % 2 == 1, rng))
        shutil.rmtree(place)


def _tried(version: Versions, place: Path, is_mixed: bool, rng: Random) -> tuple[str, tuple[str, ...]]:
    if rng.random() < 0.5:
        shutil.copytree(version.cache, place / "cache")
    names = [rng.choice(("old", "new")) if is_mixed else "new" for _ in range(AT_ONCE)]
    running = [
        start(
            *("convert", version.folder / f"{name}.robot.yaml", "-o", "out", "--cache", "cache"),
            folder=place,
            temporary=place / f"tmp{number}",
        )
        for number, name in enumerate(names)
    ]
    ended = [one.wait() for one in running]
    faults = [fault for one in ended for fault in one.faults((0, 2))]
    refused = [one for one in ended if one.code]
    faults += [
        f"refused, but not for the folder being in use\n{one.text}" for one in refused if "SB004" not in one.text
    ]
    kept = files_in(place / "out")
    if kept not in [getattr(version, name) for name in names]:
        faults.append(f"the folder is that of no lone run: {sorted(kept)}")
    faults += [f"leaves '{path.name}' behind" for path in (place / "out").glob(".stepbot-*")]
    faults += [f"leaves '{path.name}' behind" for path in (place / "cache").rglob(".new-*")]
    return f"{len(ended) - len(refused)} of {len(ended)} converted", tuple(faults)


EXPERIMENT = Experiment(
    "concurrent",
    f"{AT_ONCE} conversions at once, of one robot or of two versions of it, with one cache and into one folder",
    "each converts, or reports SB004; the folder is that of a lone run, to the byte",
    run,
    short=1,
    long=60,
)
