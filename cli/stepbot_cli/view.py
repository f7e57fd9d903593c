"""``stepbot view``: show a robot in a browser."""

import threading
import webbrowser
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import click
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span, StepbotError
from stepbot.runtime.file import exists

from .command import PATH, Command, display_options
from .convert import default_output
from .diagnostic_text import printable, summary
from .limits import interruptible
from .progress import progress_bar
from .reading import package_path_option, reading_options, report_trouble, variant_option
from .terminal import Display, show_diagnostics, write_document, write_result

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options


@click.command(cls=Command, epilog="Example: stepbot view arm.robot.yaml")
@click.argument("target", metavar="TARGET", type=PATH)
@click.option(
    "--edit", is_flag=True, help="Edit the sidecar in the page; a STEP file or description without one gets one."
)
@click.option("--no-open", is_flag=True, help="Print the address and do not open a browser.")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, metavar="N", help="Port; the default is any free one."
)
@click.option(
    "--no-verify",
    "verify",
    is_flag=True,
    callback=lambda _context, _option, given: not given,
    help="Do not load the files in engines.",
)
@reading_options
@variant_option
@package_path_option
@display_options
def command(options: "Options", target: Path, edit: bool, no_open: bool, port: int, display: Display) -> int:
    """Show a robot in a browser: links, joints to move, masses, collision shapes, verification.

    TARGET is a sidecar, a STEP file, or any URDF, SDFormat or MJCF file.

    The page is served on this machine only (127.0.0.1), at an address with a random token; it loads nothing from a
    network. A STEP file is shown with the joints that `stepbot init` would draft. Ctrl-C ends it.

    With --edit the page writes to the sidecar, each change checked before, and undone with one click. Its Convert
    button writes the files, as `stepbot convert` does. Otherwise nothing is written.
    """
    from stepbot.pipeline.prestart import warm_processes
    from stepbot.serving.session import Session
    from stepbot.serving.watching import Prover, follow

    diagnostics = Diagnostics()
    drafted = ""
    if edit:
        target, drafted = _editable(target, options, diagnostics)
        _check_writable(target, diagnostics)
    if diagnostics.has_errors:
        return _announce(diagnostics, "", display)
    try:
        output = default_output(target, options.variant)
        session = Session(target, options._replace(output=output), port=port, edits=edit)
    except OSError as error:
        diagnostics.add("SB019", f"port {port}: {error.strerror}", Span("stepbot"))
        return _announce(diagnostics, "", display)
    is_served = False
    try:
        with ExitStack() as running:
            running.enter_context(interruptible())  # to remove temporary files, however the command is ended
            if edit:
                running.enter_context(warm_processes())
            running.callback(session.close)
            with progress_bar(("read",)) as progress:
                progress("read")
                shown = session.load()
            diagnostics.extend(shown.diagnostics)
            report_trouble(options.cache, diagnostics)
            if shown.scene is None:
                return _announce(diagnostics, "", display)
            session.server.start()
            _announce(diagnostics, session.server.url, display, drafted)
            is_served = True
            if not no_open:
                webbrowser.open(session.server.url)
            session.guess()
            if options.verify:
                prover = Prover([session], lambda *result: None)
                running.callback(prover.close)
                session.on_edit = lambda: prover.ask(session)
                prover.ask(session)
            ended = threading.Event()
            if not edit:
                ended.wait()
            follow(session, lambda shown: None if shown.diagnostics.has_errors else session.on_edit(), ended)
    except KeyboardInterrupt:
        if not is_served:
            raise
    return 0


def _editable(target: Path, options: "Options", diagnostics: Diagnostics) -> tuple[Path, str]:
    """The sidecar to edit: the target, or the one beside a STEP file or a description; and whether it was made."""
    from stepbot.pipeline.conversion import is_description
    from stepbot.pipeline.drafting import draft_step, write_draft
    from stepbot.pipeline.sidecars import SIDECAR_SUFFIXES, report_missing
    from stepbot.robot.step_names import is_step_name
    from stepbot.runtime.file import read_regular, write_file
    from stepbot.sidecar.starter import description_starter, starter_name

    if target.suffix.lower() in SIDECAR_SUFFIXES:
        return target, ""
    of_step = is_step_name(target.name)
    if not (of_step or is_description(target)):
        raise click.UsageError("--edit needs a sidecar, a STEP file, a URDF, an SDFormat or an MJCF")
    sidecar = target.with_name(starter_name(target) if of_step else f"{target.name.partition('.')[0]}.robot.yaml")
    if not of_step and exists(sidecar) and target.name.encode() not in read_regular(sidecar):  # that of a STEP file
        sidecar = target.with_name(f"{target.name}.robot.yaml")
    if exists(sidecar):
        return sidecar, ""
    if not of_step:
        if not exists(target):
            report_missing(target, diagnostics)
            return sidecar, ""
        write_file(sidecar, description_starter(target).encode(), diagnostics)
        return sidecar, f"wrote {printable(sidecar.as_posix())}, which changes {printable(target.name)}"
    with progress_bar(("draft",)) as progress:
        progress("draft")
        drafting = draft_step(target, options)
    diagnostics.extend(drafting.diagnostics)
    if drafting.draft is not None and not diagnostics.has_errors:
        draft = replace(drafting.draft, robot=default_output(sidecar).name)
        write_draft(draft, sidecar, target, options.encoding, diagnostics)
    return sidecar, f"wrote {printable(sidecar.as_posix())}, as `stepbot init` does"


def _check_writable(sidecar: Path, diagnostics: Diagnostics) -> None:
    """Report in advance that no edit could be written."""
    from stepbot.runtime.output import check_writable

    try:
        check_writable(sidecar.parent)
    except StepbotError as error:
        diagnostics.extend(
            diagnostic._replace(help=("copy the files to a folder that you can write to",))
            for diagnostic in error.diagnostics
        )


def _announce(diagnostics: Diagnostics, url: str, display: Display, drafted: str = "") -> int:
    """Print diagnostics and the address of the page; returns the exit code.

    Of a page that opens, warnings and notes are only counted: it lists them, each beside its place.
    """
    if display.json:
        return write_document({"url": url}, diagnostics)
    listed = (
        [diagnostic for diagnostic in diagnostics if diagnostic.severity != "error"]
        if url and not display.verbose
        else []
    )
    show_diagnostics(
        [diagnostic for diagnostic in diagnostics if diagnostic not in listed] if listed else diagnostics, display
    )
    counted = f"{summary(listed, explain=False)} in the page, under Findings" if listed and not display.quiet else ""
    for line in filter(None, (drafted, counted, url)):
        write_result(line)
    return diagnostics.exit_code
