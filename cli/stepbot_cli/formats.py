"""``stepbot formats``: list the output formats."""

from typing import TYPE_CHECKING

import click

from .command import Command, json_option
from .terminal import write_json, write_result

if TYPE_CHECKING:
    from stepbot.formats import Writer


@click.command(cls=Command, short_help="List the output formats.", epilog="Example: stepbot formats --json")
@json_option
def command(as_json: bool) -> int:
    """List the output formats, with the limitations of each."""
    from stepbot.formats import FORMATS
    from stepbot.formats.lowering import Level

    if as_json:
        write_json({"formats": [_described(writer) for writer in FORMATS.values()]})
        return 0

    for name, writer in FORMATS.items():
        aliases = f", alias {', '.join(writer.ALIASES)}" if writer.ALIASES else ""
        write_result(f"{name:<6} {writer.TITLE}, <robot>{writer.SUFFIX}{aliases}")
        for level, title in (
            (Level.LOWERED, "written by other means"),
            (Level.REPORTED, "not written, with a diagnostic"),
        ):
            features = [feature.value for feature, support in writer.EXPRESSES.items() if support.level is level]
            if features:
                write_result(f"       {title}: {'; '.join(features)}")
    return 0


def _described(writer: "Writer") -> dict[str, object]:
    """A format as JSON."""
    features = {feature.value: {"level": s.level.value, "how": s.how} for feature, s in writer.EXPRESSES.items()}
    return {
        "name": writer.NAME,
        "title": writer.TITLE,
        "suffix": writer.SUFFIX,
        "aliases": list(writer.ALIASES),
        "notions": features,
    }
