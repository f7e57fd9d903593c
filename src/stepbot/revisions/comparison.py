"""Compares a lock with the current assembly, under one sidecar: changed components, and paths that match others now."""

import shlex
from collections.abc import Iterable, Sequence
from enum import StrEnum
from pathlib import PurePath

from msgspec import Struct

from stepbot.assemble.binder import RevisedComponents, listed
from stepbot.assemble.bound import Bound, bind
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.volume import VolumeProperties
from stepbot.sidecar.component_paths import PathPlace, component_paths
from stepbot.sidecar.document import Document
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.tree import Keys
from stepbot.step.assembly import ROOT_PATH, Assembly, Component
from stepbot.step.structure.paths import ComponentPaths, is_glob, quoted, segments_of, without_ordinal

from .matching import Certainty, Match, Pair, match
from .snapshot import Snapshot, part_components, snapshot, with_sidecar


class Fate(StrEnum):
    """The change of the components that a path matched."""

    RENAMED = "renamed"
    PROBABLY_RENAMED = "probably renamed"
    REMOVED = "removed"


def renamed_node(old: str, new: str) -> tuple[str, str]:
    """The renamed component that explains the renaming of one below it: both paths without their common segments."""
    ours, theirs = segments_of(old), segments_of(new)
    while len(ours) > 1 and len(theirs) > 1 and ours[-1] == theirs[-1]:
        ours, theirs = ours[:-1], theirs[:-1]
    return "/".join(ours), "/".join(theirs)


class BrokenPath(Struct, frozen=True):
    """A path that no longer matches the same components."""

    pattern: str
    places: tuple[PathPlace, ...]
    fate: Fate
    old: tuple[str, ...]
    """Canonical paths of the old matches; of nested components the topmost."""
    new: tuple[str, ...] = ()
    """Canonical paths of the same components now."""
    replacement: str = ""
    """A path that matches exactly these; empty if there is none, and for a glob that matched several."""
    pairs: tuple[Pair, ...] = ()
    """The parts below them."""
    candidates: tuple[str, ...] = ()
    """For removed components, candidate parts."""
    names_others: bool = False
    """Whether the path now matches other components."""

    @property
    def node(self) -> tuple[str, str] | None:
        """Old and new path of the single renamed component that broke the path; None if there is no single one."""
        nodes = {renamed_node(old, new) for old, new in zip(self.old, self.new, strict=False)}
        return nodes.pop() if len(self.old) == len(self.new) and len(nodes) == 1 else None


def rebind(
    old: Snapshot, new: Snapshot, matched: Match, assembly: Assembly, document: Document
) -> tuple[tuple[BrokenPath, ...], RevisedComponents]:
    """All paths of a sidecar that a revision has broken, and their replacements."""
    binding = _Binding(old, new, matched, assembly)
    places: dict[str, list[PathPlace]] = {}
    for place in component_paths(document):
        places.setdefault(place.pattern, []).append(place)
    locked = {reference.path: reference.components for reference in old.references}
    broken = [
        change
        for pattern, several in places.items()
        if pattern in locked and (change := binding.broken(pattern, tuple(several), locked[pattern])) is not None
    ]
    components = part_components(assembly)
    added = frozenset(components[index].index for index in matched.added)
    return tuple(broken), RevisedComponents({one.pattern: binding.indices(one.new) for one in broken}, added)


