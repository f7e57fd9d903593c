"""Options of the commands that read STEP files: code page, limits and cache."""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

from .caching import cache_options, opened
from .encodings import encoding_option
from .engines import limit_options


def working_options(command: Callable[..., int]) -> Callable[..., int]:
    """Add the limits of workers and the cache; the command receives both as ``options`` and adds its own."""

    @wraps(command)
    def with_options(
        *,
        timeout: float,
        memory_limit: int | None,
        cache: Path | None,
        no_cache: bool,
        encoding: str = "",
        **others: Any,
    ) -> int:
        from stepbot.pipeline.conversion import Options

        options = Options(
            output=Path(),
            encoding=encoding,
            timeout=timeout,
            memory_limit=memory_limit,
            cache=opened(cache, no_cache),
        )
        return command(options=options, **others)

    return limit_options(cache_options(with_options))


def reading_options(command: Callable[..., int]) -> Callable[..., int]:
    """The same, and the code page of STEP files."""
    return encoding_option(working_options(command))
