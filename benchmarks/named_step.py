"""The STEP file that the text of a sidecar names, without the sidecar's reader."""

import re

NAMED = re.compile(r"^step: *[\"']?([^\"'#\n]+?)[\"']? *(?:#.*)?$", re.MULTILINE)


def named_step(text: str) -> str | None:
    """The path as written; None without one."""
    found = NAMED.search(text)
    return None if found is None else found[1].strip()
