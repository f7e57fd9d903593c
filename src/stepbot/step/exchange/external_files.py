"""External files in the kernel's model of a STEP file.

Left alone, the kernel opens whatever file a DOCUMENT_FILE names, wherever that is, while it builds shapes. Files are
chosen and read by stepbot (:mod:`stepbot.step.exchange.file_set`), each on its own.
"""

from typing import Any

from OCP.StepAP214 import StepAP214_AppliedExternalIdentificationAssignment
from OCP.StepBasic import StepBasic_DocumentFile
from OCP.TCollection import TCollection_HAsciiString

from .selection import entities


def forget_external_files(session: Any) -> None:
    """Take the names of external files out of the model, so that the kernel opens none."""
    for assignment in entities(session, StepAP214_AppliedExternalIdentificationAssignment):
        assignment.SetAssignedId(TCollection_HAsciiString(""))
    for document in entities(session, StepBasic_DocumentFile):
        document.SetId(TCollection_HAsciiString(""))


def entity_of(session: Any, number: int) -> Any:
    """The entity with a number in the text; None where the model has none."""
    model = session.Model()
    index = model.NextNumberForLabel(f"#{number}") if number > 0 else 0
    return model.Value(index) if index > 0 else None
