"""Reports statements that the kernel silently skipped while it read a file.

The kernel skips invalid statements, ignores dangling references, and continues: then a part is missing, is at the
origin, or crashes the kernel later. It reports this only on request.
"""

import re
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray
from OCP.StepBasic import StepBasic_MeasureWithUnit, StepBasic_NamedUnit, StepBasic_ProductDefinition
from OCP.StepData import StepData_UndefinedEntity
from OCP.StepGeom import StepGeom_GeometricRepresentationItem
from OCP.StepRepr import (
    StepRepr_ItemDefinedTransformation,
    StepRepr_MappedItem,
    StepRepr_NextAssemblyUsageOccurrence,
    StepRepr_ProductDefinitionShape,
    StepRepr_RepresentationContext,
    StepRepr_RepresentationMap,
    StepRepr_RepresentationRelationship,
)
from OCP.StepShape import (
    StepShape_ContextDependentShapeRepresentation,
    StepShape_ShapeDefinitionRepresentation,
    StepShape_ShapeRepresentation,
    StepShape_TopologicalRepresentationItem,
)

from stepbot.diagnostics import Diagnostics, Span, cut
from stepbot.runtime.file import read_regular

from .statements import Statement, duplicates, find_statements

_SHAPES = (
    StepGeom_GeometricRepresentationItem,
    StepShape_TopologicalRepresentationItem,
    StepRepr_ItemDefinedTransformation,
    StepRepr_MappedItem,
    StepRepr_NextAssemblyUsageOccurrence,
    StepRepr_RepresentationMap,
    StepRepr_RepresentationRelationship,
)
"""Classes whose entities draw or place something, and must be complete."""
_STRUCTURE = (
    StepBasic_MeasureWithUnit,
    StepBasic_NamedUnit,
    StepBasic_ProductDefinition,
    StepRepr_ProductDefinitionShape,
    StepRepr_RepresentationContext,
    StepShape_ContextDependentShapeRepresentation,
    StepShape_ShapeDefinitionRepresentation,
    StepShape_ShapeRepresentation,
)
"""Classes that must not have dangling references, but may refer to entity types of newer schemas that the kernel
ignores."""
_PRESENTATION = re.compile("StepVisual_(?!Tessellated|Triangulated|Coordinates|Complex)|StepDimTol_|StepAP")
"""Modules of entities for presentation or management: texts and styles are representation items too."""
_NOT_SHAPES = re.compile("TEXT|CALLOUT|ANNOTATION|DIMENSION|TOLERANCE|DATUM|SYMBOL|FILL_AREA|HATCH|CAMERA|PLANAR_")
"""Types among the items of a shape that are drawing annotations, which may be dropped."""

_SYNTAX = re.compile(r"Undefined Parsing: Line (\d+): (?:Incorrect syntax: )?(.*)", re.DOTALL)
_AROUND_DATA = re.compile(rb"\A.*?\bDATA\s*;|\bSIGNATURE\s*;[\w+/=\s]*?\bENDSEC\s*;(?=\s*END-ISO-10303-21)", re.DOTALL)
_LATER_SECTION = re.compile(rb"\b(?:ANCHOR|REFERENCE|SIGNATURE)\s*;.*?\bENDSEC\s*;", re.DOTALL)
"""Sections of the third edition of ISO 10303-21, before and after the data, which the kernel skips as faults."""
_UNKNOWN_SECTION = re.compile(r"unexpected TYPE, expecting (?:DATA|ENDSTEP)")
_UNRESOLVED = re.compile(r"Unresolved Reference,.*\(Id\.#(\d+)\)")
_DUPLICATE = re.compile(r"Ident defined SEVERAL TIMES : #(\d+)")
_WRONG_KIND = re.compile(r"Parameter \S+ \((?:.*\.)?(\w+)\) : Entity has illegal type")

_SHOWN = 5
"""Maximum number of places in a diagnostic."""
_REMEDY = ("export the file again, or copy it again from its source",)


class _Fault(Struct, frozen=True, order=True):
    """A fault in one statement."""

    line: int
    text: str
    """``#12 LINE: there is no #15``."""
    is_essential: bool = True
    """Whether a shape, or its pose, depends on it."""


class _Statements:
    """The statements of a file, searched only after a fault."""

    def __init__(self, path: Path, model: Any) -> None:
        self._path, self._model = path, model

    @cached_property
    def data(self) -> bytes:
        """The bytes of the file, without what entities of other files and signatures are stated in."""
        return _AROUND_DATA.sub(lambda around: _LATER_SECTION.sub(_blanks, around[0]), self._content)

    @property
    def has_later_sections(self) -> bool:
        """Whether there are sections that the kernel does not know."""
        return self.data != self._content

    @cached_property
    def _content(self) -> bytes:
        return read_regular(self._path)

    @cached_property
    def all(self) -> list[Statement]:
        """In file order."""
        return list(find_statements(self.data))

    @cached_property
    def by_number(self) -> dict[int, Statement]:
        """By the number that they define."""
        return {statement.number: statement for statement in self.all}

    def entity(self, statement: Statement) -> Any:
        """The kernel's entity of a statement; None if it has none."""
        index = self._model.NextNumberForLabel(f"#{statement.number}")
        return self._model.Value(index) if index > 0 else None

    def of_entity(self, index: int) -> Statement | None:
        """The statement of an entity by its index, from 1; None if the kernel's count differs from the text."""
        statement = self.all[index - 1] if 0 < index <= len(self.all) else None
        if statement is None or self._model.NextNumberForLabel(f"#{statement.number}") != index:
            return None
        return statement

    @cached_property
    def _line_ends(self) -> NDArray[np.intp]:
        return np.flatnonzero(np.frombuffer(self.data, dtype=np.uint8) == ord("\n"))

    def line(self, statement: Statement) -> int:
        """From 1."""
        return int(np.searchsorted(self._line_ends, statement.start)) + 1


