"""Available memory."""

import os
from pathlib import Path

LEAST = 4 << 30
"""Address space [bytes] that a worker may always use: it includes libraries and reserved memory that is never
touched."""
_CONTAINER = (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"))
"""Files in which Linux states the memory limit of a container."""
_NOT_LOADED = ("failed to map segment from shared object", "Cannot allocate memory")


def memory_size() -> int | None:
    """Memory [bytes] of this machine or container, whichever is less; None if unknown."""
    try:
        size = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # Windows has no sysconf, some systems lack these names
        return None
    return min([size, *filter(None, map(_limit, _CONTAINER))]) if size > 0 else None


def worker_limit() -> int | None:
    """Default limit of a worker's address space [bytes]; None for no limit.

    Less than the available memory, because at its end the system kills arbitrary processes without a message.
    """
    size = memory_size()
    return None if size is None else max(size * 3 // 4, LEAST)


def is_out_of_memory(error: BaseException) -> bool:
    """Whether there was too little memory, for a library, too, which the system's loader states in an ImportError."""
    return isinstance(error, MemoryError) or (
        isinstance(error, ImportError) and any(words in str(error) for words in _NOT_LOADED)
    )


def _limit(file: Path) -> int:
    """The number in a file; 0 if there is none."""
    try:
        text = file.read_text(encoding="ascii").strip()
    except OSError:
        return 0
    return int(text) if text.isdecimal() else 0


DEFAULT_TIMEOUT = 600.0
"""Default time limit [s] of one call."""
