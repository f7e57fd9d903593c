"""Reads the files of an assembly one after the other, and combines them.

A product without a shape that refers to another file is replaced by the product in that file. Component paths do not
depend on the file of a shape: the name of a product is that in the assembly's file.
"""

from collections.abc import Mapping

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span

from .exchange.file_set import StepFile
from .exchange.length_unit import LengthUnit
from .one_file import FileContent, guarded, optional, read_file
from .structure.source import NONE, Child, Definition, StepMaterial
from .structure.tree import Tree, grow
from .validation.properties import StatedValue, Subjects, read_statements


class Composition:
    """The definitions and materials of all files; references between the files have no cycle."""

    def __init__(self, files: Mapping[int, FileContent]) -> None:
        """Put them together, by their numbers; that of the assembly is 0."""
        self._files = files
        self._offsets: dict[int, int] = {}
        self.definitions: list[Definition] = []
        self.materials: list[StepMaterial] = []
        for number, file in files.items():
            offset = self._offsets[number] = len(self.definitions)
            self.definitions += [_moved(definition, offset) for definition in file.definitions.all]
            self.materials += file.materials
        self._instead: dict[int, int] = {}
        self._named: set[int] = set()
        for number in files:
            self._replace(number)
        for number, file in files.items():
            for own in file.elsewhere:
                self._name(self._offsets[number] + own)
        for definition in self.definitions if self._instead else ():
            definition.children = [replace(c, definition=self._stand_in(c.definition)) for c in definition.children]

    @property
    def roots(self) -> list[int]:
        """The roots of the assembly."""
        return [self._stand_in(root) for root in self._files[0].definitions.roots]

    def _stand_in(self, index: int) -> int:
        """The definition that is used in place of another."""
        while index in self._instead:
            index = self._instead[index]
        return index

    def places(self) -> list[dict[int, int]]:
        """For each file and each product in it the index of its definition here."""
        return [
            {
                definition.product: self._stand_in(offset + index)
                for index, definition in enumerate(file.definitions.all)
                if definition.product != NONE
            }
            for offset, file in zip(self._offsets.values(), self._files.values(), strict=True)
        ]

    def _replace(self, number: int) -> None:
        """Find the replacement of each definition whose shape is in another file."""
        offset = self._offsets[number]
        for own, other in self._files[number].elsewhere.items():
            index = offset + own
            roots = [self._offsets[other] + root for root in self._files[other].definitions.roots]
            empty = self.definitions[index]
            same = [root for root in roots if self.definitions[root].name == empty.name]
            if len(roots) > 1 and len(same) != 1:
                empty.children = [Child(root, "", np.eye(4)) for root in roots]
                continue
            (self._instead[index],) = same if len(roots) > 1 else roots

    def _name(self, index: int) -> None:
        """Give the replacement of a definition its name in the referring file."""
        if index not in self._instead:
            return
        target, referring = self._stand_in(index), self.definitions[index]
        definition = self.definitions[target]
        name = referring.name or definition.name
        if target in self._named and definition.name != name:
            self.definitions.append(replace(definition, name=name))
            self.materials.append(self.materials[target])
            self._instead[index] = len(self.definitions) - 1
            return
        self._instead[index] = target
        self._named.add(target)
        definition.name = name
        if definition.color is None:
            definition.color = referring.color
        if self.materials[target] == StepMaterial():
            self.materials[target] = self.materials[index]


def _moved(definition: Definition, offset: int) -> Definition:
    children = definition.children
    if offset:
        children = [replace(child, definition=child.definition + offset) for child in children]
    return replace(definition, children=[*children])


class Content(Struct, frozen=True, eq=False):
    """An assembly before its bodies are made."""

    unit: LengthUnit
    definitions: list[Definition]
    tree: Tree
    stated: list[StatedValue]
    """Values stated in the files for comparison."""
    mechanisms: int
    """Number of kinematic mechanisms in the file of the assembly."""
    external: tuple[str, ...]
    """Names of the other files that were read."""


def read_content(files: tuple[StepFile, ...], diagnostics: Diagnostics) -> Content | None:
    """Everything but the bodies; None, with the reason in ``diagnostics``, after an error.

    Args:
        files: The file of the assembly first; others are read if a product needs them.
    """
    contents = _read_all(files, diagnostics)
    if contents is None or _has_cycle(contents, files, diagnostics):
        return None
    return guarded(files[0].place, diagnostics, lambda: _put_together(contents, files, diagnostics))


def _put_together(
    contents: Mapping[int, FileContent], files: tuple[StepFile, ...], diagnostics: Diagnostics
) -> Content | None:
    composition = Composition(contents)
    place, definitions = files[0].place, composition.definitions
    tree = grow(definitions, composition.roots, composition.materials, place, diagnostics)
    if tree is None:
        return None
    is_complete = not any(definition.missing for definition in definitions)
    if not tree.variants and is_complete:
        diagnostics.add("SB205", "the kernel could build no geometry", Span(place), help=["export it as a B-rep"])
        return None

    def read_stated() -> list[StatedValue]:
        read = zip(contents.values(), composition.places(), strict=True)
        return [value for content, places in read for value in _stated(content, places, definitions, tree)]

    # Of an incomplete assembly, what the file states is of other parts, too.
    stated: list[StatedValue] = []
    if is_complete:
        stated = optional("validation properties", place, diagnostics, read_stated, stated)
    external = tuple(files[file].name for file in contents if file)
    return Content(_unit(contents), definitions, tree, stated, contents[0].mechanisms, external)


def _read_all(files: tuple[StepFile, ...], diagnostics: Diagnostics) -> dict[int, FileContent] | None:
    """Indices of the needed files, ascending."""
    contents: dict[int, FileContent] = {}
    pending = [0]
    while pending:
        file = pending.pop(0)
        if file in contents:
            continue
        content = read_file(files[file], diagnostics)
        if content is None:
            return None
        contents[file] = content
        pending += content.elsewhere.values()
    return dict(sorted(contents.items()))


def _has_cycle(contents: Mapping[int, FileContent], files: tuple[StepFile, ...], diagnostics: Diagnostics) -> bool:
    """Whether a file needs itself, directly or indirectly; such a cycle is reported in ``diagnostics``."""
    done: set[int] = set()
    path: list[int] = []
    pending: list[tuple[int, bool]] = [(0, False)]
    while pending:
        file, is_left = pending.pop()
        if is_left:
            done.add(path.pop())
        elif file in path:
            names = [files[one].name for one in [*path[path.index(file) :], file]]
            diagnostics.add(
                "SB203",
                f"circular external reference: {' -> '.join(names)}",
                Span(files[path[-1]].place),
                help=["export the assembly as one STEP file, with external references switched off"],
            )
            return True
        elif file not in done:
            path.append(file)
            pending.append((file, True))
            pending += [(other, False) for other in dict.fromkeys(contents[file].elsewhere.values())]
    return False


def _stated(
    content: FileContent, places: Mapping[int, int], definitions: list[Definition], tree: Tree
) -> list[StatedValue]:
    statements = read_statements(content.session)
    if not statements:
        return []
    subjects = Subjects(content.session, content.products, places, definitions, tree)
    return [StatedValue(subjects.of(entity), quantity, value) for entity, quantity, value in statements]


def _unit(contents: Mapping[int, FileContent]) -> LengthUnit:
    """The unit of the assembly's own file, and the further ones of all files."""
    unit = contents[0].unit
    names = [name for content in contents.values() for name in (content.unit.name, *content.unit.others)]
    return replace(unit, others=tuple(dict.fromkeys(name for name in names if name != unit.name)))
