"""What the page shows of a sidecar's text: values, their lines, and what is left to decide, the most decisive first.

A sidecar that changes an existing description has one module, whose values are edited as if they were its own: the page
gets all values of the robot, and what it changes is written under `set` and `rename` of the module.
"""

import re
from collections import defaultdict
from collections.abc import Container, Iterator
from typing import Any

from msgspec import Struct
from msgspec.structs import replace

from stepbot.compose.changing import CHANGEABLE, sidecar_of
from stepbot.diagnostics import Diagnostics
from stepbot.draft.text.densities import typical_densities
from stepbot.pipeline.conversion import is_description
from stepbot.report.plain import Json
from stepbot.robot.model import Module, Robot
from stepbot.runtime.robot_library import LIBRARY
from stepbot.sidecar.draft_comments import DraftedFused, drafted_actuators, drafted_fused, drafted_questions, reviews
from stepbot.sidecar.editing import Annotate, Append, Change, Put, Remove, Rename
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.motors import catalogue_names
from stepbot.sidecar.schema import json_schema
from stepbot.sidecar.tree import SECTIONS, Keys, Mapping, Tree, entries_of, last_line, plain_data, scalars, value_at
from stepbot.sidecar.variants import merged

from .local_server import Refused

_OF_STEP = ("step", "root", "materials", "defaults", "parts", "mass", "step_density", "step_encoding", "closures")
_STAY = ("assign", "add_joint", "add_closure", "remove_joint", "merge", "root", "origin", "confirm")
"""Actions on the tree of links, which is that of the description."""


class EditedSidecar(Struct, frozen=True):
    """A sidecar as the page edits it."""

    sidecar: Sidecar
    own: Tree
    """The values that are written in the file, under the keys that the page has for them."""
    module: str = ""
    """The module whose description it changes; empty for a sidecar of a STEP file or of several modules."""
    source: str = ""
    """Name of the description."""


def edited_view(sidecar: Sidecar, robot: Robot | None) -> EditedSidecar:
    """The sidecar with all values of the description that it changes; any other one as it is."""
    named = list(sidecar.document.modules.items())
    if robot is None or sidecar.document.links or len(named) != 1:
        return EditedSidecar(sidecar, sidecar.root)
    module, section = named[0]
    source = section.file or ""
    if section.prefix != "" or section.mirror or not is_description(sidecar.path.parent / source):
        return EditedSidecar(sidecar, sidecar.root)
    given = value_at(sidecar.root, ("modules", module, "set"))
    changes = given if isinstance(given, Mapping) else None
    base = sidecar_of(robot, changes, sidecar.path.parent / source, diagnostics := Diagnostics())
    if base is None:
        raise Refused(next((diagnostic.message for diagnostic in diagnostics), "the description cannot be edited"))
    assert isinstance(sidecar.root, Mapping)
    entries = {key: entry for key, entry in sidecar.root.entries.items() if key != "modules"}
    entries |= {} if changes is None else changes.entries
    own = replace(sidecar.root, entries=entries)
    root = merged(base.root, own)
    return EditedSidecar(replace(base, path=sidecar.path, text=sidecar.text, root=root), own, module, source)


def require_editable(view: EditedSidecar, robot: Robot | None, question: Json) -> None:
    """Refuse edits of a description's tree of links, and of elements of a module, whose own file is named."""
    edits = question.get("edits")
    for edit in edits if isinstance(edits, list) else [question]:
        if view.module and isinstance(edit, dict) and edit.get("action") in _STAY:
            raise Refused(f"the tree of links is that of '{view.source}', which stays as it is")
        for section, name in _subjects(edit):
            own = getattr(view.sidecar.document, section)
            module = None if robot is None or name in own else _module_of(robot, section, name)
            if module is not None:
                command = module_command(view.sidecar, module)
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
    link = name if section == "links" else next((joint.child for joint in robot.joints if joint.name == name), "")
    return next((module for module in reversed(robot.modules) if link in module.links), None)


def in_file(actual: Sidecar, view: EditedSidecar, changes: list[Change], question: Json) -> list[Change]:
    """Changes of a view as changes of the file."""
    return list(_in_file(actual, view, changes, str(question.get("action")))) if view.module else changes


def _in_file(actual: Sidecar, view: EditedSidecar, changes: list[Change], action: str) -> Iterator[Change]:
    for change in changes:
        keys = _placed(view, change.keys)
        is_there = value_at(actual.root, keys) is not None
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


