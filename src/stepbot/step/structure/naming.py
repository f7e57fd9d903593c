"""Canonical names of components, printed by `inspect` and matched by a sidecar's paths.

The segment of a component is the name of its product. Among siblings with an equal one it is the name of the
occurrence, if that is unique and not generated, else the product's name with ``#n`` in file order. If neither product
nor occurrence has a name of its own the segment is ``body``. Save counters (`` v12``) are not part of a name.
"""

import re
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from ..assembly import ROOT_PATH
from .paths import escape, plain_name

BODY = "body"
"""Segment of an unnamed component."""

_GENERIC = frozenset({"SOLID", "SHELL", "COMPOUND", "COMPSOLID", "ASSEMBLY", "FACE", "WIRE", "EDGE", "VERTEX"})
_MACHINE_MADE = re.compile(
    r"NAUO\d*|\d+|ID ?#\d+|\*DIT\d+|=>\[[\d:]*\]|#\d+|[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}"
    r"|Open CASCADE STEP translator [\d. ]+",
    re.IGNORECASE,
)


class NamedComponent(NamedTuple):
    """The inputs of a component's path."""

    parent: int
    """Index of the component above; -1 for the root, which comes first."""
    product: str
    occurrence: str


class ComponentName(NamedTuple):
    """The canonical name of a component."""

    segment: str
    path: str
    ordinal: int
    """n among the siblings with an equal name, from 1 in file order."""
    by_ordinal_only: bool
    """Whether only ``#n`` distinguishes it from a sibling."""


def is_machine_made(occurrence: str) -> bool:
    """Whether a name is empty, or was numbered by a program rather than given by a person."""
    name = occurrence.strip()
    return not name or name in _GENERIC or _MACHINE_MADE.fullmatch(name) is not None


def is_generic(product: str) -> bool:
    """Whether a product's name only states the type of shape."""
    name = product.strip()
    return not name or name in _GENERIC


def base_name(product: str, occurrence: str) -> str:
    """The name of a component before siblings are distinguished."""
    if not is_generic(product):
        return plain_name(product)
    if not is_machine_made(occurrence):
        return plain_name(occurrence)
    return BODY


def assign_paths(components: Sequence[NamedComponent]) -> list[ComponentName]:
    """Canonical segments and paths; unique by construction.

    Args:
        components: The root first, every component after its parent, siblings in file order.
    """
    below: dict[int, list[int]] = {}
    for index, component in enumerate(components):
        below.setdefault(component.parent, []).append(index)
    names: list[ComponentName] = [ComponentName(ROOT_PATH, ROOT_PATH, 1, False)] * len(components)
    for parent, siblings in below.items():  # in the order of their parents: a parent's path is known before it is used
        if parent >= 0:
            prefix = "" if components[parent].parent < 0 else names[parent].path + "/"
            for index, name in zip(siblings, _name_siblings([components[i] for i in siblings], prefix), strict=True):
                names[index] = name
    return names


def _name_siblings(siblings: Sequence[NamedComponent], prefix: str) -> list[ComponentName]:
    """Names of components with the same parent, whose path is the prefix."""
    bases = [base_name(sibling.product, sibling.occurrence) for sibling in siblings]
    occurrences = [plain_name(sibling.occurrence) for sibling in siblings]
    # An occurrence's name is used only if no sibling has the same name.
    answers = Counter([*bases, *(o for o, b in zip(occurrences, bases, strict=True) if o != b)])
    sharing = Counter(bases)
    escaped = {base: escape(base) for base in sharing}
    seen: Counter[str] = Counter()
    names = []
    for base, occurrence in zip(bases, occurrences, strict=True):
        seen[base] += 1
        by_ordinal = False
        if sharing[base] == 1:
            segment = escaped[base]
        elif occurrence != base and answers[occurrence] == 1 and not is_machine_made(occurrence):
            segment = escape(occurrence)
        else:
            segment, by_ordinal = f"{escaped[base]}#{seen[base]}", True
        names.append(ComponentName(segment, prefix + segment, seen[base], by_ordinal))
    return names
