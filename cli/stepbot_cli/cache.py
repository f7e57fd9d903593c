"""``stepbot cache``: what is kept, and how to be rid of it."""

from pathlib import Path

import click

from .caching import folder_option, opened
from .command import Command, Group, json_option
from .sizes import in_words
from .terminal import write_json, write_result


@click.group(cls=Group, short_help="Show or clear the results that are kept.", epilog="Example: stepbot cache info")
def command() -> None:
    """Results are kept by the content of everything that they depend on, so a stale one is never used.

    To clear the cache costs time, nothing else. STEPBOT_CACHE names the folder, STEPBOT_CACHE_SIZE its limit, such as
    500M; STEPBOT_NO_CACHE=1 switches it off.
    """


@command.command(
    "info", cls=Command, short_help="Where the cache is, and how large.", epilog="Example: stepbot cache info --json"
)
@folder_option
@json_option
def info(cache: Path | None, as_json: bool) -> int:
    """Print folder, entries, size and limit."""
    kept = opened(cache)
    assert kept is not None  # not switched off
    usage = kept.usage()
    if as_json:
        write_json(
            {"folder": kept.folder.as_posix(), "entries": usage.entries, "size": usage.size, "limit": kept.limit}
        )
    else:
        write_result(f"folder   {kept.folder}\nentries  {usage.entries}")
        write_result(f"size     {in_words(usage.size)} of {in_words(kept.limit)}")
    return 0


@command.command("clear", cls=Command, short_help="Remove all that is kept.", epilog="Example: stepbot cache clear")
@folder_option
@json_option
def clear(cache: Path | None, as_json: bool) -> int:
    """Remove all entries, and nothing else in the folder."""
    kept = opened(cache)
    assert kept is not None  # not switched off
    removed = kept.clear()
    if as_json:
        write_json({"folder": kept.folder.as_posix(), "entries": removed.entries, "size": removed.size})
    else:
        write_result(f"{removed.entries} entries, {in_words(removed.size)}, removed from {kept.folder}")
    return 0
