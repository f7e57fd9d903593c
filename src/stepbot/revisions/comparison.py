"""Compares a lock with the current assembly, under one sidecar."""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from stepbot.assemble.binder import Revised, listed
from stepbot.assemble.bound import Bound, bind
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.volume import VolumeProperties
from stepbot.sidecar.component_paths import component_paths
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.tree import Keys
from stepbot.step.assembly import Assembly, Component
from stepbot.step.structure.paths import quoted

from .bindings import BrokenPath, rebind
from .matching import Match, match
from .snapshot import Snapshot, part_components, snapshot, with_sidecar


@dataclass(frozen=True)
class Comparison:
    """Two revisions of one assembly under one sidecar."""

    sidecar: Sidecar
    assembly: Assembly
    old: Snapshot
    """The lock."""
    new: Snapshot
    """The current assembly, bound as if broken paths were fixed."""
    match: Match
    broken: tuple[BrokenPath, ...]
    """The paths of the sidecar that the revision has broken."""
    revised: Revised
    bound: Bound
    components: tuple[Component, ...]
    """The component of each part of ``new``."""
    step: str = ""
    """Path of the STEP file given instead of the sidecar's; empty otherwise."""

    def command(self, *words: str) -> str:
        """A command for this sidecar and STEP, by file name: reports contain no local folders."""
        step = ("--step", PurePath(self.step).name) if self.step else ()
        return shlex.join(["stepbot", *words, *step, self.sidecar.path.name])

    def local_command(self, *words: str) -> str:
        """The same with the paths as given, which can be run as it is; for errors, which no report contains."""
        step = ("--step", self.step) if self.step else ()
        return shlex.join(["stepbot", *words, *step, self.sidecar.path.as_posix()])

    def place_of(self, part: int) -> Keys:
        """How the sidecar binds a part of ``new``: the path, `rest`, or the links if it is unbound."""
        claims, at = self.bound.claims, self.components[part].index
        while at >= 0:
            if at in claims.claimed:
                link, position = claims.claimed[at]
                return ("links", link, "parts", position)
            at = self.assembly.components[at].parent
        link = self.new.parts[part].link
        return ("links", link, "rest") if link else ("links",)


def revised(
    sidecar: Sidecar, assembly: Assembly, lock: Snapshot, measures: Sequence[VolumeProperties | None], digest: str
) -> Comparison:
    """Compare an assembly with a lock.

    Args:
        sidecar: The sidecar, without errors of its own.
        lock: The locked content.
        measures: trimesh's mass properties of each of ``assembly.bodies``.
        digest: Hash of the STEP's bytes.
    """
    taken = snapshot(assembly, digest, measures)
    matched = match(lock, taken)
    broken, replaced = rebind(lock, taken, matched, assembly, sidecar.document)
    bound = bind(assembly, sidecar, measures, replaced)
    new = with_sidecar(taken, assembly, sidecar.document, bound)
    components = tuple(part_components(assembly))
    return Comparison(sidecar, assembly, lock, new, matched, broken, replaced, bound, components)


def report_outdated(lock: Snapshot, sidecar: Sidecar, found: Diagnostics) -> None:
    """Report joints and paths of the sidecar that the lock lacks, because the sidecar was edited later: SB016."""
    document = sidecar.document
    locked = {joint.name for joint in lock.joints}
    joints = [f"joint '{name}'" for name in document.joints if name not in locked]
    closures = [f"closure '{name}'" for name in document.closures if name not in locked]
    known = {reference.path for reference in lock.references}
    given = dict.fromkeys(place.pattern for place in component_paths(document))
    paths = [f"path {quoted(pattern)}" for pattern in given if pattern not in known]
    missing = (*joints, *closures, *paths)
    if missing:
        remedy = f"check the robot, then update the lock file: `{shlex.join(['stepbot', 'lock', sidecar.path.name])}`"
        count = f"{len(missing)} names of the sidecar are" if len(missing) > 1 else "one name of the sidecar is"
        message = f"outdated lock file: {count} not in it"
        found.add("SB016", message, sidecar.span(), help=[remedy], notes=listed(missing))
