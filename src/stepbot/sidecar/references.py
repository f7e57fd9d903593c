"""Check names and the references to them: reserved and duplicate names, links, joints and materials."""

import unicodedata
from collections.abc import Collection, Iterable, Iterator
from fnmatch import fnmatchcase

from stepbot.diagnostics import Diagnostics, Span, did_you_mean
from stepbot.robot.mesh_names import is_device, portable_name, valid_name
from stepbot.robot.sensors import SensorKind

from .component_paths import origins
from .devices import SensorSection
from .document import Document
from .located import Sidecar
from .origins import AutoOrigin
from .remedies import quoted
from .tree import ELEMENTS, Keys, subject

_MOST_LISTED = 12

_WITH_PATH = ("joints", "closures", "root", "defaults", "excluded_contacts")
"""Sections with several references in one element."""
_SHARED = ("links", "joints", "closures", "frames")
"""Sections that share one namespace in SDFormat."""
_USERS = ("joints", "closures", "frames", "sensors")
"""Sections whose elements may be left over when a link is removed."""
_ON_JOINTS = (SensorKind.JOINT, SensorKind.FORCE_TORQUE)
_ON_LINKS = tuple(kind for kind in SensorKind if kind is not SensorKind.JOINT)


def check_references(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report names that refer to nothing."""
    document = sidecar.document
    _check_links(sidecar, diagnostics)
    _check_pairs(sidecar, diagnostics)
    _check_joints(sidecar, diagnostics)
    for name, sensor in document.sensors.items():
        _check_sensor(sidecar, name, sensor, diagnostics)
    _check_materials(sidecar, diagnostics)
    _check_patterns(sidecar, diagnostics)
    _check_rest(sidecar, diagnostics)
    _check_origins(sidecar, diagnostics)


def link_references(document: Document) -> Iterator[tuple[Keys, str | None]]:
    """Keys and names of all references to links, other than in origins."""
    if document.root is not None:
        yield ("root", "link"), document.root.link
    for name, joint in document.joints.items():
        yield ("joints", name, "parent"), joint.parent
        yield ("joints", name, "child"), joint.child
    for name, closure in document.closures.items():
        yield ("closures", name, "link_a"), closure.link_a
        yield ("closures", name, "link_b"), closure.link_b
    for index, pair in enumerate(document.excluded_contacts):
        yield from ((("excluded_contacts", index, side), link) for side, link in enumerate(pair))
    yield from ((("frames", name, "link"), frame.link) for name, frame in document.frames.items())
    yield from ((("sensors", name, "link"), sensor.link) for name, sensor in document.sensors.items())


def joint_references(document: Document) -> Iterator[tuple[Keys, str | None]]:
    """Keys and names of all references to joints."""
    for name, joint in document.joints.items():
        if joint.mimic is not None:
            yield ("joints", name, "mimic", "joint"), joint.mimic.joint
    yield from ((("actuators", name, "joint"), one.joint) for name, one in document.actuators.items())
    yield from ((("sensors", name, "joint"), one.joint) for name, one in document.sensors.items())


def _check_links(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    document = sidecar.document
    for keys, link in link_references(document):
        if link is None or link in document.links:
            continue
        help = _candidates(link, [name for name in document.links if name != _other_end(keys, document)], "links")
        if keys[0] in _USERS:
            help = (*help, f"or define link '{link}', or remove {subject(keys[:2])}")
        if link == "world":
            help = ("the world is not a link; `base: fixed` fixes the root link to the world",)
        diagnostics.add("SB130:link", f"{_user(keys)}: unknown link '{link}'", sidecar.span(*keys), help=help)


def _other_end(keys: Keys, document: Document) -> str | None:
    """The link at the other end of the joint or closure whose link is at ``keys``: not what was meant here."""
    section, name, *rest = keys
    if section == "joints":
        joint = document.joints[str(name)]
        return joint.child if rest == ["parent"] else joint.parent
    if section == "closures":
        closure = document.closures[str(name)]
        return closure.link_b if rest == ["link_a"] else closure.link_a
    return None


def _check_pairs(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report pairs of a link with itself, and those that are listed twice."""
    first: dict[frozenset[str], int] = {}
    for index, pair in enumerate(sidecar.document.excluded_contacts):
        keys = ("excluded_contacts", index)
        if pair[0] == pair[1]:
            what = f"both links are '{pair[0]}'; shapes of one link never touch"
        elif first.setdefault(frozenset(pair), index) != index:
            what = f"the same links as excluded_contacts[{first[frozenset(pair)]}]"
        else:
            continue
        diagnostics.add("SB146", f"{subject(keys)}: {what}", sidecar.span(*keys), help=["remove the pair"])


def _check_joints(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    document = sidecar.document
    for keys, joint in joint_references(document):
        if joint is None or joint in document.joints:
            continue
        others = [name for name in document.joints if keys[:2] != ("joints", name)]
        help = _candidates(joint, others, "joints" if others or not document.joints else "other joints")
        if "/" in joint and not document.modules:
            help = (
                "a joint of another module can lead one of the composing file's own `joints`, not one of this file",
            )
        elif joint in document.closures:
            help = ("it is a closure; only joints of the tree can be referenced",)
        elif not sidecar.written(*keys):
            help = ("without `joint`, an actuator drives the joint of its own name", *help)
        diagnostics.add("SB130:joint", f"{_user(keys)}: unknown joint '{joint}'", sidecar.span(*keys), help=help)


def _check_sensor(sidecar: Sidecar, name: str, sensor: SensorSection, diagnostics: Diagnostics) -> None:
    keys = ("sensors", name)
    help = f"set `joint`{', or `link`' * (sensor.type in _ON_LINKS)}" if sensor.type in _ON_JOINTS else "set `link`"
    if sensor.link is None and sensor.joint is None:
        message = "neither `link` nor `joint` is set"
    elif sensor.link is not None and sensor.joint is not None:
        message = "both `link` and `joint` are set"
        both = sensor.type in _ON_LINKS and sensor.type in _ON_JOINTS
        help = f"remove `{'joint' if sensor.type in _ON_LINKS else 'link'}`{', or `link`' if both else ''}"
    elif sensor.joint is not None and sensor.type not in _ON_JOINTS:
        message = f"a sensor of type {sensor.type} requires `link`, not `joint`"
    elif sensor.link is not None and sensor.type not in _ON_LINKS:
        message = f"a sensor of type {sensor.type} requires `joint`, not `link`"
    else:
        return
    diagnostics.add("SB136", f"{subject(keys)}: {message}", sidecar.key_span(*keys), help=[help])


def _check_materials(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    document = sidecar.document
    named: list[tuple[Keys, str | None]] = [(("defaults", "material"), document.defaults.material)]
    named += [(("parts", path, "material"), rule.material) for path, rule in document.parts.items()]
    for keys, material in named:
        if material is not None and material not in document.materials:
            help = _candidates(material, document.materials, "materials")
            if not any(one.startswith("did you mean") for one in help):
                help = (*help, f"define it: `materials: {{{quoted(material)}: {{density: ...}}}}`")
            diagnostics.add(
                "SB130:material", f"{_user(keys)}: unknown material '{material}'", sidecar.span(*keys), help=help
            )


def _check_patterns(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    joints = sidecar.document.joints
    for pattern in sidecar.document.joint_defaults:
        if not any(fnmatchcase(name, pattern) for name in joints):
            keys = ("joint_defaults", pattern)
            help = _candidates(pattern, joints, "joints")
            diagnostics.add("SB133", f"{subject(keys)}: does not match any joint", sidecar.key_span(*keys), help=help)


def _check_rest(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    taking = [name for name, link in sidecar.document.links.items() if link.rest]
    for name in taking[1:]:
        message = f"link '{name}': link '{taking[0]}' already has `rest: true`"
        notes = [f"first defined at {sidecar.key_span('links', taking[0], 'rest')}"]
        place = sidecar.key_span("links", name, "rest")
        diagnostics.add("SB134", message, place, help=["keep `rest: true` on one link"], notes=notes)


def _check_origins(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    for keys, origin in origins(sidecar.document):
        if keys[0] not in ("joints", "closures") and (origin == "auto" or isinstance(origin, AutoOrigin)):
            message = f"{subject(keys)}: `auto` requires two links"
            help = ['use {axis_of: "..."}, {center: "..."}, {component: "..."} or {xyz: [...]}']
            diagnostics.add("SB128", message, sidecar.span(*keys), help=help)


def _user(keys: Keys) -> str:
    """The subject of a message about a reference; names which of its two links is meant, if it has two."""
    return subject(keys if keys[0] in _WITH_PATH else keys[:2])


def _candidates(name: str, names: Collection[str], what: str) -> tuple[str, ...]:
    near = did_you_mean(name, names)
    if near or not names:
        return near or (f"no {what} are defined",)
    listed = list(names)[:_MOST_LISTED]
    return (f"{what}: {', '.join(listed)}" + (", ..." if len(names) > len(listed) else ""),)


Named = tuple[str, str]
"""A top-level key and a name below it."""


def not_portable(name: str) -> str:
    """Why :func:`stepbot.robot.mesh_names.portable_name` is another name than ``name``, as the end of a message."""
    readers = "ROS, xacro and some simulators"
    if portable_name(after_a_letter := f"a{name}", "link") == after_a_letter:
        return f"{readers} take names that begin with a letter or `_`"
    return f"{readers} take names of letters a to z, digits, `_`, `-` and `.` alone"


def check_names(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report SB126 reserved names, SB129 names that not every reader takes, and SB135 duplicate names."""

    def report_unportable(name: str, kind: str, what: str, place: Span) -> None:
        if (portable := portable_name(name, kind)) != name:
            diagnostics.add("SB129", f"{what}: {not_portable(name)}", place, help=[f"rename it to '{portable}'"])

    def report_reserved(name: str, what: str, reason: str, place: Span) -> None:
        kind, _, _ = what.partition(" ")
        free = valid_name(name, kind)
        help = [f"rename it, for example to '{free if free != name else f'{name}_{kind}'}'"]
        diagnostics.add("SB126", f"{what}: {reason}", place, help=help)

    first: dict[str, Named] = {}
    for section, name in _names(sidecar.document, _SHARED):
        if name in first:
            place = sidecar.key_span(*first[name])
            message = f"{subject((section, name))}: duplicate name (also used by {subject(first[name])})"
            help = [f"rename one of them, for example to '{name}_{section.removesuffix('s')}'"]
            diagnostics.add(
                "SB135", message, sidecar.key_span(section, name), help=help, notes=[f"first defined at {place}"]
            )
        first.setdefault(name, (section, name))
    for name, module in sidecar.document.modules.items():
        for section in ("links", "frames"):
            if name in getattr(sidecar.document, section):
                message = f"module '{name}': duplicate name (also used by {subject((section, name))})"
                help = [f"rename one of them: `{name}` alone refers to the root link of the module"]
                diagnostics.add("SB135", message, sidecar.key_span("modules", name), help=help)
        for key, text in ((("modules", name), name), (("modules", name, "prefix"), module.prefix or "")):
            if reason := _reserved("modules", text):
                report_reserved(text, subject(key), reason, sidecar.key_span(*key))
            elif text:
                report_unportable(text, "module", f"{subject(key)}: '{text}'", sidecar.key_span(*key))
        for section, names in module.rename.items():
            for former, new in names.items():
                keys = "modules", name, "rename", section, former
                report_unportable(new, section.removesuffix("s"), f"{subject(keys)}: '{new}'", sidecar.span(*keys))
    robot = sidecar.document.robot
    if reason := _not_a_file(robot):
        report_reserved(robot, "robot", reason, sidecar.span("robot"))
    else:
        report_unportable(robot, "robot", f"robot '{robot}'", sidecar.span("robot"))
    for section, name in _names(sidecar.document):
        if reason := _reserved(section, name):
            report_reserved(name, subject((section, name)), reason, sidecar.key_span(section, name))
        else:
            place = sidecar.key_span(section, name)
            report_unportable(name, section.removesuffix("s"), subject((section, name)), place)


def _names(document: Document, sections: Iterable[str] = ELEMENTS) -> Iterator[Named]:
    return ((section, name) for section in sections for name in getattr(document, section))


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
