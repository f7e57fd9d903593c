"""``stepbot batch``: convert many robots, on all cores or on a cluster."""

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics, Span, StepbotError, counted

from .command import PATH, Command, display_options, ignore_option, usage_errors
from .convert import again_format_option, for_option, formats_with, html_option, no_verify_option, strict_option
from .diagnostic_text import printable
from .limits import interruptible
from .machine_output import junit_option, write_junit
from .progress import bar, shown
from .reading import description_options, reading_options, reject_descriptions, require_option
from .table import RESULT, status_lines
from .terminal import Display, show_diagnostics, wants_color, write_document, write_result, write_verdict

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from stepbot.jobs.batch.runs import Outcome, Task
    from stepbot.pipeline.conversion import Options

_COLORS = {"converted": "32", "unchanged": "36", "failed": "1;31"}


def _cores(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise click.BadParameter(f"'{text}' is not a positive number of cores")
    return int(text)


@click.command(cls=Command, epilog="Example: stepbot batch robots/ -o out -j 4")
@click.argument("sidecars", metavar="DIR|LIST|SIDECAR...", nargs=-1, required=True, type=PATH)
@click.option(
    "-o",
    "--output",
    required=True,
    type=PATH,
    metavar="DIR",
    help="Output folder, with a subfolder per robot; or DIR/{name}, and {folder} for the folder of its sidecar.",
)
@click.option("-j", "--jobs", type=_cores, metavar="N", help="Number of cores.  [default: all]")
@click.option("--scheduler", metavar="ADDRESS", help="Convert on the Dask cluster at tcp://HOST:PORT.")
@again_format_option
@for_option
@no_verify_option
@strict_option
@html_option
@junit_option
@require_option
@ignore_option
@reading_options
@description_options
@display_options
def command(
    options: "Options",
    sidecars: tuple[Path, ...],
    output: Path,
    jobs: int | None,
    scheduler: str | None,
    formats: tuple[str, ...],
    junit: Path | None,
    display: Display,
) -> int:
    """Convert many robots: sidecars, folders that are searched recursively, or .txt files with one path per line.

    Each robot is written to its own subfolder of the output folder. A failure does not stop the other robots. Robots
    whose input and files are unchanged are skipped, so an interrupted batch can be resumed. A URDF, SDFormat or MJCF in
    place of a sidecar is always converted again.
    """
    from stepbot.jobs.batch.runs import common_folder, plan
    from stepbot.jobs.discovery import find_sidecars
    from stepbot.runtime.output import check_writable

    diagnostics = Diagnostics()
    with usage_errors():
        tasks = plan(find_sidecars(sidecars, diagnostics), output, diagnostics)
    output = common_folder(output)
    if scheduler is not None:
        reject_descriptions("--scheduler", (task.sidecar for task in tasks))
    try:
        check_writable(output)
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
    if diagnostics.has_errors:
        return _report(diagnostics, [], output, display)
    options = options._replace(output=output, formats=formats_with(options.programs, formats))
    outcomes = _outcomes(tasks, options, jobs, scheduler, diagnostics)
    if junit is not None and not diagnostics.has_errors:
        from stepbot.jobs.batch.summary import suites

        write_junit(junit, suites(outcomes))
    if not diagnostics.has_errors:
        _write_overviews(output, outcomes, diagnostics, html=options.html)
    return _report(diagnostics, outcomes, output, display)


def _write_overviews(output: Path, outcomes: "Sequence[Outcome]", diagnostics: Diagnostics, *, html: bool) -> None:
    """Write the variant sets of OpenUSD, and the page of the batch; SB004 if that is impossible."""
    from stepbot.jobs.batch.summary import write_index, write_variant_sets

    try:
        write_variant_sets(output, outcomes)
        if html:
            write_index(output, outcomes)
    except OSError as error:
        place = Span(str(error.filename or output))
        diagnostics.add(
            "SB004", f"cannot write: {error.strerror or error}", place, help=["choose another folder with -o"]
        )


def _outcomes(
    tasks: "Sequence[Task]", options: "Options", jobs: int | None, scheduler: str | None, diagnostics: Diagnostics
) -> "list[Outcome]":
    """The outcome of each robot, in the order of the tasks."""
    from stepbot.jobs.batch.runs import run_batch
    from stepbot.jobs.batch.work import ClusterUnreachable

    with ExitStack() as stack:
        try:
            executor, at_once = stack.enter_context(_executor(scheduler, jobs, len(tasks)))
        except ClusterUnreachable as error:
            diagnostics.add("SB009", str(error), Span("stepbot"), help=["start a scheduler with `dask scheduler`"])
            return []
        runs = run_batch(tasks, options, options.output, executor, at_once=at_once, as_bytes=scheduler is not None)
        stack.enter_context(closing(runs))
        advance = stack.enter_context(_bar(len(tasks)))
        done = {}
        for outcome in runs:
            done[outcome.task] = outcome
            advance(outcome.task.name)
    return [done[task] for task in tasks]


@contextmanager
def _executor(scheduler: str | None, jobs: int | None, tasks: int) -> "Iterator[tuple[Executor, int]]":
    from stepbot.jobs.batch.work import local_executor, on_cluster
    from stepbot.runtime.processes import core_count

    if scheduler is not None:
        with on_cluster(scheduler) as cluster:
            yield cluster
        return
    cores = jobs or core_count()
    executor = local_executor(cores, tasks)
    try:
        yield executor, min(cores, tasks) or 1
    except BaseException:
        executor.shutdown(wait=False, cancel_futures=True)
        raise
    executor.shutdown()


@contextmanager
def _bar(total: int) -> Iterator[Callable[[str], None]]:
    """Yield a function to call with each finished robot; shows a progress bar on a terminal."""
    start, done = time.monotonic(), list[str]()

    def line() -> str:
        seconds = time.monotonic() - start
        rate = 60.0 * len(done) / seconds if seconds else 0.0
        left = f", {seconds * (total - len(done)) / len(done):.0f} s left: {printable(done[-1])}" if done else ""
        return f"{bar(len(done), total)} {len(done)}/{total}, {rate:.1f}/min{left}"

    with interruptible(), shown(line) as draw:

        def advance(name: str) -> None:
            done.append(name)
            draw()

        yield advance


def _report(diagnostics: Diagnostics, outcomes: "Sequence[Outcome]", output: Path, display: Display) -> int:
    """Print the outcomes; returns the exit code."""
    from stepbot.jobs.batch.summary import batch_document

    failed = [outcome for outcome in outcomes if outcome.status == "failed"]
    code = diagnostics.exit_code or int(bool(failed))
    if display.json:
        return write_document(batch_document(outcomes), diagnostics, code)
    shown = outcomes and display.shows_results
    if shown:
        counts = [(word, sum(outcome.status.value == word for outcome in outcomes)) for word in _COLORS]
        words = ", ".join(f"{n} {word}" for word, n in counts)
        write_result(f"{counted(len(outcomes), 'robot')} in {printable(output.as_posix())}: {words}")
    after_verdict = not outcomes and write_verdict("nothing converted", diagnostics, display)
    show_diagnostics(diagnostics, display, after_verdict=after_verdict)
    for outcome in failed:
        errors = [diagnostic for diagnostic in outcome.diagnostics if diagnostic.severity == "error"]
        subject = f"{outcome.task.name}: not converted"
        show_diagnostics(errors, display, after_verdict=write_verdict(subject, errors, display, stream=sys.stderr))
    if shown:
        write_result("\n".join(_table(outcomes)))
    return code


def _table(outcomes: "Sequence[Outcome]") -> list[str]:
    from stepbot.jobs.batch.summary import check_counts

    texts = [("robot", RESULT, "checks", "warnings", "seconds")]
    for outcome in outcomes:
        checks = check_counts(outcome)
        warnings = sum(diagnostic.severity == "warning" for diagnostic in outcome.diagnostics)
        passed = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in checks.items() if count) or "-"
        seconds = f"{outcome.seconds:.1f}" if outcome.seconds else "-"
        texts.append((printable(outcome.task.name), outcome.status.value, passed, str(warnings or "-"), seconds))
    statuses = [outcome.status.value for outcome in outcomes]
    return status_lines(texts, statuses, None, wants_color(sys.stdout), _COLORS)
