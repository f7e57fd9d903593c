"""The name by which Gazebo finds a model: that of its folder. Commands import it, so nothing slow is imported here."""

import re
from collections.abc import Collection
from pathlib import Path

from stepbot.runtime.file import resolved

from . import FORMAT


def model_name(folder: Path, formats: Collection[str]) -> str:
    """The name of a folder in ``model://`` URIs.

    Raises:
        ValueError: The name has characters that a URI would have to escape, or there is no SDFormat.
    """
    if FORMAT.name not in formats:
        raise ValueError(f"the format {FORMAT.name} is not written")
    name = resolved(folder).name
    if not re.fullmatch(r"\w[\w.-]*", name, flags=re.ASCII):
        raise ValueError(f"a folder named '{name}' cannot be a Gazebo model: ASCII letters, digits and _ . - only")
    return name