def check_numbers(path: Path, place: str, diagnostics: Diagnostics) -> bool:
    """Whether every entity has a number of its own (else SB221); to be called before the kernel reads the file.

    On duplicate numbers the kernel occasionally does not terminate (StepData_StepReaderData::SetEntityNumbers, OCCT
    8.0).
    """
    statements = _Statements(path, None)
    faults = [_duplicate(duplicate, statements) for duplicate in duplicates(statements.data)]
    _report("SB221", "the file has syntax errors", faults, place, diagnostics)
    return not faults


def check_integrity(session: Any, path: Path, place: str, diagnostics: Diagnostics) -> bool:
    """Whether everything that draws or places something was understood; the rest is reported in ``diagnostics``.

    Args:
        diagnostics: Receives SB221, which is an error, and SB223.
    """
    model = session.Model()
    check = model.GlobalCheck(True)
    messages = [str(check.CFail(index)) for index in range(1, check.NbFails() + 1)]
    statements = _Statements(path, model)
    broken = [*_broken(messages, statements), *_duplicates(messages, statements)]
    lacking = [*_missing(messages, statements), *_wrong_kinds(session, statements)]
    essential = [fault for fault in lacking if fault.is_essential]
    others = [fault for fault in lacking if not fault.is_essential]
    _report("SB221", "the file has syntax errors", broken, place, diagnostics)
    _report("SB221", "entities of shapes or placements are missing", essential, place, diagnostics)
    _report("SB223", "entities unrelated to shapes were not read", others, place, diagnostics)
    return not (broken or essential)


def _blanks(match: re.Match[bytes]) -> bytes:
    """As many blanks, and the same lines."""
    return re.sub(rb"[^\r\n]", b" ", match[0])


def _broken(messages: Sequence[str], statements: _Statements) -> Iterator[_Fault]:
    for message in messages:
        if (match := _SYNTAX.search(message)) and not (
            statements.has_later_sections and _UNKNOWN_SECTION.search(match[2])
        ):
            yield _Fault(int(match[1]), " ".join(match[2].split()))


def _duplicates(messages: Sequence[str], statements: _Statements) -> Iterator[_Fault]:
    for message in messages:
        if (match := _DUPLICATE.search(message)) and (statement := statements.by_number.get(int(match[1]))):
            yield _duplicate(statement, statements)


def _duplicate(statement: Statement, statements: _Statements) -> _Fault:
    return _Fault(statements.line(statement), f"{statement}: duplicate entity number")


def _missing(messages: Sequence[str], statements: _Statements) -> Iterator[_Fault]:
    """Dangling references. The kernel reports their target, but not always the statement that contains them."""
    targets = {int(match[1]) for message in messages if (match := _UNRESOLVED.search(message))}
    for statement in statements.all if targets else ():
        numbers = set(statement.references)
        for number in sorted(numbers & targets - statements.by_number.keys()):
            is_essential = _is_essential(statements.entity(statement), (*_SHAPES, *_STRUCTURE))
            text = f"{statement}: #{number} is not defined"
            yield _Fault(statements.line(statement), text, is_essential)


def _wrong_kinds(session: Any, statements: _Statements) -> Iterator[_Fault]:
    """References to entities of a wrong type, or of a type that the kernel does not support."""
    checks = session.ModelCheckList(False)
    checks.Start()
    while checks.More():
        index, check = checks.Number(), checks.Value()
        checks.Next()
        fails = (_WRONG_KIND.search(str(check.CFail(number))) for number in range(1, check.NbFails() + 1))
        names = list(dict.fromkeys(match[1] for match in fails if match))
        entity = session.Model().Value(index) if names and index > 0 else None
        statement = statements.of_entity(index) if entity is not None else None
        if isinstance(entity, StepShape_ShapeRepresentation) and statement is not None:
            yield from _unknown_items(statement, statements)
        elif _is_essential(entity, _SHAPES):
            kind = type(entity).__name__.partition("_")[2]
            name, line = (str(statement), statements.line(statement)) if statement is not None else (kind, 0)
            yield _Fault(line, f"{name}: {', '.join(names)} has the wrong type")


def _unknown_items(representation: Statement, statements: _Statements) -> Iterator[_Fault]:
    """Items of a shape that the kernel does not support, except drawing annotations."""
    for number in representation.references:
        item = statements.by_number.get(number)
        if item is None or not isinstance(statements.entity(item), StepData_UndefinedEntity):
            continue
        if not _NOT_SHAPES.search(item.keyword):
            yield _Fault(statements.line(item), f"{item}: unknown entity type", is_essential=False)


def _is_essential(entity: Any, kinds: tuple[type, ...]) -> bool:
    return isinstance(entity, kinds) and not _PRESENTATION.match(type(entity).__name__)


def _report(code: str, message: str, faults: Sequence[_Fault], place: str, diagnostics: Diagnostics) -> None:
    if not faults:
        return
    ordered = sorted(dict.fromkeys(faults))
    notes = cut([f"line {fault.line}: {fault.text}" if fault.line else fault.text for fault in ordered], _SHOWN)
    line = ordered[0].line
    diagnostics.add(code, message, Span(place, line, 1) if line else Span(place), help=_REMEDY, notes=notes)
