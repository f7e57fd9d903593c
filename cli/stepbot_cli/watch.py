"""``stepbot watch``: show robots in a browser, and convert them again whenever a file is saved."""

import webbrowser
from contextlib import ExitStack
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.file import is_file

from .command import PATH, Command, display_options, usage_errors
from .diagnostic_text import printable
from .limits import interruptible
from .progress import progress_bar
from .reading import report_trouble, working_options
from .terminal import Display, show_diagnostics, write_document, write_json, write_result, write_verdict

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Conversion, Options
    from stepbot.pipeline.scenes import ShownScene
    from stepbot.serving.session import Session


@click.command(cls=Command, epilog="Example: stepbot watch arm.robot.yaml -o arm")
@click.argument("sidecars", metavar="SIDECAR...", nargs=-1, required=True, type=PATH)
@click.option(
    "-o",
    "--output",
    type=PATH,
    metavar="DIR",
    help="Also write the verified files there; of several sidecars, to a folder each.",
)
@click.option("--no-open", is_flag=True, help="Print the addresses and do not open a browser.")
@working_options
@display_options
def command(
    options: "Options", sidecars: tuple[Path, ...], output: Path | None, no_open: bool, display: Display
) -> int:
    """Show the robots of sidecars in a browser. Each save of a sidecar or its STEP file shows and verifies them again.

    After a save with errors, the page keeps the last good robot and lists the errors; so does the terminal. With -o,
    files are written whenever they pass verification. Ctrl-C ends it.
    """
    from stepbot.pipeline.prestart import warm_processes
    from stepbot.serving import watching

    diagnostics = Diagnostics()
    if not watching.can_watch():
        diagnostics.add("SB003", "watchfiles is not installed", Span("stepbot"))
        return _refuse(diagnostics, display)
    sessions = _sessions(sidecars, output, options, diagnostics)
    if diagnostics.has_errors:
        return _refuse(diagnostics, display)

    def changed(session: "Session", shown: "ShownScene") -> None:
        show_diagnostics(shown.diagnostics, display)
        write_result(f"{printable(session.target.as_posix())}: {'errors' if shown.diagnostics.has_errors else 'shown'}")
        if not shown.diagnostics.has_errors:
            prover.ask(session)

    def proven(session: "Session", conversion: "Conversion") -> None:
        errors = [diagnostic for diagnostic in conversion.diagnostics if diagnostic.severity == "error"]
        show_diagnostics(errors, display)
        verb = "written" if output is not None else "verified"
        write_result(f"{printable(session.target.as_posix())}: {'verification failed' if errors else verb}")

    try:
        with ExitStack() as running:
            running.enter_context(interruptible())  # to remove temporary files, however the command is ended
            running.enter_context(warm_processes())
            for session in sessions:
                running.callback(session.close)
            prover = watching.Prover(sessions, proven)
            running.callback(prover.close)
            with progress_bar([str(session.target) for session in sessions]) as progress:
                for session in sessions:
                    progress(str(session.target))
                    diagnostics.extend(session.load().diagnostics)
                    session.server.start()
            report_trouble(options.cache, diagnostics)
            _announce(sessions, diagnostics, display)
            for session in sessions:
                prover.ask(session)
                if not no_open:
                    webbrowser.open(session.server.url)
            watching.watch(sessions, changed, Event())
    except KeyboardInterrupt:
        return 0
    return 0


def _sessions(
    sidecars: tuple[Path, ...], output: Path | None, options: "Options", diagnostics: Diagnostics
) -> list["Session"]:
    """A session for each sidecar; none after errors."""
    from stepbot.jobs.batch.runs import plan
    from stepbot.pipeline.sidecars import report_missing
    from stepbot.serving.session import Session

    for path in sidecars:
        if not is_file(path):
            report_missing(path, diagnostics)
    with usage_errors():
        tasks = plan(sidecars, output or Path(), diagnostics)
    if diagnostics.has_errors:
        return []
    folders = [output or Path()] if len(tasks) == 1 else [task.output for task in tasks]
    return [
        Session(task.sidecar, options._replace(output=folder, variant=task.variant), writes=output is not None)
        for task, folder in zip(tasks, folders, strict=True)
    ]


def _refuse(diagnostics: Diagnostics, display: Display) -> int:
    if display.json:
        return write_document({"urls": {}}, diagnostics)
    show_diagnostics(diagnostics, display, after_verdict=write_verdict("not watched", diagnostics, display))
    return diagnostics.exit_code


def _announce(sessions: list["Session"], diagnostics: Diagnostics, display: Display) -> None:
    """Print the diagnostics of the first reading and the addresses."""
    urls = {session.target.as_posix(): session.server.url for session in sessions}
    if display.json:
        write_json({"urls": urls, "diagnostics": diagnostics})
        return
    show_diagnostics(diagnostics, display)
    for name, url in urls.items():
        write_result(url if len(urls) == 1 else f"{printable(name)}: {url}")
