"""Applies certain renamings: new paths for the sidecar, and the lock under the new names."""

from dataclasses import replace

from .bindings import Fate
from .comparison import Comparison
from .matching import Certainty
from .snapshot import Reference, Snapshot


def certain_renamings(compared: Comparison) -> dict[str, str]:
    """The new path for each path of the sidecar whose component was certainly renamed."""
    return {
        one.pattern: one.replacement
        for one in compared.rebinding.broken
        if one.fate is Fate.RENAMED and one.replacement
    }


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
    broken = {one.pattern: one for one in compared.rebinding.broken}
    references = [
        Reference(renamed[one.path], broken[one.path].new)
        if one.path in renamed
        else replace(one, components=tuple(names.get(path, path) for path in one.components))
        for one in lock.references
    ]
    by_path = {one.path: one for one in references}
    return replace(lock, parts=tuple(parts), references=tuple(by_path[path] for path in sorted(by_path)))
