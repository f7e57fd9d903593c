"""``stepbot cache``: show or clear the cache."""

from pathlib import Path

import click

from .application import Group
from .command import Command, json_option
from .reading import folder_option, in_words, opened
from .terminal import write_json, write_result


@click.group(cls=Group, epilog="Example: stepbot cache info")
def command() -> None:
    """Show or clear the cache. Results are cached by the hash of all their inputs, so outdated results are never used.

    Clearing the cache is always safe. STEPBOT_CACHE sets the folder and STEPBOT_CACHE_SIZE the size limit, such as
    500M. STEPBOT_NO_CACHE=1 disables the cache.
    """


@command.command(
    "info", cls=Command, short_help="Show location and size of the cache.", epilog="Example: stepbot cache info --json"
)
@folder_option
@json_option
def info(cache: Path | None, as_json: bool) -> int:
    """Print the folder, number of entries, size and size limit."""
    kept = opened(cache)
    usage = kept.usage()
    if as_json:
        write_json(
            {"folder": kept.folder.as_posix(), "entries": usage.entries, "size": usage.size, "limit": kept.limit}
        )
    else:
        write_result(f"folder   {kept.folder}\nentries  {usage.entries}")
        write_result(f"size     {in_words(usage.size)} of {in_words(kept.limit)}")
    return 0


@command.command("clear", cls=Command, short_help="Remove all entries.", epilog="Example: stepbot cache clear")
@folder_option
@json_option
def clear(cache: Path | None, as_json: bool) -> int:
    """Remove all cache entries. Other files in the folder are kept."""
    kept = opened(cache)
    removed = kept.clear()
    if as_json:
        write_json({"folder": kept.folder.as_posix(), "entries": removed.entries, "size": removed.size})
    else:
        write_result(f"{removed.entries} entries, {in_words(removed.size)}, removed from {kept.folder}")
    return 0
