"""Paths that a revision has broken, as diagnostics."""

from collections.abc import Hashable, Iterable, Sequence

from msgspec.structs import replace

from stepbot.assemble.binder import LISTED, listed
from stepbot.diagnostics import Diagnostics, Span
from stepbot.sidecar.component_paths import PathPlace
from stepbot.sidecar.tree import subject
from stepbot.step.structure.paths import quoted

from .comparison import BrokenPath, Comparison, Fate
from .matching import Certainty, pair_words
from .snapshot import Reference, Snapshot

_OFFERED = 5
_NAMED = 3
"""Maximum number of components that a message names."""

Group = Sequence[BrokenPath]


def report_broken(compared: Comparison, diagnostics: Diagnostics) -> None:
    """Report each path that no longer matches the same components, at its first place: SB310 to SB312.

    Paths broken by the renaming of a subassembly are one diagnostic.
    """
    for group in _grouped(compared.broken):
        broken = group[0]
        report = {
            Fate.RENAMED: _renamed,
            Fate.PROBABLY_RENAMED: _probably_renamed if broken.new else _undecided,
            Fate.REMOVED: _removed,
        }[broken.fate]
        code, words, help = report(compared, group)
        first, *others = [place for one in group for place in one.places]
        lines = sorted({_span(compared, place).line for place in others})
        notes = [f"also in line{'s' if len(lines) > 1 else ''} {', '.join(map(str, lines))}"] if lines else []
        notes += [f"{quoted(one.pattern)} names another component now" for one in group if one.names_others]
        message = f"{subject(first.keys[:2])}: {words}"
        diagnostics.add(code, message, _span(compared, first), help=help, notes=[*notes, *listed(broken.candidates)])


def _grouped(broken: Iterable[BrokenPath]) -> list[list[BrokenPath]]:
    """Broken paths by the renamed component that broke them."""
    groups: dict[Hashable, list[BrokenPath]] = {}
    for one in broken:
        groups.setdefault((one.fate, one.node or one.pattern), []).append(one)
    return list(groups.values())


def several(paths: Sequence[str], noun: str = "component") -> tuple[str, str]:
    """Components for a message, and the verb: ``component 'Bracket'`` and ``is``, ``3 components`` and ``are``."""
    return (f"{noun} '{paths[0]}'", "is") if len(paths) == 1 else (f"{len(paths)} {noun}s", "are")


def _renamed(compared: Comparison, group: Group) -> tuple[str, str, list[str]]:
    help = _spelled(group)
    if all(one.replacement for one in group):
        paths = "the path" if len(group) == 1 else "the paths"
        help.insert(0, f"`{compared.local_command('check', '--fix')}` replaces {paths}")
    return "SB310", f"{_was(compared, group)} renamed to {_new(group)} ({_evidence(compared, group)})", help


def _probably_renamed(compared: Comparison, group: Group) -> tuple[str, str, list[str]]:
    words = f"{_was(compared, group)} probably renamed to {_new(group)} ({_evidence(compared, group)})"
    return "SB311", words, [f"if so: {one}" for one in _spelled(group)]


def _undecided(compared: Comparison, group: Group) -> tuple[str, str, list[str]]:
    candidates = group[0].candidates
    count = f"{len(candidates)} new components have" if len(candidates) > 1 else "one new component has"
    words = f"{_was(compared, group)} removed or renamed: {count} the same shape"
    return "SB311", words, [f"if it is this one: write {quoted(path)}" for path in candidates[:_OFFERED]]


def _removed(compared: Comparison, group: Group) -> tuple[str, str, list[str]]:
    noun, verb = several([path for one in group for path in one.old])
    help = ["remove the path, or replace it by that of another component"]
    return "SB312", f"{noun} {verb} no longer in {compared.assembly.source}", help


def _was(compared: Comparison, group: Group) -> str:
    """``component 'Bracket' was``, ``subassembly 'gripper' was``, ``4 components were``."""
    node = group[0].node
    if node:
        is_part = node[0] in compared.old.index_of
        return f"{'component' if is_part else 'subassembly'} '{node[0]}' was"
    noun, verb = several(group[0].old)
    return f"{noun} {'was' if verb == 'is' else 'were'}"


def _new(group: Group) -> str:
    broken = group[0]
    if broken.node:
        return f"'{broken.node[1]}'"
    if broken.replacement:
        return f"'{broken.replacement}'"
    if len(broken.new) > _NAMED:
        return f"{len(broken.new)} components"
    return " and ".join(f"'{path}'" for path in broken.new)


def _spelled(group: Group) -> list[str]:
    broken = group[0]
    if len(group) > 1:
        shown = [f"{quoted(one.pattern)}: write {quoted(one.replacement)}" for one in group if one.replacement]
        more = len(shown) - _OFFERED
        return [*shown[:_OFFERED], *([f"and {more} more in the same way"] if more > 0 else [])]
    if broken.replacement or len(broken.new) == 1:
        return [f"write {quoted(broken.replacement or broken.new[0])}"]
    if len(broken.new) > LISTED:
        return [f"write a glob that matches these {len(broken.new)} components; `stepbot inspect` lists them"]
    paths = ", ".join(map(quoted, broken.new))
    return [f"write a rule for each of {paths}" if any(place.is_key for place in broken.places) else f"write {paths}"]


def _evidence(compared: Comparison, group: Group) -> str:
    """Evidence that two names belong to the same component."""
    pairs = list({pair.old: pair for one in group for pair in one.pairs}.values())
    if all(pair.certainty is not Certainty.PROBABLE for pair in pairs):
        return (
            "same shape, same pose" if len(pairs) == 1 else f"{len(pairs)} parts of the same shapes in the same poses"
        )
    weak = next(pair for pair in pairs if pair.certainty is Certainty.PROBABLE)
    more = f"; {len(pairs) - 1} more parts" if len(pairs) > 1 else ""
    return f"{pair_words(compared.old, compared.new, weak)}{more}"


def _span(compared: Comparison, place: PathPlace) -> Span:
    sidecar = compared.sidecar
    return sidecar.key_span(*place.keys) if place.is_key else sidecar.span(*place.keys)


def certain_renamings(compared: Comparison) -> dict[str, str]:
    """The new path for each path of the sidecar whose component was certainly renamed."""
    return {one.pattern: one.replacement for one in compared.broken if one.fate is Fate.RENAMED and one.replacement}


def renamed_lock(compared: Comparison) -> Snapshot:
    """The lock with certain new names; shapes, poses, masses and axes are unchanged."""
    lock, new = compared.old, compared.new
    parts = list(lock.parts)
    names = dict[str, str]()
    for pair in compared.match.pairs:
        if pair.certainty is Certainty.CERTAIN:
            old, now = lock.parts[pair.old], new.parts[pair.new]
            parts[pair.old] = replace(old, path=now.path, by_ordinal=now.by_ordinal)
            names[old.path] = now.path
    renamed = certain_renamings(compared)
    broken = {one.pattern: one for one in compared.broken}
    references = [
        Reference(renamed[reference.path], broken[reference.path].new)
        if reference.path in renamed
        else replace(reference, components=tuple(names.get(path, path) for path in reference.components))
        for reference in lock.references
    ]
    by_path = {reference.path: reference for reference in references}
    return replace(lock, parts=tuple(parts), references=tuple(by_path[path] for path in sorted(by_path)))