def _placed(view: EditedSidecar, keys: Keys) -> Keys:
    if keys[0] in _OF_STEP:
        raise Refused(f"`{keys[0]}` requires a STEP file; '{view.source}' is not one")
    if keys[0] in CHANGEABLE:
        return ("modules", view.module, "set", *keys)
    return keys


def _renamed(actual: Sidecar, view: EditedSidecar, change: Rename) -> Iterator[Change]:
    section, name = str(change.keys[0]), str(change.keys[1])
    if section == "joint_defaults":
        return
    names: dict[str, str] = dict(actual.document.modules[view.module].rename).get(section, {})  # type: ignore[call-overload]
    former = next((old for old, new in names.items() if new == name), name)
    place: Keys = ("modules", view.module, "rename", section, former)
    own = value_at(actual.root, ("modules", view.module, "set", section, name))
    # One that states where it is is not in the description.
    is_new = isinstance(own, Mapping) and not {"link", "joint"}.isdisjoint(own.entries)
    if former == name and section in ("frames", "actuators", "sensors") and is_new:
        return
    yield Remove(place) if former == change.name else Put(place, change.name)


_PLACEHOLDERS = ("SB463", "SB522")
_AXIS = "SB407"
_PLACES = {"root": 1, "base": 1, "links": 3, "joints": 4, "closures": 4, "actuators": 5, "defaults": 6, "parts": 6}
"""What is decided before what: which link stands, which parts move as one, how they move, what they weigh."""
_FIRST, _FRICTION, _LATER = 0, 7, 8
_CONTACT = re.compile(r"\bcontact: \S")


def written(view: EditedSidecar, scene: Json) -> Json:
    """``{data, lines, places, decisions, described}``: values, text, lines of keys, what is left to decide, source."""
    sidecar = replace(view.sidecar, root=view.own)
    places = [(list(keys), first, last) for keys, first, last in _places(sidecar.root)]
    return {
        "data": plain_data(view.sidecar.root),
        "lines": sidecar.text.split("\n"),
        "places": places,
        "decisions": decisions(sidecar, scene),
        "described": view.source,
    }


def decisions(sidecar: Sidecar, scene: Json) -> list[Json]:
    """What is left to decide; what is asked of several elements alike is one decision with several places.

    Each is ``{kind, keys, text, help, code, rank}``: ``keys`` lists the places of all elements that it is about.
    ``kind`` is ``question`` for those of `init --interactive`, ``axis`` for a joint on weak evidence, ``review`` for
    another mark of the draft, ``todo`` for a placeholder, ``fused`` for parts that look movable, ``motor`` for
    actuators in comments of the draft, ``finding`` for a diagnostic.
    """
    open_questions = [*_questions(sidecar), *_axes(scene)]
    about = {tuple(keys) for question in open_questions for keys in question["keys"]}
    open_questions += _marks(sidecar, about)
    about |= {tuple(keys) for question in open_questions for keys in question["keys"]}
    todo = [keys for keys, one in scalars(sidecar.root) if one.value == "todo"]
    kinds = {name: joint.type.value for name, joint in sidecar.document.joints.items()}
    places: dict[tuple[Any, ...], list[Keys]] = defaultdict(list)
    for keys in todo:
        if keys[:1] not in about:
            is_joint = keys[0] == "joints" and len(keys) == 3
            places[(kinds.get(str(keys[1])), keys[2]) if is_joint else keys].append(keys)
    open_questions += [_decision("todo", equal, str(equal[0][-1])) for equal in places.values()]
    open_questions += [*_fused(sidecar), *_motors(sidecar)]
    listed = about | {keys[:2] for keys in todo}
    alike: dict[tuple[Any, ...], Json] = {}
    for one in scene.get("diagnostics", ()):
        keys = _keys_at(sidecar, one["line"]) if one["file"] == sidecar.path.name else ()
        is_listed = (one["code"] == _AXIS and keys in listed) or one["code"] in _PLACEHOLDERS
        if one["severity"] == "note" or is_listed:
            continue
        is_error = one["severity"] == "error"
        here = [keys] if keys else []
        made = _decision("finding", here, one["message"], one, 0 if is_error else _LATER)
        first = alike.setdefault((one["code"], bool(keys), tuple(one["help"]), len(alike) if is_error else 0), made)
        if first is made:
            open_questions.append(made)
        else:
            first["text"] += f"\n{one['message']}"
            first["keys"] += [list(keys)] if keys and list(keys) not in first["keys"] else []
    return sorted(
        open_questions, key=lambda question: (question["rank"], question["kind"] == "todo", -len(question["keys"]))
    )


