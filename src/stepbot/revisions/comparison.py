"""Compares a lock with the current assembly, under one sidecar."""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from stepbot.assemble.bound import Bound, bind
from stepbot.geometry.volume import VolumeProperties
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.tree import Keys
from stepbot.step.assembly import Assembly, Component

from .bindings import Rebinding, rebind
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
    rebinding: Rebinding
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
        assembly: The current content of the STEP.
        lock: The locked content.
        measures: trimesh's mass properties of each of ``assembly.bodies``.
        digest: Hash of the STEP's bytes.
    """
    taken = snapshot(assembly, digest, measures)
    matched = match(lock, taken)
    rebinding = rebind(lock, taken, matched, assembly, sidecar.document)
    bound = bind(assembly, sidecar, measures, rebinding.revised)
    new = with_sidecar(taken, assembly, sidecar.document, bound)
    return Comparison(sidecar, assembly, lock, new, matched, rebinding, bound, tuple(part_components(assembly)))
