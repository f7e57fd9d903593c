"""Check for reserved and duplicate names."""

import unicodedata
from collections.abc import Iterator

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.mesh_names import is_device, portable_name

from .document import Document
from .located import Sidecar
from .subjects import subject

UNPORTABLE = "ROS, xacro and some simulators take names of letters a to z, digits, `_`, `-` and `.` alone"
Named = tuple[str, str]
"""A top-level key and a name below it."""


def check_names(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report SB126 reserved names, SB129 names that not every reader takes, and SB135 duplicate names."""

    def report_unportable(name: str, kind: str, what: str, place: Span) -> None:
        if (portable := portable_name(name, kind)) != name:
            found.add("SB129", f"{what}: {UNPORTABLE}", place, help=[f"rename it to '{portable}'"])

    first: dict[str, Named] = {}
    for section, name in _shared_names(sidecar.document):
        if name in first:
            place = sidecar.key_span(*first[name])
            message = f"{subject((section, name))}: duplicate name (also used by {subject(first[name])})"
            help = [f"rename one of them, for example to '{name}_{section.removesuffix('s')}'"]
            found.add("SB135", message, sidecar.key_span(section, name), help=help, notes=[f"first defined at {place}"])
        first.setdefault(name, (section, name))
    for name, module in sidecar.document.modules.items():
        for section in ("links", "frames"):
            if name in getattr(sidecar.document, section):
                message = f"module '{name}': duplicate name (also used by {subject((section, name))})"
                help = [f"rename one of them: `{name}` alone refers to the root link of the module"]
                found.add("SB135", message, sidecar.key_span("modules", name), help=help)
        for key, text in ((("modules", name), name), (("modules", name, "prefix"), module.prefix or "")):
            if reason := _reserved("modules", text):
                found.add("SB126", f"{subject(key)}: {reason}", sidecar.key_span(*key))
            elif text:
                report_unportable(text, "module", f"{subject(key)}: '{text}'", sidecar.key_span(*key))
        for section, names in module.rename.items():
            for former, new in names.items():
                keys = "modules", name, "rename", section, former
                report_unportable(new, section.removesuffix("s"), f"{subject(keys)}: '{new}'", sidecar.span(*keys))
    robot = sidecar.document.robot
    if reason := _not_a_file(robot):
        found.add("SB126", f"robot: {reason}", sidecar.span("robot"))
    else:
        report_unportable(robot, "robot", f"robot '{robot}'", sidecar.span("robot"))
    for section, name in _all_names(sidecar.document):
        if reason := _reserved(section, name):
            found.add("SB126", f"{subject((section, name))}: {reason}", sidecar.key_span(section, name))
        else:
            place = sidecar.key_span(section, name)
            report_unportable(name, section.removesuffix("s"), subject((section, name)), place)


def _shared_names(document: Document) -> Iterator[Named]:
    """Sections that share one namespace in SDFormat."""
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
    """Why a name cannot be used, or an empty string."""
    if name == "world":
        return "'world' is reserved for the world in SDFormat and MJCF"
    if name == "assembly" and section == "links":
        return "'assembly' is reserved for the STEP assembly frame in `relative_to`"
    if name.startswith("__") and name.endswith("__"):
        return "names with leading and trailing double underscores are reserved by SDFormat"
    return "'::' is the scope separator of SDFormat" if "::" in name else _invisible_characters(name)


def _not_a_file(robot: str) -> str:
    """Why files cannot be named after a robot, or an empty string."""
    return f"'{robot}' is a device name on Windows" if is_device(robot) else _invisible_characters(robot)


def _invisible_characters(name: str) -> str:
    """The format characters of Unicode in a name, or an empty string; with them, different names look the same."""
    characters = sorted({f"U+{ord(character):04X}" for character in name if unicodedata.category(character) == "Cf"})
    what = "characters that are invisible or change the direction of text"
    return f"'{name}' contains {what}: {', '.join(characters)}" if characters else ""
