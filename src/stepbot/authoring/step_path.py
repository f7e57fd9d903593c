"""The path of a STEP file in a sidecar."""

import os
from pathlib import Path


def relative_step(step: Path, sidecar: Path) -> str:
    """``step`` relative to the folder of ``sidecar``, with forward slashes; absolute if there is no relative path.

    Symbolic links in the folders are resolved, since ``..`` is relative to their target.
    """
    target = step.parent.resolve() / step.name
    try:
        relative = os.path.relpath(target, sidecar.parent.resolve())
    except ValueError:  # another Windows drive
        return target.as_posix()
    return Path(relative).as_posix()
