"""Names of STEP files."""

import re

_STEP = re.compile(r"\.(stp|step|p21)(z|\.z|\.gz|\.zip)?$", re.IGNORECASE)


def is_step_name(name: str) -> bool:
    """Whether a file is a STEP file by its name, compressed or not."""
    return _STEP.search(name) is not None


def step_stem(name: str) -> str:
    """Name of a STEP file without its suffixes: ``arm`` for ``arm.step``, ``arm.stpZ`` and ``arm.stp.gz``."""
    stem = _STEP.sub("", name)
    return stem if stem != name else name.rpartition(".")[0] or name
