"""Names that the formats keep for themselves, or that two things of the robot share."""

from collections.abc import Iterator

from stepbot.diagnostics import Diagnostics

from .document import Document
from .located import Sidecar
from .subjects import subject

Named = tuple[str, str]
"""A top-level key and a name below it."""


def check_names(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report reserved names, SB126, and names used twice, SB135."""
    first: dict[str, Named] = {}
    for section, name in _shared_names(sidecar.document):
        if name in first:
            place = sidecar.key_span(*first[name])
            message = f"{subject((section, name))}: {subject(first[name])} has the same name"
            help = [f"rename one of them: '{name}_{section.removesuffix('s')}', say"]
            found.add("SB135", message, sidecar.key_span(section, name), help=help, notes=[f"first at {place}"])
        first.setdefault(name, (section, name))
    for section, name in _all_names(sidecar.document):
        if reason := _reserved(section, name):
            found.add("SB126", f"{subject((section, name))}: {reason}", sidecar.key_span(section, name))


def _shared_names(document: Document) -> Iterator[Named]:
    """What has one set of names in SDFormat."""
    for section, names in (
        ("links", document.links),
        ("joints", document.joints),
        ("closures", document.closures),
        ("frames", document.frames),
    ):
        yield from ((section, name) for name in names)


def _all_names(document: Document) -> Iterator[Named]:
    yield from _shared_names(document)
    yield from (("actuators", name) for name in document.actuators)
    yield from (("sensors", name) for name in document.sensors)


def _reserved(section: str, name: str) -> str:
    """Why a name cannot be used, or nothing."""
    if name == "world":
        return "'world' is the world itself in SDFormat and MJCF"
    if name == "assembly" and section == "links":
        return "'assembly' is the frame of the STEP, where an origin says `relative_to`"
    if name.startswith("__") and name.endswith("__"):
        return "names between double underscores belong to SDFormat"
    return "'::' separates scopes in SDFormat" if "::" in name else ""
