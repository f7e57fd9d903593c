"""Combines the files of an assembly as if it were in one file.

A product without a shape that refers to another file is replaced by the product in that file. Component paths do not
depend on the file of a shape: the name of a product is that in the assembly's file.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from .source import NONE, Child, Definition, StepMaterial


@dataclass(frozen=True, eq=False)
class FileDefinitions:
    """What one file defines."""

    definitions: Sequence[Definition]
    roots: Sequence[int]
    materials: Sequence[StepMaterial]
    """For each definition what its product is made of."""
    elsewhere: Mapping[int, int] = field(default_factory=dict)
    """For each definition that another file has, the index of that file, which comes later or is read elsewhere."""


class Composition:
    """The definitions and materials of all files; references between the files have no cycle."""

    def __init__(self, files: Sequence[FileDefinitions]) -> None:
        """Put them together, the file of the assembly first."""
        self._files = files
        self._offsets: list[int] = []
        self.definitions: list[Definition] = []
        self.materials: list[StepMaterial] = []
        for file in files:
            offset = len(self.definitions)
            self._offsets.append(offset)
            self.definitions += [_moved(definition, offset) for definition in file.definitions]
            self.materials += file.materials
        self._instead: dict[int, int] = {}
        self._named: set[int] = set()
        for number in range(len(files)):
            self._replace(number)
        for number, file in enumerate(files):
            for own in file.elsewhere:
                self._name(self._offsets[number] + own)
        for definition in self.definitions if self._instead else ():
            definition.children = [replace(c, definition=self._stand_in(c.definition)) for c in definition.children]

    @property
    def roots(self) -> list[int]:
        """The roots of the assembly."""
        return [self._stand_in(root) for root in self._files[0].roots]

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
                for index, definition in enumerate(file.definitions)
                if definition.product != NONE
            }
            for offset, file in zip(self._offsets, self._files, strict=True)
        ]

    def _replace(self, number: int) -> None:
        """Find the replacement of each definition whose shape is in another file."""
        offset = self._offsets[number]
        for own, other in self._files[number].elsewhere.items():
            index = offset + own
            roots = [self._offsets[other] + root for root in self._files[other].roots]
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
