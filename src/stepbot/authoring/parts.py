"""The parts of an assembly with the roles that their names and shapes indicate."""

from collections import defaultdict
from dataclasses import replace

import numpy as np

from stepbot.geometry.spatial import turn_inertia
from stepbot.step.assembly import Component

from .bearing_sizes import is_bearing
from .contacts import Contacts
from .names import Role, is_spoken, roles
from .part import Part
from .scene import Scene
from .screws import is_screw


def read_parts(scene: Scene, found: Contacts, *, use_names: bool) -> dict[int, Part]:
    """All parts by the index of their component."""
    lines_of: dict[int, list[int]] = defaultdict(list)
    for number, line in enumerate(found.lines):
        for index in line.faces:
            lines_of[index].append(number)
    parts = {}
    for index in scene.parts:
        part = _part(scene, index, use_names=use_names)
        lines = [found.lines[n] for n in lines_of[index]]
        if part.role is None and is_bearing(part, lines):
            part = replace(part, role=Role.BEARING)
        elif part.role is None and is_screw(part, lines, scene.body(index).faces):
            part = replace(part, role=Role.FASTENER)
        parts[index] = part
    return parts


def _part(scene: Scene, index: int, *, use_names: bool) -> Part:
    component, body = scene.component(index), scene.body(index)
    names = spoken_names(component)
    if not names and component.parent >= 0:
        names = spoken_names(scene.component(component.parent))
    found = tuple(dict.fromkeys(role for name in names for role in roles(name))) if use_names else ()
    box = scene.boxes.get(index, np.zeros((2, 3)))
    volume, com, inertia = 0.0, box.mean(axis=0), np.eye(3)
    if body.exact is not None:
        X, unit = component.X_WC, body.exact.unit_density
        volume, com = body.exact.volume, X.apply(unit.com)
        inertia = np.asarray(turn_inertia(X.R, np.array(unit.inertia)))
    size = float(np.linalg.norm(box[1] - box[0]))
    name = names[0] if names else ""
    return Part(
        *(index, component.path, name, found, next(iter(found), None), component.definition),
        *(volume, size, box, com, inertia),
    )


def spoken_names(component: Component) -> list[str]:
    """The meaningful names of a component."""
    return [name for name in (component.product, component.occurrence) if is_spoken(name)]
