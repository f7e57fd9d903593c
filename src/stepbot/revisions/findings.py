"""Reports differences between a lock and the assembly, each at the related line of the sidecar.

Parts bound by one path with the same change are one diagnostic.
"""

from collections.abc import Iterable, Iterator, Sequence

from stepbot.assemble.binder import listed
from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.tree import Keys, subject
from stepbot.step.structure.paths import ComponentPaths, quoted, segments_of, without_ordinal

from .broken_paths import report_broken, several
from .comparison import Comparison, is_below, renamed_node
from .matching import Certainty, Pair, pair_words
from .shapes import axis_words, common_words, mass_words, moved_words, shape_words, stuff_words

_SHOWN = 5
_SAME_MASS = 1e-6
"""Relative difference up to which masses are equal."""


def report_changes(compared: Comparison, diagnostics: Diagnostics) -> None:
    """Report everything that changed: SB304, SB310 to SB318."""
    report_broken(compared, diagnostics)
    _Reporter(compared, diagnostics).report()


class _Reporter:
    """Reports changes other than broken paths."""

    def __init__(self, compared: Comparison, diagnostics: Diagnostics) -> None:
        self._c, self._diagnostics = compared, diagnostics
        self._sidecar = compared.sidecar
        self._accept = f"if the change is intended: `{compared.command('lock')}`"
        self._paths = ComponentPaths(compared.assembly.components)
        broken = compared.broken
        self._reported = {pair.old for one in broken for pair in one.pairs}
        self._lost = [path for one in broken if not one.pairs for path in one.old]
        self._offered = {path for one in broken for path in one.candidates}
        self._nodes = {one.node for one in broken}
        self._replaced = {
            pair.old: pair
            for pair in compared.match.pairs
            if pair.certainty is Certainty.PROBABLE and pair.old not in self._reported
        }
        """Old parts that may correspond to a new one, if nothing in the sidecar depends on it."""

    def report(self) -> None:
        if self._c.match.is_moved:
            message = f"step: the whole assembly {common_words(self._c.match.common)}"
            self._diagnostics.add("SB318:pose", message, self._sidecar.span("step"), help=[self._accept])
        self._report_renamed()
        self._report_removed()
        self._report_added()
        moved = ((pair, moved_words(pair.motion)) for pair in self._by_path() if not pair.motion.is_none)
        self._report_alike("SB318:pose", moved)
        self._report_shapes()
        self._report_masses()
        self._report_joints()

    def _report_renamed(self) -> None:
        """Components that were certainly renamed, and that the sidecar still binds."""
        kept: dict[str, list[str]] = {}
        for pair in self._c.match.pairs:
            old, new = self._c.old.parts[pair.old], self._c.new.parts[pair.new]
            if pair.certainty is not Certainty.CERTAIN or pair.old in self._reported or not (old.link or new.link):
                continue
            words = f"'{old.path}' to '{new.path}'"
            if old.link == new.link:
                if not self._is_still_named(pair) and renamed_node(old.path, new.path) not in self._nodes:
                    kept.setdefault(new.link, []).append(words)
                continue
            now = f"is now in link '{new.link}'" if new.link else "is no longer in a link"
            before = f"in link '{old.link}'" if old.link else "not assigned"
            message = f"component renamed from {words} {now} (before: {before})"
            help = ["correct the `parts` of the links", self._accept]
            self._add("SB316:renamed", self._c.place_of(pair.new), message, help)
        for link, renamed in kept.items():
            if len(renamed) == 1:
                message, notes = f"component renamed from {renamed[0]}; it stays in the link", []
            else:
                message, notes = f"{len(renamed)} components renamed; they stay in the link", renamed
            self._add("SB314", ("links", link), message, [self._accept], notes)

    def _is_still_named(self, pair: Pair) -> bool:
        """Whether the old path still matches it, and the new name is only due to a sibling or `#n`."""
        old, new = self._c.old.parts[pair.old].path, self._c.new.parts[pair.new].path
        is_renumbered = [*map(without_ordinal, segments_of(old))] == [*map(without_ordinal, segments_of(new))]
        return is_renumbered or self._c.components[pair.new].index in self._paths.find(old).indices

    def _report_removed(self) -> None:
        """Removed components that no path matched alone."""
        by_link: dict[str, list[int]] = {}
        for index in (*self._c.match.removed, *self._replaced):
            part = self._c.old.parts[index]
            if part.link in self._sidecar.document.links and not is_below(part.path, self._lost):
                by_link.setdefault(part.link, []).append(index)
        for link, indices in by_link.items():
            paths = tuple(self._c.old.parts[index].path for index in sorted(indices))
            noun, verb = several(paths)
            message = f"{noun} {verb} no longer in {self._c.assembly.source}"
            notes = [*_named(paths), *self._successors(indices)]
            self._add("SB316:lost", ("links", link), message, [self._accept], notes)

    def _successors(self, indices: Sequence[int]) -> Iterator[str]:
        """New components that may replace removed ones."""
        for index in indices:
            name = quoted(self._c.old.parts[index].path)
            if index in self._replaced:
                pair = self._replaced[index]
                new = quoted(self._c.new.parts[pair.new].path)
                yield f"{name} may be {new} now: {pair_words(self._c.old, self._c.new, pair)}"
            elif index in self._c.match.candidates:
                names = [quoted(self._c.new.parts[j].path) for j in self._c.match.candidates[index]]
                yield f"{name} may be one of these now, of the same shape: {', '.join(names[:_SHOWN])}"

    def _report_added(self) -> None:
        unclaimed = set(self._c.bound.claims.unclaimed)
        loose: list[str] = []
        by_place: dict[tuple[str, Keys], list[str]] = {}
        for index in sorted((*self._c.match.added, *(pair.new for pair in self._replaced.values()))):
            part = self._c.new.parts[index]
            if self._c.components[index].index in unclaimed:
                if part.path not in self._offered:
                    loose.append(part.path)
            elif part.link:
                by_place.setdefault((part.link, self._c.place_of(index)), []).append(part.path)
        for (link, keys), paths in by_place.items():
            noun, verb = several(paths, "new component")
            message = f"{noun} {verb} in the link"
            help = [f"if it belongs to another link: add it to the `parts` of that link, not '{link}'", self._accept]
            self._add("SB316:gained", keys, message, help, _named(paths))
        if loose:
            noun, verb = several(loose, "new component")
            them = "it" if len(loose) == 1 else "them"
            self._diagnostics.add(
                "SB304",
                f"{self._c.assembly.source}: {noun} {verb} not assigned to any link",
                self._sidecar.key_span("links"),
                help=(
                    f"add {them} to the `parts` of a link: {quoted(loose[0])}",
                    f"or ignore {them}: `parts: {{{quoted(loose[0])}: {{ignore: true}}}}`",
                ),
                notes=_named(loose),
            )

    def _report_shapes(self) -> None:
        words = []
        for pair in self._by_path():
            if not pair.is_same_shape:
                old, new = self._c.old.parts[pair.old], self._c.new.parts[pair.new]
                text = shape_words(self._c.old.shape_of(pair.old), self._c.new.shape_of(pair.new))
                if old.mass is not None and new.mass is not None and not _is_same(old.mass, new.mass):
                    text = f"{text}, {mass_words(old.mass, new.mass)}"
                words.append((pair, f"changed shape: {text}"))
        self._report_alike("SB318:shape", words)

    def _report_masses(self) -> None:
        """Masses changed by the STEP's density or material; those of a changed shape are reported with the shape."""
        words = []
        for pair in self._c.match.pairs:
            old, new = self._c.old.parts[pair.old], self._c.new.parts[pair.new]
            why = stuff_words(old, new)
            if not (pair.is_same_shape and why) or old.mass is None or new.mass is None:
                continue
            if not _is_same(old.mass, new.mass):
                words.append((pair, f"changed {mass_words(old.mass, new.mass)}: {why} in the STEP"))
        self._report_alike("SB318:mass", words)

    def _report_alike(self, code: str, changed: Iterable[tuple[Pair, str]]) -> None:
        """One diagnostic for all parts bound by one path with the same change."""
        groups: dict[tuple[Keys, str], list[str]] = {}
        for pair, words in changed:
            part = self._c.new.parts[pair.new]
            if part.link:
                groups.setdefault((self._c.place_of(pair.new), words), []).append(part.path)
        for (keys, words), paths in groups.items():
            noun, _ = several(paths)
            self._add(code, keys, f"{noun} {words}", [self._accept], _named(paths))

    def _report_joints(self) -> None:
        before = {joint.name: joint for joint in self._c.old.joints}
        for joint in self._c.new.joints:
            old = before.get(joint.name)
            if old is None:
                continue
            words = axis_words(old, joint, self._c.match.common)
            if words:
                section = "joints" if joint.name in self._sidecar.document.joints else "closures"
                self._add("SB318:axis", (section, joint.name, "origin"), words, [self._accept])

    def _by_path(self) -> list[Pair]:
        return [pair for pair in self._c.match.pairs if pair.certainty is Certainty.PATH]

    def _add(self, code: str, keys: Keys, message: str, help: Sequence[str], notes: Sequence[str] = ()) -> None:
        is_value = len(keys) > 2
        span = self._sidecar.span(*keys) if is_value else self._sidecar.key_span(*keys)
        self._diagnostics.add(code, f"{subject(keys[:2])}: {message}", span, help=help, notes=notes)


def _named(paths: Sequence[str]) -> tuple[str, ...]:
    """Paths for the notes of a message that only has their number."""
    return listed(tuple(map(quoted, paths))) if len(paths) > 1 else ()


def _is_same(a: float, b: float) -> bool:
    return abs(a - b) <= _SAME_MASS * max(a, b)
