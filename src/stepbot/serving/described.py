"""Edits of a sidecar that changes an existing description: one module, whose values are edited as if they were its own.

The page gets a sidecar with all values of the robot. What it changes is written under `set` and `rename` of the module.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from stepbot.compose.changing import CHANGEABLE, sidecar_of
from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import is_description
from stepbot.pipeline.sidecars import LIBRARY
from stepbot.robot.model import Module, Robot
from stepbot.sidecar.editing import Annotate, Append, Change, Put, Remove, Rename
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.tree import Keys, Tree, way
from stepbot.sidecar.tree import Mapping as Values
from stepbot.sidecar.variants import merged

from .local_server import Refused
from .questions import Json

_OF_STEP = ("step", "root", "materials", "defaults", "parts", "mass", "step_density", "step_encoding", "closures")
_STAY = ("assign", "add_joint", "add_closure", "remove_joint", "merge", "root", "origin", "confirm")
"""Actions on the tree of links, which is that of the description."""


@dataclass(frozen=True)
class Edited:
    """A sidecar as the page edits it."""

    sidecar: Sidecar
    own: Tree
    """The values that are written in the file, under the keys that the page has for them."""
    module: str = ""
    """The module whose description it changes; empty for a sidecar of a STEP file or of several modules."""
    source: str = ""
    """Name of the description."""


def edited_view(sidecar: Sidecar, robot: Robot | None) -> Edited:
    """The sidecar with all values of the description that it changes; any other one as it is.

    Args:
        sidecar: The sidecar.
        robot: The robot that it describes now.
    """
    named = list(sidecar.document.modules.items())
    if robot is None or sidecar.document.links or len(named) != 1:
        return Edited(sidecar, sidecar.root)
    module, section = named[0]
    source = section.file or ""
    if section.prefix != "" or section.mirror or not is_description(sidecar.path.parent / source):
        return Edited(sidecar, sidecar.root)
    values = way(sidecar.root, ("modules", module, "set"))
    changes = values[3] if len(values) == 4 and isinstance(values[3], Values) else None
    base = sidecar_of(robot, changes, sidecar.path.parent / source, found := Diagnostics())
    if base is None:
        raise Refused(next((one.message for one in found), "the description cannot be edited"))
    assert isinstance(sidecar.root, Values)
    entries = {key: entry for key, entry in sidecar.root.entries.items() if key != "modules"}
    entries |= {} if changes is None else changes.entries
    own = replace(sidecar.root, entries=entries)
    root = merged(base.root, own)
    return Edited(replace(base, path=sidecar.path, text=sidecar.text, root=root), own, module, source)


def require_fit(view: Edited, question: Json) -> None:
    """Check that an edit is one of values, if the robot is that of a description.

    Raises:
        Refused: It changes the tree of links.
    """
    edits = question.get("edits")
    for one in edits if isinstance(edits, list) else [question]:
        if view.module and isinstance(one, dict) and one.get("action") in _STAY:
            raise Refused(f"the tree of links is that of '{view.source}', which stays as it is")


def require_own(sidecar: Sidecar, robot: Robot | None, question: Json) -> None:
    """Check that an edit is about elements of the file, and not about those of a module that it composes.

    Raises:
        Refused: With the file that has the element.
    """
    edits = question.get("edits")
    for one in edits if isinstance(edits, list) else [question]:
        for section, name in _subjects(one):
            own = getattr(sidecar.document, section)
            module = None if robot is None or name in own else _module_of(robot, section, name)
            if module is not None:
                command = module_command(sidecar, module)
                raise Refused(f"'{name}' is in module '{module.name}', which is edited in its own file: `{command}`")


def module_command(sidecar: Sidecar, module: Module) -> str:
    """The command that gives the file of a module for editing: of the one that the sidecar names."""
    sections = sidecar.document.modules
    section = sections.get(module.name.partition("/")[0])
    if section is not None and section.mirror_of:
        section = sections.get(section.mirror_of)
    file = module.file if section is None else section.file or module.file
    if file.startswith(LIBRARY):
        return f"stepbot library export --source {file.removeprefix(LIBRARY)}"
    return f"stepbot view --edit {(sidecar.path.parent / file).as_posix()}"


def _subjects(edit: object) -> Iterator[tuple[str, str]]:
    """Sections and names of the elements that an edit changes."""
    if not isinstance(edit, dict):
        return
    keys, what = edit.get("keys"), edit.get("what")
    if isinstance(keys, list) and len(keys) > 1 and keys[0] in ("links", "joints"):
        yield str(keys[0]), str(keys[1])
    if what in ("link", "joint"):
        yield f"{what}s", str(edit.get("from"))
    for key in ("link", "joint"):
        if key in edit:
            yield f"{key}s", str(edit[key])


def _module_of(robot: Robot, section: str, name: str) -> Module | None:
    """The innermost module of a link, or of the link below a joint."""
    link = name if section == "links" else next((one.child for one in robot.joints if one.name == name), "")
    return next((one for one in reversed(robot.modules) if link in one.links), None)


def in_file(actual: Sidecar, view: Edited, changes: list[Change], question: Json) -> list[Change]:
    """Changes of a view as changes of the file."""
    return list(_in_file(actual, view, changes, str(question.get("action")))) if view.module else changes


def _in_file(actual: Sidecar, view: Edited, changes: list[Change], action: str) -> Iterator[Change]:
    for change in changes:
        keys = _placed(view, change.keys)
        is_there = len(way(actual.root, keys)) == len(keys) + 1
        if isinstance(change, Rename):
            yield from _renamed(actual, view, change)
            if is_there:
                yield replace(change, keys=keys)
        elif isinstance(change, Put | Append):
            if is_there or action != "rename":  # references in the description follow its names
                yield replace(change, keys=keys)
        elif is_there:
            assert isinstance(change, Remove | Annotate)
            yield replace(change, keys=keys)
        elif isinstance(change, Remove) and action in ("set", "all"):
            raise Refused(f"this value is in '{view.source}', which stays as it is; give another value")


def _placed(view: Edited, keys: Keys) -> Keys:
    if keys[0] in _OF_STEP:
        raise Refused(f"`{keys[0]}` is for STEP files; '{view.source}' is none")
    if keys[0] in CHANGEABLE:
        return ("modules", view.module, "set", *keys)
    return keys


def _renamed(actual: Sidecar, view: Edited, change: Rename) -> Iterator[Change]:
    section, name = str(change.keys[0]), str(change.keys[1])
    if section == "joint_defaults":
        return
    names: Mapping[str, str] = dict(actual.document.modules[view.module].rename).get(section, {})  # type: ignore[call-overload]
    former = next((old for old, new in names.items() if new == name), name)
    place: Keys = ("modules", view.module, "rename", section, former)
    own = way(actual.root, ("modules", view.module, "set", section, name))
    if former == name and len(own) == 6 and section in ("frames", "actuators", "sensors") and _is_new(own[-1]):
        return
    yield Remove(place) if former == change.name else Put(place, change.name)


def _is_new(values: Tree) -> bool:
    """Whether values are those of an element that the description does not have: it says where it is."""
    known = {"link", "joint"}
    return isinstance(values, Values) and not known.isdisjoint(values.entries)
