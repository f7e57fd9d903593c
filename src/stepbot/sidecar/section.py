"""Base class of the sidecar's sections, and the types of names in them."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Discriminator, Field


def _name_pattern(excluded: str, at_ends: str) -> str:
    """Pattern of strings without some characters, and without some others at their start and end.

    Valid for Rust, Python and ECMA 262 with its ``u`` flag, since editors use it too.
    """
    inner, outer = rf"[^{excluded}\x00-\x1f\x7f]", rf"[^\s{at_ends}{excluded}\x00-\x1f\x7f]"
    return f"^{outer}({inner}*{outer})?$"


NOT_IN_NAMES = "/<>&\"'"
NOT_IN_FILE_NAMES = NOT_IN_NAMES + "\\:*?|"

NAME_PATTERN = _name_pattern(NOT_IN_NAMES, "")
ROBOT_NAME_PATTERN = _name_pattern(NOT_IN_FILE_NAMES.replace("\\", r"\\"), ".")

Name = Annotated[str, Field(min_length=1, max_length=200, pattern=NAME_PATTERN)]
"""A name that every output format can represent."""
REFERENCE_PATTERN = f"^{NAME_PATTERN[1:-1]}(/{NAME_PATTERN[1:-1]})*$"
Reference = Annotated[str, Field(min_length=1, max_length=1000, pattern=REFERENCE_PATTERN)]
"""The name of an element, or its path through modules: ``arm/hand/tcp`` is ``tcp`` of module ``hand`` of ``arm``."""
MaterialName = Annotated[str, Field(min_length=1, max_length=200, pattern=_name_pattern("", ""))]
"""A material's name in a CAD program: `Steel, 1.4301 / X5CrNi18-10`; it is not written to any output."""
RobotName = Annotated[str, Field(min_length=1, max_length=100, pattern=ROBOT_NAME_PATTERN)]
"""A name that is also a valid file name on every system."""
ComponentPath = Annotated[str, Field(min_length=1, max_length=2000)]
"""A component path or glob; the grammar is in :mod:`stepbot.step.structure.paths`."""


class Section(BaseModel):
    """Base of every mapping in the sidecar: no unknown keys, immutable."""

    # Deferred: only the document as a whole is validated, and building a validator per section takes longer.
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


# Tags of unions are distinguishable from keys, since pydantic puts both into the location of an error.
WORD_OR_MAPPING = Discriminator(lambda value: "<word>" if isinstance(value, str) else "<mapping>")
"""Of a union whose members have these tags: what is no word is read as a mapping."""
MAPPING_OR_WORD = Discriminator(lambda value: "<mapping>" if isinstance(value, dict | Section) else "<word>")
"""The same, and what is no mapping is read as a word."""