def _questions(sidecar: Sidecar) -> Iterator[Json]:
    """The questions of the draft, which decide most: all of them are one decision, with the answer of the draft."""
    if asked := drafted_questions(sidecar.text):
        questions = [
            {"name": one.name, "text": one.text, "drafted": one.drafted, "others": one.others} for one in asked
        ]
        yield {**_decision("question", [], "", rank=_FIRST), "questions": questions}


def _axes(scene: Json) -> Iterator[Json]:
    """Joints and closures on weak evidence; those of one type and one doubt together, as six equal motors are."""
    groups: dict[tuple[Any, ...], list[Keys]] = defaultdict(list)
    for one in scene.get("connections", ()):
        if one["doubt"]:
            section = "closures" if one["closes"] else "joints"
            groups[section, one["kind"], one["doubt"]].append((section, one["name"]))
    for (_, kind, doubt), keys in groups.items():
        yield _decision("axis", keys, f"{kind}: {doubt}")


def _marks(sidecar: Sidecar, about: Container[Keys]) -> Iterator[Json]:
    """Other REVIEW marks: all those of an element together, since an answer settles all of them."""
    lines = sidecar.text.split("\n")
    marks: dict[Keys, list[tuple[str, bool]]] = defaultdict(list)
    for line, text in reviews(sidecar.text):
        if (keys := _keys_at(sidecar, line)) and keys not in about:
            marks[keys].append((text, _CONTACT.search(lines[line - 1]) is not None))
    equal: dict[tuple[Any, ...], list[Keys]] = defaultdict(list)
    for keys, texts in marks.items():
        of_contact = all(is_contact for _, is_contact in texts)
        equal[keys[0], of_contact, "; ".join(dict.fromkeys(text for text, _ in texts))].append(keys)
    for (_, of_contact, text), places in equal.items():
        yield _decision("review", places, text, rank=_FRICTION if of_contact else None)


def _fused(sidecar: Sidecar) -> Iterator[Json]:
    """Parts that look movable; those of one type that the same holds together."""
    groups: dict[tuple[str, str], list[DraftedFused]] = defaultdict(list)
    for one in drafted_fused(sidecar.text):
        groups[str(one.values.get("type")), one.held.rpartition(": ")[2]].append(one)
    for (kind, _), fused in groups.items():
        text = "\n".join(f"{one.held}. Or {kind}, score {one.score}" for one in fused)
        keys: list[Keys] = [("parts", one.parts[0]) for one in fused]
        yield _decision("fused", keys, text, rank=_PLACES["joints"])


def _motors(sidecar: Sidecar) -> Iterator[Json]:
    groups: dict[tuple[Any, ...], list[Keys]] = defaultdict(list)
    for actuator in drafted_actuators(sidecar.text):
        if actuator.joint in sidecar.document.joints:
            groups[actuator.models, actuator.review].append(("joints", actuator.joint))
    for (models, review), keys in groups.items():
        yield {**_decision("motor", keys, review, rank=_PLACES["actuators"]), "models": list(models)}


def vocabulary() -> Json:
    """``{schema, motors, densities}``: what the page makes its forms from, and suggests in their fields."""
    return {"schema": json_schema(), "motors": list(catalogue_names()), "densities": typical_densities()}


def _decision(kind: str, keys: list[Keys], text: str, finding: Json | None = None, rank: int | None = None) -> Json:
    first = str(keys[0][0]) if keys else ""
    rank = _PLACES.get(first, _LATER) if rank is None else rank
    extra = {"help": [], "code": "", "severity": ""} if finding is None else {key: finding[key] for key in _FINDING}
    return {"kind": kind, "keys": [list(key) for key in keys], "text": text, "rank": rank, **extra}


_FINDING = ("help", "code", "severity")


def _places(root: Tree) -> Iterator[tuple[Keys, int, int]]:
    """Sections and their entries, with their first and last line."""
    for key, entry in entries_of(root).items():
        yield (key,), entry.key_span.line, last_line(entry.value)
        for name, one in entries_of(entry.value).items():
            yield (key, name), one.key_span.line, last_line(one.value)


def _keys_at(sidecar: Sidecar, line: int) -> Keys:
    """The element on a line: an entry of a section of elements, else the section; empty for none."""
    innermost: Keys = ()
    for keys, first, last in _places(sidecar.root):
        if first <= line <= last and (len(keys) == 1 or keys[0] in SECTIONS):
            innermost = keys
    return innermost
