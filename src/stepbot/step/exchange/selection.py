"""Entities of a STEP file by type: the kernel searches its own model, without a Python loop over every entity."""

from collections.abc import Iterator
from typing import Any

from OCP.IFSelect import IFSelect_SelectModelEntities, IFSelect_SelectType
from OCP.StepAP214 import StepAP214_AppliedExternalIdentificationAssignment
from OCP.StepBasic import StepBasic_DocumentFile, StepBasic_ExternalSource, StepBasic_SourceItem
from OCP.StepRepr import StepRepr_ProductDefinitionShape, StepRepr_PropertyDefinitionRepresentation
from OCP.TCollection import TCollection_HAsciiString

_MECHANISM = "StepKinematics_KinematicPropertyMechanismRepresentation"


def entities(session: Any, kind: Any) -> list[Any]:
    """All entities of a class or a derived class, in file order.

    Entities whose class has no Python binding, such as those of kinematic mechanisms, are left out: in Python they are
    objects without methods.

    Args:
        session: The reader's ``XSControl_WorkSession``.
        kind: Class of the kernel's STEP schema, such as ``StepBasic_ProductDefinition``.
    """
    return [entity for entity in _selected(session, kind) if isinstance(entity, kind)]


def mechanism_count(session: Any) -> int:
    """Number of kinematic mechanisms (ISO 10303-105) in the file."""
    properties = _selected(session, StepRepr_PropertyDefinitionRepresentation)
    return sum(entity.DynamicType().Name() == _MECHANISM for entity in properties)


def _selected(session: Any, kind: Any) -> list[Any]:
    selection = IFSelect_SelectType(kind.get_type_descriptor_s())
    selection.SetInput(IFSelect_SelectModelEntities())
    selected = session.EvalSelection(selection)
    selected.Start()
    listed = []
    while selected.More():
        listed.append(selected.Value())
        selected.Next()
    return listed


def items(representation: Any) -> Iterator[Any]:
    """The items of a STEP representation; none if the file refers to an entity of another type."""
    for index in range(1, representation.NbItems() + 1 if representation is not None else 1):
        if (item := representation.ItemsValue(index)) is not None:
            yield item


def text(string: Any) -> str:
    """A string of the model; empty if there is none."""
    return string.ToCString() if string is not None else ""


def described_by(property_definition: Any) -> Any:
    """The subject of a property: a product definition, an occurrence, an aspect of a shape; None for other entities."""
    return shaped(property_definition.Definition().Value()) if hasattr(property_definition, "Definition") else None


def shaped(entity: Any) -> Any:
    """The element that a shape belongs to; any other entity is returned unchanged."""
    return entity.Definition().Value() if isinstance(entity, StepRepr_ProductDefinitionShape) else entity


def forget_external_files(session: Any) -> None:
    """Take the names of external files out of the model, so that the kernel opens none.

    It takes the location for the name where a document has no name.
    """
    for source in entities(session, StepBasic_ExternalSource):
        source.SetSourceId(StepBasic_SourceItem())
    for assignment in entities(session, StepAP214_AppliedExternalIdentificationAssignment):
        assignment.SetAssignedId(TCollection_HAsciiString(""))
    for document in entities(session, StepBasic_DocumentFile):
        document.SetId(TCollection_HAsciiString(""))


def entity_of(session: Any, number: int) -> Any:
    """The entity with a number in the text; None where the model has none."""
    model = session.Model()
    index = model.NextNumberForLabel(f"#{number}") if number > 0 else 0
    return model.Value(index) if index > 0 else None
