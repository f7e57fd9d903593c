"""Locks of sidecars: created from an assembly, and compared with it after a change of the CAD."""

import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path

from msgspec import Struct
from msgspec.structs import replace

from stepbot.assemble import bind, build_robot
from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.geometry.volume import VolumeProperties
from stepbot.revisions import lock_path
from stepbot.revisions.broken_paths import certain_renamings, renamed_lock
from stepbot.revisions.comparison import Comparison, report_outdated, revised
from stepbot.revisions.findings import report_changes
from stepbot.revisions.lock_file import lock_bytes, read_lock
from stepbot.revisions.snapshot import Snapshot, snapshot, with_sidecar
from stepbot.runtime.file import exists, is_file, read_regular, resolved
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.own_part import own_part
from stepbot.sidecar.rewriting import rewritten
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import quoted

from .conversion import Options
from .loading import Loading
from .sidecars import SIDECAR_SUFFIXES, load, named_step, what_to_read


def compared_with_lock(
    sidecar: Sidecar,
    assembly: Assembly,
    measures: Callable[[], Sequence[VolumeProperties | None]],
    digest: str,
    options: Options,
    diagnostics: Diagnostics,
) -> Comparison | None:
    """Compare an assembly with the lock of its sidecar, and report what has changed.

    Args:
        sidecar: The sidecar, without errors of its own.
        measures: Gives for each of ``assembly.bodies`` what trimesh measures on its mesh.
        digest: Hash of the STEP's bytes; empty if unknown.
        options: Whether another STEP was given than the one that the sidecar names.

    Returns:
        The comparison; None where there is no lock, or it was made of the same STEP.
    """
    lock = read_lock(lock_path(sidecar.path, sidecar.variant), sidecar.document.robot, diagnostics)
    if lock is None:
        return None
    report_outdated(lock, sidecar, diagnostics)
    if digest and digest == lock.digest:
        return None
    compared = revised(sidecar, assembly, lock, measures(), digest)
    compared = replace(compared, step=options.step.as_posix() if options.step is not None else "")
    report_changes(compared, diagnostics)
    return compared


def make_locks(
    sidecar: Path, options: Options, diagnostics: Diagnostics, done: Iterable[Path] = ()
) -> dict[Path, Snapshot]:
    """The lock of a sidecar with a STEP, and of each sidecar that it is composed of, other than those of the library.

    Args:
        options: The codes to ignore, and another STEP, for the sidecar itself.
        done: Paths of locks that are not made again.

    Returns:
        Their content by path; a robot with errors has none.
    """
    made: dict[Path, Snapshot] = {}
    seen = {resolved(path) for path in done}
    waiting = [(sidecar, options)]
    for path, of_path in waiting:
        lock = lock_path(path, of_path.variant)
        if resolved(lock) in seen:
            continue
        seen.add(resolved(lock))
        local = Diagnostics()
        try:
            loaded = load(path, of_path, local)
            for module in loaded.document.modules.values():
                file = path.parent / (module.file or "")
                if is_file(file) and file.suffix.lower() in SIDECAR_SUFFIXES:
                    waiting.append((file, options._replace(step=None, ignore=(), variant=module.variant or "")))
            if loaded.document.step or not loaded.document.modules:
                made[lock] = _lock(own_part(loaded), of_path, local)
        except StepbotError as error:
            local.extend(error.diagnostics)
        # `check --step` and `convert` report the rest
        diagnostics.extend(one for one in local if one.severity == "error")
    return made


def _lock(sidecar: Sidecar, options: Options, diagnostics: Diagnostics) -> Snapshot:
    """The content of the lock of a sidecar's own STEP.

    Raises:
        StepbotError: The robot has errors.
    """
    step = options.step or named_step(sidecar, diagnostics)
    with closing(Loading(step, what_to_read(sidecar, options), options, diagnostics)) as loading:
        assembly, measures = loading.assembly(diagnostics), partial(loading.measures, diagnostics)
        built = build_robot(assembly, sidecar, measures, diagnostics, options.cache, loading.mesh_worker)
        diagnostics.raise_if_errors()
        assert built is not None  # a missing robot always has an error
        taken = snapshot(assembly, loading.content, measures())
    if not taken.digest:
        diagnostics.add(
            "SB001", "the file changed while it was read", sidecar.span("step"), help=["run the command again"]
        )
        diagnostics.raise_if_errors()
    return with_sidecar(taken, assembly, sidecar.document, bind(assembly, sidecar, measures()))


class FixedSidecar(Struct, frozen=True):
    """A sidecar with the new paths of components that were certainly renamed."""

    path: Path
    before: bytes
    """The current sidecar."""
    sidecar: bytes
    """The sidecar with the new paths."""
    lock: bytes
    """Its lock with the new names."""
    paths: Mapping[str, str]
    """The new path for each one that changed."""


def fix_renamed_paths(sidecar: Path, options: Options, diagnostics: Diagnostics) -> FixedSidecar | None:
    """The sidecar with certain renamings applied; None if there are none.

    Args:
        sidecar: The sidecar. Its errors, and those of its STEP, are left to `check`.
        diagnostics: Receives SB016 if there is no lock, and SB018 if the text cannot be rewritten.
    """
    elsewhere = Diagnostics()
    path = lock_path(sidecar, options.variant)
    try:
        content = read_regular(sidecar) if is_file(sidecar) else b""
        loaded = own_part(load(sidecar, options, elsewhere))
        if not exists(path):
            remedy = f"create one while sidecar and STEP agree: `{shlex.join(['stepbot', 'lock', sidecar.as_posix()])}`"
            diagnostics.add(
                "SB016", "no lock file, so renamed components cannot be found", loaded.span(), help=[remedy]
            )
            return None
        lock = read_lock(path, loaded.document.robot, elsewhere)
        step = options.step or named_step(loaded, elsewhere)
        with closing(Loading(step, what_to_read(loaded, options), options, elsewhere)) as loading:
            assembly, measures = loading.assembly(elsewhere), loading.measures(elsewhere)
            digest = loading.content
    except StepbotError:
        return None
    if lock is None or digest == lock.digest:
        return None
    compared = revised(loaded, assembly, lock, measures, digest)
    paths = certain_renamings(compared)
    if not paths:
        return None
    new = rewritten(loaded, content, paths)
    if new is None:
        names = [f"{quoted(old)}: write {quoted(name)}" for old, name in paths.items()]
        diagnostics.add(
            "SB018", "renamed paths cannot be replaced without changing other values", loaded.span(), help=names
        )
        return None
    return FixedSidecar(sidecar, content, new, lock_bytes(renamed_lock(compared)), paths)
