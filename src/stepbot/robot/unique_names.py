"""Unique names, and names of their parts."""

SCOPE = "::"
"""Between the name of an element and those of its parts in a file: no name of a robot contains it.

dm_control rejects a slash in names of MJCF.
"""


def free_name(name: str, suffix: str, taken: set[str]) -> str:
    """``name``, with as many suffixes as needed to be unique; it is then added to the used names."""
    while name in taken:
        name += suffix
    taken.add(name)
    return name
