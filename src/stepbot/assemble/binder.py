"""Resolves the sidecar's component paths in the assembly and reports unresolved ones at their place in the sidecar."""

from collections.abc import Iterable, Mapping

from msgspec import Struct, field

from stepbot.diagnostics import Diagnostics, Span, did_you_mean
from stepbot.sidecar.document import Document
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.tree import Keys, subject
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import ComponentPaths, quoted

LISTED = 20
"""Maximum number of names in one message."""


class RevisedComponents(Struct, frozen=True):
    """Components that a revision of the CAD has changed, which is reported elsewhere."""

    bound: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    """Components by a path that no longer names them in the assembly; none for one whose components are gone."""
    new: frozenset[int] = frozenset()
    """Components that the revision has added."""


UNREVISED = RevisedComponents()


class Binder:
    """One sidecar bound to one assembly."""

    def __init__(
        self, assembly: Assembly, sidecar: Sidecar, diagnostics: Diagnostics, revised: RevisedComponents = UNREVISED
    ) -> None:
        self.assembly = assembly
        self.revised = revised
        self.sidecar = sidecar
        self.diagnostics = diagnostics
        self.paths = ComponentPaths(assembly.components)
        self._fragile: dict[str, Span] = {}

    @property
    def document(self) -> Document:
        """The sidecar's content."""
        return self.sidecar.document

    def all(self, pattern: str, keys: Keys) -> tuple[int, ...]:
        """Components that match a path or glob, in file order; empty after a diagnostic."""
        return self._look_up(pattern, keys, one=False)

    def one(self, pattern: str, keys: Keys, other_names: Iterable[str] = ()) -> int | None:
        """The only component that matches a path or glob; None after a diagnostic.

        Args:
            other_names: Names of other elements that are valid there, in remedies.
        """
        indices = self._look_up(pattern, keys, one=True, other_names=other_names)
        return indices[0] if indices else None

    def report(
        self, code: str, keys: Keys, message: str, help: tuple[str, ...] = (), notes: tuple[str, ...] = ()
    ) -> None:
        """Report a finding at the value under ``keys`` in the sidecar."""
        self.diagnostics.add(code, f"{subject(keys[:2])}: {message}", self.span(keys), help=help, notes=notes)

    def span(self, keys: Keys) -> Span:
        """The span of a value; for a section, the span of its key; the whole file if the section is missing."""
        if keys and keys[0] not in self.document.model_fields_set:
            return Span(str(self.sidecar.path))
        return self.sidecar.key_span(*keys) if len(keys) <= 2 else self.sidecar.span(*keys)

    def report_fragile(self) -> None:
        """Warn once for all paths that depend on an occurrence number ``#n``, except in sections that ignore it."""
        ignored = {
            pattern: span for pattern, span in self._fragile.items() if self.diagnostics.ignores_at("SB305", span)
        }
        for pattern, span in ignored.items():
            self._warn_fragile({pattern: span}, notes=False)
        left = {pattern: span for pattern, span in self._fragile.items() if pattern not in ignored}
        if left:
            self._warn_fragile(left, notes=True)

    def _warn_fragile(self, paths: Mapping[str, Span], *, notes: bool) -> None:
        named = tuple(f"line {span.line}: {quoted(pattern)}" for pattern, span in paths.items())
        count = f"{len(named)} paths depend" if len(named) > 1 else "one path depends"
        self.diagnostics.add(
            "SB305",
            f"{self.assembly.source}: {count} on the order of siblings (#n), which have no names of their own",
            next(iter(paths.values())),
            help=("name these occurrences in CAD",),
            notes=listed(named) if notes else (),
        )

    def path(self, index: int) -> str:
        """Canonical path of a component."""
        return self.assembly.components[index].path

    def _look_up(self, pattern: str, keys: Keys, *, one: bool, other_names: Iterable[str] = ()) -> tuple[int, ...]:
        if pattern in self.revised.bound:
            return self.revised.bound[pattern]
        binding = self.paths.find_one(pattern) if one else self.paths.find(pattern)
        if binding.problem == "unknown":
            message = f"no component {_named(pattern)} in {self.assembly.source}"
            near = did_you_mean(pattern, other_names)
            self.report(
                "SB301",
                keys,
                message,
                help=tuple(dict.fromkeys((*self.sidecar.quoting_hints(*keys), *near, *binding.help))),
            )
        elif binding.problem == "ambiguous":
            several = f"{len(binding.candidates)} components"
            notes = listed(tuple(map(quoted, binding.candidates)))
            self.report("SB302", keys, f"{_named(pattern)} matches {several}", help=binding.help, notes=notes)
        elif binding.fragile:
            self._fragile.setdefault(pattern, self.span(keys))
        return binding.topmost if one else binding.indices


def listed(names: tuple[str, ...]) -> tuple[str, ...]:
    """Names for the notes of a message: the first twenty, and the number of the others."""
    return names if len(names) <= LISTED else (*names[:LISTED], f"and {len(names) - LISTED} more")


def _named(pattern: str) -> str:
    return f"'{pattern}'"
