"""``stepbot doctor``: what of stepbot works on this machine."""

import sys
from pathlib import Path

import click
from msgspec.structs import asdict

from stepbot.diagnostics import counted

from .command import Command, json_option
from .diagnostic_text import paint, printable
from .reading import folder_option, opened
from .terminal import wants_color, write_json, write_result

_COLORS = {"ok": "32", "not installed": "2", "problem": "1;31"}
_AREAS = {
    "python": "Python",
    "kernel": "Geometry",
    "engine": "Engines",
    "extra": "Extras",
    "cache": "Cache",
    "limit": "Limits",
    "browser": "Browser",
}


@click.command(cls=Command, epilog="Example: stepbot doctor --json\n\nExit codes: 0 no problem, 1 problems.")
@click.option("--webgl", is_flag=True, help="Open a page in the browser, which reports whether it can draw robots.")
@folder_option
@json_option
def command(webgl: bool, cache: Path | None, as_json: bool) -> int:
    """Show what works on this machine: Python, geometry kernel, engines, extras, cache and limits.

    Each package is imported in a process of its own. What is not installed is listed with the command that installs it,
    and is no problem; a problem is listed with the command that fixes it.
    """
    from stepbot.jobs.health import OK, PROBLEM, examine

    kept = opened(cache)
    items = list(examine(kept))
    if webgl:
        from stepbot.serving.webgl import examine_webgl

        items.append(examine_webgl())
    problems = [item for item in items if item.state == PROBLEM]
    code = 1 if problems else 0
    if as_json:
        write_json({"items": [asdict(item) for item in items], "problems": len(problems), "exit_code": code})
        return code
    color, width = wants_color(sys.stdout), max(len(item.name) for item in items)
    area = ""
    for item in items:
        if item.area != area:
            area = item.area
            write_result(paint(_AREAS[area], "1", color))
        state = paint(f"{item.state:<13}", _COLORS[item.state], color)
        words = "  ".join(filter(None, (item.detail, item.purpose)))
        write_result(printable(f"  {item.name:<{width}}  ") + state + printable(f"  {words}").rstrip())
        if item.state != OK and item.fix:
            write_result(printable(f"  {'':<{width}}  {'':<13}  {item.fix}"))
    write_result(counted(len(problems), "problem") if problems else "no problems")
    return code
