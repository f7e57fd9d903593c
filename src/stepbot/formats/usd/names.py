"""Prim names: identifiers, unique among siblings; a prim keeps a name that is not one as its ``displayName``."""

import re
from collections.abc import Iterable

from stepbot.robot.mesh_names import free_name

from .usda import Prim, quoted

_OTHER = re.compile(r"[^A-Za-z0-9_]")


class Names:
    """The names of the children of one prim."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)

    def of(self, name: str) -> str:
        """An identifier for a name, unique among those that were given."""
        plain = _OTHER.sub("_", name)
        return free_name(plain if not plain[:1].isdigit() else f"_{plain}", "_", self._taken)


def named(type_: str, name: str, names: Names, identifier: str = "") -> Prim:
    """A prim with a name of the robot.

    Args:
        type_: Type of the prim.
        name: Its name in the robot.
        names: Names of its siblings.
        identifier: Its identifier, if it has one already.
    """
    prim = Prim(type_, identifier or names.of(name))
    if prim.name != name:
        prim.metadata.append(f"displayName = {quoted(name)}")
    return prim
