"""``stepbot formats``: list the output formats."""

import sys
import textwrap
from typing import TYPE_CHECKING

import click

from .command import Command, json_option
from .terminal import screen_width, write_json, write_result

if TYPE_CHECKING:
    from stepbot.formats import Format

_INDENT = " " * 7


@click.command(cls=Command, epilog="Example: stepbot formats --json")
@json_option
def command(as_json: bool) -> int:
    """List the output formats, with the limitations of each."""
    from stepbot.formats import FORMATS
    from stepbot.formats.features import Level

    if as_json:
        write_json({"formats": [_described(written) for written in FORMATS.values()]})
        return 0

    for name, written in FORMATS.items():
        aliases = f", alias {', '.join(written.aliases)}" if written.aliases else ""
        write_result(f"{name:<6} {written.title}, <robot>{written.suffix}{aliases}")
        for level, title in (
            (Level.LOWERED, "written by other means"),
            (Level.REPORTED, "not written, with a diagnostic"),
        ):
            features = [feature.value for feature, support in written.expresses.items() if support.level is level]
            if features:
                write_result("\n".join(_indented(f"{title}: {'; '.join(features)}")))
    return 0


def _indented(text: str) -> list[str]:
    """Lines as wide as the screen; one line for a pipe."""
    width = screen_width(sys.stdout)
    if width is None:
        return [_INDENT + text]
    return textwrap.wrap(text, width, initial_indent=_INDENT, subsequent_indent=_INDENT + "  ", break_on_hyphens=False)


def _described(written: "Format") -> dict[str, object]:
    """A format as JSON."""
    features = {feature.value: {"level": s.level.value, "how": s.how} for feature, s in written.expresses.items()}
    return {
        "name": written.name,
        "title": written.title,
        "suffix": written.suffix,
        "aliases": list(written.aliases),
        "notions": features,
    }
