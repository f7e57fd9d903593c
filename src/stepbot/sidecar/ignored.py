"""Diagnostics that the sidecar suppresses."""

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field, Tag

from stepbot.diagnostics import Diagnostics, Ignore, did_you_mean
from stepbot.diagnostics.codes import CODES, current

from .section import MAPPING_OR_WORD, Section
from .tree import Keys, Listing, Mapping, Tree, child, entries_of, last_line, subject, value_at

FindingCode = Annotated[str, Field(max_length=40, json_schema_extra={"pattern": "^SB[0-9]{3}(:[a-z-]+)?$"})]
"""A code of a warning or a note, some with a feature, as in `SB760:armature`; `stepbot explain` lists them."""


class IgnoredFinding(Section):
    """Suppresses diagnostics of one code, with a reason."""

    code: FindingCode
    """Code of a warning or a note, such as `SB305`."""
    reason: Annotated[str, Field(max_length=1000)] = ""
    """Why the diagnostic does not matter here."""


IgnoredFindings = tuple[
    Annotated[Annotated[FindingCode, Tag("<word>")] | Annotated[IgnoredFinding, Tag("<mapping>")], MAPPING_OR_WORD], ...
]
"""Codes, or mappings of code and reason."""

KEY = "ignore_findings"
_SECTIONS = ("parts", "links", "joints")
"""Top-level keys whose entries have the key too."""


def can_ignore(keys: Keys) -> bool:
    """Whether the element at keys has the key itself."""
    return len(keys) > 1 and keys[0] in _SECTIONS


def check_ignored(root: Tree, diagnostics: Diagnostics) -> None:
    """Report unknown codes and codes of errors (SB141)."""
    for _, code, place in _entries(root):
        known = current(code)
        if not known:
            near = did_you_mean(code.upper(), CODES) or ("list all codes with `stepbot explain`",)
            diagnostics.add("SB141", f"{KEY}: unknown code '{code}'", place, help=near)
        elif all(CODES[one].severity == "error" for one in known):
            help = [f"correct the error; see `stepbot explain {code}`"]
            diagnostics.add("SB141", f"{KEY}: {code} is an error and cannot be ignored", place, help=help)


def ignores(root: Tree) -> Iterator[Ignore]:
    """The ignore rules of the sidecar, at the top level and in its sections."""
    for keys, code, place in _entries(root):
        if not keys:
            yield Ignore(code, place)
            continue
        entry = value_at(root, keys)
        assert entry is not None
        pattern = str(keys[1]) if keys[0] == "parts" else ""
        yield Ignore(code, place, subject(keys), entry.span.line, last_line(entry), pattern)


def _entries(root: Tree) -> Iterator[tuple[Keys, str, Any]]:
    """Section, code and place of each entry."""
    sections: list[Keys] = [()]
    for key in _SECTIONS:
        sections += [(key, name) for name in entries_of(child(root, key))]
    for keys in sections:
        listed = value_at(root, (*keys, KEY))
        for value in listed.values if isinstance(listed, Listing) else ():
            code = value.entries["code"].value if isinstance(value, Mapping) and "code" in value.entries else value
            yield keys, getattr(code, "text", ""), code.span