class _Binding:
    """Looks up old matches of paths in a revised assembly."""

    def __init__(self, old: Snapshot, new: Snapshot, matched: Match, assembly: Assembly) -> None:
        self._old, self._new, self._match, self._assembly = old, new, matched, assembly
        self._paths = ComponentPaths(assembly.components)
        self._index = {component.path: component.index for component in assembly.components}
        self._old_parts = frozenset(old.index_of)
        self._pair_of = {pair.old: pair for pair in matched.pairs}

    def indices(self, paths: Iterable[str]) -> tuple[int, ...]:
        """Components by their canonical paths."""
        return tuple(self._index[path] for path in paths)

    def broken(self, pattern: str, places: tuple[PathPlace, ...], components: tuple[str, ...]) -> BrokenPath | None:
        """The change of a path that matched some components; None if it still matches them."""
        parts = [index for index, part in enumerate(self._old.parts) if is_below(part.path, components)]
        pairs = tuple(self._pair_of[index] for index in parts if index in self._pair_of)
        is_one = any(place.is_one for place in places)
        now = self._paths.find_one(pattern) if is_one else self._paths.find(pattern)
        if not parts:
            return None  # it matched components without a body, which are only distinguished by name
        if not now.problem:
            if is_glob(pattern) or not all(path in self._old_parts for path in components):
                return None  # additional and missing matches are reported by link
            below = {self._assembly.components[index].path for index in self._paths.below(now.topmost)}
            if pairs and all(self._new.parts[pair.new].path in below for pair in pairs):
                return None
        if not pairs:
            several = dict.fromkeys(j for i in parts for j in self._match.candidates.get(i, ()))
            candidates = tuple(self._new.parts[j].path for j in several)
            fate = Fate.PROBABLY_RENAMED if candidates else Fate.REMOVED
            return BrokenPath(pattern, places, fate, components, candidates=candidates, names_others=not now.problem)
        nodes = tuple(dict.fromkeys(node for path in components for node in self._now(path)))
        sure = all(pair.certainty is not Certainty.PROBABLE for pair in pairs)
        fate = Fate.RENAMED if sure else Fate.PROBABLY_RENAMED
        replacement = self._replacement(pattern, components, nodes, is_one=is_one)
        return BrokenPath(pattern, places, fate, components, nodes, replacement, pairs, names_others=not now.problem)

    def _now(self, path: str) -> tuple[str, ...]:
        """Canonical paths, topmost, of one old component now."""
        pairs = [
            self._pair_of[i]
            for i, part in enumerate(self._old.parts)
            if is_below(part.path, (path,)) and i in self._pair_of
        ]
        names = [(self._old.parts[pair.old].path.removeprefix(path), self._new.parts[pair.new].path) for pair in pairs]
        nodes = {new.removesuffix(rest) for rest, new in names if new.endswith(rest)}
        if len(nodes) == 1 and (node := nodes.pop()) in self._index and all(is_below(new, (node,)) for _, new in names):
            return (node,)
        return tuple(new for _, new in names)

    def _replacement(self, pattern: str, old: Sequence[str], new: Sequence[str], *, is_one: bool) -> str:
        """A path that matches exactly the components at ``new``, as similar to ``pattern`` as possible."""
        if is_glob(pattern) and (len(old) != 1 or len(new) != 1):
            return ""
        wanted = set(self.indices(new))
        for candidate in dict.fromkeys(_spellings(pattern, old, new)):
            replacement = self._paths.find_one(candidate) if is_one else self._paths.find(candidate)
            if not replacement.problem and set(replacement.topmost) == wanted:
                return candidate
        return ""


def is_below(path: str, above: Sequence[str]) -> bool:
    """Whether a canonical path is one of several others, or below one of them."""
    return any(path == one or one == ROOT_PATH or path.startswith(f"{one}/") for one in above)


def _spellings(pattern: str, old: Sequence[str], new: Sequence[str]) -> Iterable[str]:
    """Candidate paths of the components at ``new``, those most similar to ``pattern`` first."""
    written = segments_of(pattern)
    for path in new:
        segments = segments_of(path)
        if not is_glob(pattern):
            for before in map(segments_of, old):
                if len(before) == len(segments) >= len(written):
                    kept = zip(written, before[-len(written) :], segments[-len(written) :], strict=True)
                    yield "/".join(text if a == b else b for text, a, b in kept)
            tail = segments[-len(written) :]
            yield "/".join((*tail[:-1], without_ordinal(tail[-1])))
            yield "/".join(tail)
        yield path


class Comparison(Struct, frozen=True):
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
    revised: RevisedComponents
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


def report_outdated(lock: Snapshot, sidecar: Sidecar, diagnostics: Diagnostics) -> None:
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
        diagnostics.add("SB016", message, sidecar.span(), help=[remedy], notes=listed(missing))
