"""``stepbot init``: draft a sidecar from a STEP file."""

import json
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.file import exists

from .command import Command, display_options
from .convert import default_output
from .diagnostic_text import printable
from .progress import progress_bar
from .reading import package_path_option, reading_options, say_trouble
from .terminal import Display, show_diagnostics, write_document, write_result

if TYPE_CHECKING:
    from stepbot.draft.draft import Draft
    from stepbot.draft.questions import Dialogue
    from stepbot.pipeline.conversion import Options


def asked(draft: "Draft", dialogue: "Dialogue | None" = None) -> "Draft":
    """The draft after the user's answers; Enter keeps the drafted value.

    Args:
        draft: The first draft.
        dialogue: Infers again after each answer; None if the joints are not inferred: then the root is asked for.
    """
    return _rooted(draft) if dialogue is None else _answered(dialogue)


def _answered(dialogue: "Dialogue") -> "Draft":
    """Ask the questions that most joints depend on, and infer again after each answer."""
    from stepbot.draft.questions import MOST

    draft, seen = dialogue.draft, set[str]()
    while len(seen) < MOST and (one := next((q for q in draft.questions if q.name not in seen), None)):
        seen.add(one.name)
        click.echo(printable(one.text), err=True)
        options = [f"{option.text}{' (drafted)' * option.is_drafted}" for option in one.options]
        answer = _choice([*options, "unknown, leave it as drafted"], default=len(options))
        if answer < len(one.options):
            dialogue.answer(one.name, one.options[answer].value)
            draft = dialogue.draft
    return draft


def _rooted(draft: "Draft") -> "Draft":
    """The draft with the root link that the user chooses."""
    from stepbot.draft.answers import rerooted

    if len(draft.links) == 1:
        return draft
    click.echo("Which link stands, as the root?", err=True)
    root = draft.links[_choice([link.name for link in draft.links])].name
    return draft if root == draft.root else rerooted(draft, root)


def _choice(options: list[str], default: int = 0) -> int:
    for number, option in enumerate(options, 1):
        click.echo(f"  {number}  {printable(option)}", err=True)
    answer: int = click.prompt("number", type=click.IntRange(1, len(options)), default=default + 1, err=True)
    return answer - 1


@click.command(
    cls=Command,
    epilog="Example: stepbot init arm.step",
)
@click.argument("step", metavar="STEP", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Sidecar to write.  [default: name of STEP with .robot.yaml, in the same folder]",
)
@click.option(
    "--from",
    "description",
    type=click.Path(path_type=Path),
    metavar="ROBOT",
    help="URDF, SDFormat or MJCF of the same robot: take its names, joints, limits and masses.",
)
@click.option("--force", is_flag=True, help="Overwrite an existing sidecar.")
@click.option("-i", "--interactive", is_flag=True, help="Ask the questions, at most five, that most joints depend on.")
@click.option(
    "--answers",
    "answers_file",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Answers to the questions of --json: a JSON object {question: answer}, or a sidecar with `answers`. "
    "[default: those of the sidecar that --force overwrites]",
)
@reading_options
@package_path_option
@display_options
def command(
    options: "Options",
    step: Path,
    output: Path | None,
    description: Path | None,
    force: bool,
    interactive: bool,
    answers_file: Path | None,
    display: Display,
) -> int:
    """Draft a sidecar from STEP: links, joints and densities, each guess with its evidence.

    Joints are those of --from, or else the kinematic pairs in STEP, or else inferred from shapes and names. Uncertain
    lines are marked REVIEW. Unknown limits and densities are `todo`. The draft passes `check --step` and can be
    converted without changes.
    """
    from stepbot.pipeline.drafting import draft_step, write_draft

    if interactive and display.json:
        raise click.UsageError("--interactive and --json cannot be combined")
    sidecar = output or _beside(step)
    found = Diagnostics()
    if exists(sidecar) and not force:
        help = ["write another file with -o, or overwrite it with --force"]
        found.add("SB012", "sidecar already exists", Span(sidecar.as_posix()), help=help)
        return _show_result(None, "", sidecar, step, found, display)
    answers = _answers(answers_file or sidecar)
    with ExitStack() as bar:
        progress = bar.enter_context(progress_bar(("read", "joints", "stops"), options))

        def ask(draft: "Draft", dialogue: "Dialogue | None") -> "Draft":
            bar.close()
            return asked(draft, dialogue)

        drafting = draft_step(step, options, description, ask if interactive else None, answers, progress)
    found.extend(drafting.diagnostics)
    draft, text = drafting.draft, ""
    if draft is not None:
        draft = replace(draft, robot=default_output(sidecar).name)
        text = write_draft(draft, sidecar, step, options.encoding, found)
    say_trouble(options.cache, found)
    return _show_result(draft, text, sidecar, step, found, display)


def _answers(file: Path) -> dict[str, str]:
    """The answers in a JSON object or in a sidecar; none without the file."""
    from stepbot.pipeline.drafting import kept_answers

    if file.suffix.lower() != ".json":
        return kept_answers(file) if exists(file) else {}
    try:
        answers = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise click.UsageError(f"--answers: {file.as_posix()}: {error}") from error
    if not isinstance(answers, dict) or not all(isinstance(value, str) for value in answers.values()):
        raise click.UsageError(f"--answers: {file.as_posix()}: expected an object {{question: answer}}")
    return answers


def _beside(step: Path) -> Path:
    from stepbot.sidecar.starter import starter_name

    return step.with_name(starter_name(step))


def _show_result(
    draft: "Draft | None",
    text: str,
    sidecar: Path,
    step: Path,
    found: Diagnostics,
    display: Display,
) -> int:
    """Print a draft and what to do next; ``text`` is the sidecar as written."""
    if display.json:
        return write_document(_document(draft, text, sidecar, step, found), found)
    if draft is not None and not found.has_errors and display.shows_results:
        from .draft_text import draft_text

        write_result(draft_text(draft, sidecar, text, verbose=display.verbose))
    show_diagnostics(found, display)
    return found.exit_code


def _document(draft: "Draft | None", text: str, sidecar: Path, step: Path, found: Diagnostics) -> dict[str, Any]:
    document: dict[str, Any] = {"step": step.as_posix(), "sidecar": sidecar.as_posix()}
    if draft is not None:
        from .draft_text import draft_document

        document |= {"written": not found.has_errors, **draft_document(draft, text)}
    return document
