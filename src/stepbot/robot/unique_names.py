"""Unique names."""


def free_name(name: str, suffix: str, taken: set[str]) -> str:
    """``name``, with as many suffixes as needed to be unique; it is then added to the used names."""
    while name in taken:
        name += suffix
    taken.add(name)
    return name
