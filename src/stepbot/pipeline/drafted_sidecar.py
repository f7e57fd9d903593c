"""Writes the sidecar of a draft."""

from pathlib import Path

from stepbot.diagnostics import Diagnostics
from stepbot.draft.draft import Draft
from stepbot.draft.text.sidecar_text import SCHEMA_FILE, relative_step, sidecar_text
from stepbot.runtime.file import exists, write_file
from stepbot.sidecar.schema import schema_text


def write_draft(draft: Draft, sidecar: Path, step: Path, encoding: str, found: Diagnostics) -> str:
    """Write the sidecar, and the schema for editors if it does not exist; errors are reported in ``found``.

    Returns:
        The text of the sidecar.
    """
    text = sidecar_text(draft, relative_step(step, sidecar), encoding=encoding)
    schema = sidecar.with_name(SCHEMA_FILE)
    write_file(sidecar, text.encode("utf-8"), found)
    if not found.has_errors and not exists(schema):
        write_file(schema, schema_text().encode("utf-8"), found)
    return text
