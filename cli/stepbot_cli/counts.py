"""Numbers of things in words."""


def counted(number: int, singular: str, plural: str = "") -> str:
    """``1 link``, ``2 links``, ``2 axes`` where ``plural`` is given."""
    return f"{number} {singular if number == 1 else plural or singular + 's'}"
