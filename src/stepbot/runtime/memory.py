"""Available memory."""

import os
from pathlib import Path

LEAST = 4 << 30
"""Address space [bytes] that a worker may always take: it counts libraries and reserves that are never touched."""
_CONTAINER = (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"))
"""Where Linux tells what a container may take."""


def memory_size() -> int | None:
    """Memory [bytes] of this machine, or of the container that has less; None where the system does not tell."""
    try:
        size = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # Windows has no sysconf, some systems not these names
        return None
    return min([size, *filter(None, map(_limit, _CONTAINER))]) if size > 0 else None


def worker_limit() -> int | None:
    """Address space [bytes] that a worker may take if nobody says otherwise; None for no limit.

    Less than there is: at the very end it is the system that chooses what to kill, and without a word.
    """
    size = memory_size()
    return None if size is None else max(size * 3 // 4, LEAST)


def _limit(file: Path) -> int:
    """The number in a file; 0 where there is none."""
    try:
        text = file.read_text(encoding="ascii").strip()
    except OSError:
        return 0
    return int(text) if text.isdecimal() else 0
