"""``stepbot lock``: write the lock files of sidecars."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics, counted
from stepbot.runtime.file import is_folder, resolved

from .command import PATH, Command, display_options, ignore_option
from .diagnostic_text import printable
from .progress import progress_bar
from .reading import reading_options, reject_descriptions, reject_one_step_for_all, report_trouble, variant_option
from .terminal import Display, show_diagnostics, write_document, write_result, write_verdict

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options
    from stepbot.revisions.snapshot import Snapshot


@click.command(cls=Command, epilog="Example: stepbot lock arm.robot.yaml")
@click.argument("sidecars", metavar="[SIDECAR|DIR]...", nargs=-1, type=PATH)
@click.option("--step", type=PATH, metavar="FILE", help="STEP file, instead of the one in SIDECAR.")
@ignore_option
@reading_options
@variant_option
@display_options
def command(options: "Options", sidecars: tuple[Path, ...], step: Path | None, display: Display) -> int:
    """Write `<robot>.lock.json` beside each sidecar: shape, pose and mass of each component, axis of each joint.

    After a CAD change, `check --step` and `convert` compare the STEP file with it and report what was renamed, moved,
    added, removed or reshaped. The sidecars that a robot is composed of have a lock each. Folders are searched
    recursively; the default is the current folder. A robot with errors is not locked. The home folder
    and those above it are refused, since locks would be written beside robots of others.
    """
    from stepbot.jobs.discovery import find_sidecars, without_lists
    from stepbot.pipeline.locking import make_locks
    from stepbot.revisions.lock_file import lock_bytes
    from stepbot.runtime.file import write_file

    options = options._replace(step=step)
    diagnostics = Diagnostics()
    written: dict[Path, Snapshot] = {}
    named = list(without_lists(sidecars or (Path(),), diagnostics))
    _reject_whole_disks(named)
    paths = find_sidecars(named, diagnostics)
    reject_descriptions("lock", paths)
    reject_one_step_for_all(step, named, paths)
    with progress_bar([str(path) for path in paths], options) as progress:
        for sidecar in paths:
            progress(str(sidecar))
            for path, locked in make_locks(sidecar, options, diagnostics, written).items():
                writing = Diagnostics()
                write_file(path, lock_bytes(locked), writing)
                if not writing.has_errors:
                    written[path] = locked
                diagnostics.extend(writing)
    report_trouble(options.cache, diagnostics)
    if display.json:
        files = [{"lock": path.as_posix(), **_counts(taken)} for path, taken in written.items()]
        return write_document({"files": files}, diagnostics)
    subject = f"{counted(len(written), 'lock file')} written:"
    show_diagnostics(diagnostics, display, after_verdict=write_verdict(subject, diagnostics, display))
    if display.shows_results:
        for path, taken in written.items():
            words = ", ".join(counted(number, noun.removesuffix("s")) for noun, number in _counts(taken).items())
            write_result(printable(f"{path.as_posix()}: {words} of {taken.source}"))
        if not (written or diagnostics.has_errors):
            write_result("nothing to lock: composed of modules without sidecars of their own, or of the library")
    return diagnostics.exit_code


def _reject_whole_disks(named: Iterable[Path]) -> None:
    """Refuse folders with files of others below them.

    Raises:
        click.UsageError: One is the root of the file system, the home folder, or a folder above it.
    """
    home = resolved(Path.home())
    whole = (home, *home.parents, Path(home.anchor))
    for path in named:
        if is_folder(path) and resolved(path) in whole:
            name = printable(path.as_posix())
            raise click.UsageError(f"'{name}' has more than your robots below it: name their folder, or the sidecars")


def _counts(snapshot: "Snapshot") -> dict[str, int]:
    return {"components": len(snapshot.parts), "joints": len(snapshot.joints)}
