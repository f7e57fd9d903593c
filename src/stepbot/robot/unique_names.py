"""Names that are like no other."""


def free_name(name: str, suffix: str, taken: set[str]) -> str:
    """``name``, with as many suffixes as it takes to be like no other; it is taken from then on."""
    while name in taken:
        name += suffix
    taken.add(name)
    return name
