"""``stepbot view``: show a robot in a browser."""

import threading
import webbrowser
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics, Span

from .caching import say_trouble
from .command import Command, display_options, json_option
from .progress import progress_bar
from .reading import reading_options
from .terminal import Display, show_diagnostics, write_json, write_result

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options


@click.command(
    cls=Command,
    short_help="Show a robot in a browser.",
    epilog="Example: stepbot view arm.robot.yaml",
)
@click.argument("target", metavar="TARGET", type=click.Path(path_type=Path))
@click.option("--no-open", is_flag=True, help="Print the address and do not open a browser.")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, metavar="N", help="Port; the default is any free one."
)
@click.option("--no-verify", is_flag=True, help="Do not load the files in engines.")
@reading_options
@json_option
@display_options
def command(
    options: "Options",
    target: Path,
    no_open: bool,
    port: int,
    no_verify: bool,
    as_json: bool,
    display: Display,
) -> int:
    """Show a robot in a browser: links, joints to move, masses, collision shapes, verification.

    TARGET is a sidecar, a STEP file, or any URDF, SDFormat or MJCF file.

    The page is served on this machine only (127.0.0.1), at an address with a random token; it loads nothing from a
    network. Nothing is written. A STEP file is shown with the joints that `stepbot init` would draft. Ctrl-C ends it.
    """
    from stepbot.serving.session import Session

    found = Diagnostics()
    try:
        session = Session(target, replace(options, verify=not no_verify), port=port)
    except OSError as error:
        found.add("SB019", f"port {port}: {error.strerror}", Span("stepbot"))
        return _say(found, "", as_json, display)
    try:
        with progress_bar(("read",)) as progress:
            progress("read")
            shown = session.load()
        say_trouble(options.cache, shown.diagnostics)
        if shown.scene is None:
            return _say(shown.diagnostics, "", as_json, display)
        session.server.start()
        _say(shown.diagnostics, session.server.url, as_json, display)
        if not no_open:
            webbrowser.open(session.server.url)
        session.guess()
        if not no_verify:
            session.prove()
        threading.Event().wait()
    except KeyboardInterrupt:
        return 0
    finally:
        session.close()
    return 0


def _say(found: Diagnostics, url: str, as_json: bool, display: Display) -> int:
    """Print diagnostics and the address of the page; returns the exit code."""
    if as_json:
        write_json({"url": url, "diagnostics": found, "exit_code": found.exit_code})
    else:
        show_diagnostics(found, display)
        if url:
            write_result(url)
    return found.exit_code
