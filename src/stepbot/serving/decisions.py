"""What the page shows of a sidecar's text: values, their lines, and what is left to decide, the most decisive first."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from stepbot.draft.text.densities import typical_densities
from stepbot.sidecar.draft_comments import drafted_actuators, reviews
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.motors import catalogue_names
from stepbot.sidecar.schema import json_schema
from stepbot.sidecar.subjects import SECTIONS
from stepbot.sidecar.tree import Keys, Listing, Mapping, Scalar, Tree, last_line, plain_data

from .described import Edited
from .questions import Json

_PLACEHOLDERS = ("SB463", "SB522")
_AXIS = "SB407"
_PLACES = {"root": 1, "base": 1, "links": 3, "joints": 4, "closures": 4, "actuators": 5, "defaults": 6, "parts": 6}
"""What is decided before what: which link stands, which parts move as one, how they move, what they weigh."""
_LATER = 7


def written(view: Edited, scene: Json) -> Json:
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
    ``kind`` is ``axis`` for a joint on weak evidence, ``review`` for another mark of the draft, ``todo`` for a
    placeholder, ``motor`` for actuators in comments of the draft, ``finding`` for a diagnostic.
    """
    found = [*_axes(scene)]
    about = {tuple(keys) for one in found for keys in one["keys"]}
    marks: dict[tuple[str, str], list[Keys]] = defaultdict(list)
    for line, text in reviews(sidecar.text):
        keys = _keys_at(sidecar, line)
        if keys and keys not in about:
            marks[str(keys[0]), text].append(keys)
            about.add(keys)
    found += [_decision("review", equal, text) for (_, text), equal in marks.items()]
    todo = [keys for keys, value in _scalars(sidecar.root, ()) if value == "todo"]
    kinds = {name: joint.type.value for name, joint in sidecar.document.joints.items()}
    places: dict[tuple[Any, ...], list[Keys]] = defaultdict(list)
    for keys in todo:
        if keys[:1] not in about:
            is_joint = keys[0] == "joints" and len(keys) == 3
            places[(kinds.get(str(keys[1])), keys[2]) if is_joint else keys].append(keys)
    found += [_decision("todo", equal, str(equal[0][-1])) for equal in places.values()]
    found += _motors(sidecar)
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
            found.append(made)
        else:
            first["text"] += f"\n{one['message']}"
            first["keys"] += [list(keys)] if keys and list(keys) not in first["keys"] else []
    return sorted(found, key=lambda one: (one["rank"], one["kind"] == "todo", -len(one["keys"])))


def _axes(scene: Json) -> Iterator[Json]:
    """Joints and closures on weak evidence; those of one type and one doubt together, as six equal motors are."""
    groups: dict[tuple[Any, ...], list[Keys]] = defaultdict(list)
    for one in scene.get("connections", ()):
        if one["doubt"]:
            section = "closures" if one["closes"] else "joints"
            groups[section, one["kind"], one["doubt"]].append((section, one["name"]))
    for (_, kind, doubt), keys in groups.items():
        yield _decision("axis", keys, f"{kind}: {doubt}")


def _motors(sidecar: Sidecar) -> Iterator[Json]:
    groups: dict[tuple[Any, ...], list[Keys]] = defaultdict(list)
    for one in drafted_actuators(sidecar.text):
        if one.joint in sidecar.document.joints:
            groups[one.models, one.review].append(("joints", one.joint))
    for (models, review), keys in groups.items():
        yield {**_decision("motor", keys, review, rank=_PLACES["actuators"]), "models": list(models)}


def vocabulary() -> Json:
    """``{schema, motors, densities}``: what the page makes its forms from, and suggests in their fields."""
    return {"schema": json_schema(), "motors": list(catalogue_names()), "densities": typical_densities()}


def _decision(kind: str, keys: list[Keys], text: str, finding: Json | None = None, rank: int | None = None) -> Json:
    first = str(keys[0][0]) if keys else ""
    rank = _PLACES.get(first, _LATER) if rank is None else rank
    extra = {"help": [], "code": "", "severity": ""} if finding is None else {key: finding[key] for key in _FINDING}
    return {"kind": kind, "keys": [list(one) for one in keys], "text": text, "rank": rank, **extra}


_FINDING = ("help", "code", "severity")


def _places(root: Tree) -> Iterator[tuple[Keys, int, int]]:
    """Sections and their entries, with their first and last line."""
    for key, entry in root.entries.items() if isinstance(root, Mapping) else ():
        yield (key,), entry.key_span.line, last_line(entry.value)
        if isinstance(entry.value, Mapping):
            for name, one in entry.value.entries.items():
                yield (key, name), one.key_span.line, last_line(one.value)


def _keys_at(sidecar: Sidecar, line: int) -> Keys:
    """The element on a line: an entry of a section of elements, else the section; empty for none."""
    found: Keys = ()
    for keys, first, last in _places(sidecar.root):
        if first <= line <= last and (len(keys) == 1 or keys[0] in SECTIONS):
            found = keys
    return found


def _scalars(tree: Tree, keys: Keys) -> Iterator[tuple[Keys, Any]]:
    if isinstance(tree, Scalar):
        yield keys, tree.value
    elif isinstance(tree, Listing):
        for index, value in enumerate(tree.values):
            yield from _scalars(value, (*keys, index))
    else:
        for key, entry in tree.entries.items():
            yield from _scalars(entry.value, (*keys, key))
