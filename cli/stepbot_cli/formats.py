"""``stepbot formats``: list the output formats."""

import sys
import textwrap
from typing import TYPE_CHECKING

import click

from .command import Command, json_option
from .terminal import WIDEST_TEXT, screen_width, write_json, write_result

if TYPE_CHECKING:
    from stepbot.formats import Format

_INDENT = " " * 7
_MADE_FROM_THEM = (
    "`stepbot convert --ros2 NAME` makes the folder a ROS 2 package: URDF, xacro, launch files, ros2_control, MoveIt",
    "`stepbot convert --gazebo` makes the folder a Gazebo model: SDFormat, model.config",
    "`import stepbot.gym` makes Gymnasium environments from an MJCF (`stepbot docs learning`)",
)


@click.command(cls=Command, epilog="Example: stepbot formats --json")
@json_option
def command(as_json: bool) -> int:
    """List the output formats, with the limitations of each, and what is made from them."""
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
                write_result("\n".join(_wrapped(f"{title}: {'; '.join(features)}")))
    write_result("")
    for what in _MADE_FROM_THEM:
        write_result("\n".join(_wrapped(what, "", "  ")))
    return 0


def _wrapped(text: str, first: str = _INDENT, further: str = f"{_INDENT}  ") -> list[str]:
    """Lines as wide as the screen; 100 characters for a pipe."""
    width = screen_width(sys.stdout) or WIDEST_TEXT
    return textwrap.wrap(text, width, initial_indent=first, subsequent_indent=further, break_on_hyphens=False)


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
