"""The path of a STEP file as a sidecar names it."""

import os
from pathlib import Path


def relative_step(step: Path, sidecar: Path) -> str:
    """``step`` relative to the folder of ``sidecar``, with forward slashes; absolute where no relative path leads.

    Symbolic links in the folders are followed, since ``..`` leads out of what they point to.
    """
    target = step.parent.resolve() / step.name
    try:
        relative = os.path.relpath(target, sidecar.parent.resolve())
    except ValueError:  # another drive
        return target.as_posix()
    return Path(relative).as_posix()
