"""``stepbot init``: draft a sidecar from a STEP file."""

import json
import shlex
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span, counted
from stepbot.report.plain import picked
from stepbot.runtime.file import exists

from .command import PATH, Command, display_options
from .convert import default_output
from .diagnostic_text import printable
from .progress import progress_bar
from .reading import package_path_option, reading_options, report_trouble
from .terminal import Display, show_diagnostics, write_document, write_result, write_verdict

if TYPE_CHECKING:
    from stepbot.draft.draft import Alternative, Draft, DraftClosure, DraftJoint, Question
    from stepbot.draft.questions import Dialogue
    from stepbot.draft.text.draft_names import DraftNames
    from stepbot.pipeline.conversion import Options

_FUSED = 8
"""Number of fused parts that are listed, equal ones as one; -v lists all."""
_LONGEST_FACTS = 96
"""Width of the evidence; -v prints all of it."""
_MARK = "REVIEW:"


def draft_text(draft: "Draft", sidecar: Path, text: str, *, verbose: bool = False) -> str:
    """The summary of a draft that was written as ``text``."""
    from stepbot.draft.text.draft_names import names_of

    names = names_of(draft)
    questions = _questions(draft, text)
    verdict = f"{printable(sidecar.as_posix())}: {_counts(draft)}; root link '{names.links[draft.root]}'"
    lines = [f"{verdict}; to decide: {', '.join(questions)}" if questions else verdict]
    lines += _reviewed(draft, names, verbose=verbose)
    sure = [
        f"{printable(name)} ({one.type}{loop})"
        for one, name, _, loop in _connections(draft, names)
        if not (verbose or one.is_reviewed)
    ]
    if sure:
        lines.append(f"  on strong evidence: {', '.join(sure)}; -v shows it")
    lines += _fused(draft, names.freed, verbose=verbose)
    lines += [f"  {printable(note)}" for note in draft.notes]
    lines += _asked(draft)
    return "\n".join([*lines, *_next(sidecar, questions)])


def draft_document(draft: "Draft", text: str) -> dict[str, Any]:
    """A draft, and the number of questions in its ``text``, as JSON."""
    from stepbot.draft.text.draft_names import names_of

    names = names_of(draft)
    links = [
        {**picked(link, "name parts rest", name=names.links[link.name]), **_confidence(link)} for link in draft.links
    ]
    contacts = [
        picked(contact, "link part material evidence=why", link=names.links[contact.link]) for contact in draft.contacts
    ]
    joints = [
        {
            "name": name,
            "type": joint.written.value,
            "parent": names.links[joint.parent],
            "child": names.links[joint.child],
            **_geometry(joint),
            "stops": [picked(stop, "position parts") for stop in joint.stops],
            "stops_skipped": joint.stops_skipped,
        }
        for joint, name in zip(draft.joints, names.joints, strict=True)
    ]
    closures = [
        {
            "name": name,
            "type": closure.type.value,
            "link_a": names.links[closure.link_a],
            "link_b": names.links[closure.link_b],
            **_geometry(closure),
        }
        for closure, name in zip(draft.closures, names.closures, strict=True)
        if closure.written is closure.type
    ]
    return {
        "root": names.links[draft.root],
        "links": links,
        "contacts": contacts,
        "joints": joints,
        "closures": closures,
        "fused": [
            _fused_document(one, name, names.links[one.link], text)
            for one, name in zip(draft.fused, names.freed, strict=True)
        ],
        "questions": [_question_document(question) for question in draft.questions],
        "answers": dict(draft.answers),
        "offered": [
            {**picked(one, "parts type point direction", parts=[one.a, one.b]), **_confidence(one)}
            for one in draft.offered
            if one not in draft.fused
        ],
        "review": text.count(_MARK),
        "limits_to_fill_in": _todo(draft),
        "notes": list(draft.notes),
    }


def _fused_document(alternative: "Alternative", name: str, link: str, text: str) -> dict[str, Any]:
    """A part that looks movable and was fused, and the line of the sidecar's ``text`` that frees it."""
    return {
        "part": alternative.moving,
        "with": alternative.a if alternative.moving == alternative.b else alternative.b,
        "link": link,
        "freed": name,
        **picked(alternative, "held_by=held type point direction"),
        **_confidence(alternative),
        "line": next((n for n, line in enumerate(text.splitlines(), 1) if line.strip().startswith(f"# {name}:")), 0),
    }


def _question_document(question: "Question") -> dict[str, Any]:
    options = [picked(option, "value text") for option in question.options]
    return picked(question, "name text decides options drafted", options=options, drafted=question.drafted.value)


def _confidence(one: Any) -> dict[str, Any]:
    return picked(one.confidence, "score evidence")


def _geometry(one: "DraftJoint | DraftClosure") -> dict[str, Any]:
    return {
        "point": list(one.point),
        "direction": None if one.direction is None else list(one.direction),
        **_confidence(one),
        "review": one.is_reviewed,
        "doubt": one.doubt,
    }


def _connections(draft: "Draft", names: "DraftNames") -> Iterator[tuple["DraftJoint | DraftClosure", str, str, str]]:
    """Each joint and closure, its name, the links at its ends, and whether it closes a loop, in words."""
    for joint, name in zip(draft.joints, names.joints, strict=True):
        yield joint, name, f"{names.links[joint.parent]} -> {names.links[joint.child]}", ""
    for closure, name in zip(draft.closures, names.closures, strict=True):
        yield closure, name, f"{names.links[closure.link_a]} - {names.links[closure.link_b]}", ", closes a loop"


def _reviewed(draft: "Draft", names: "DraftNames", *, verbose: bool) -> list[str]:
    """Each joint to review, or all, with its doubts; of several with the same ones, as in equal limbs, the first."""
    groups: dict[tuple[str, ...], list[tuple[str, str]]] = {}
    for one, name, ends, loop in _connections(draft, names):
        if not (verbose or one.is_reviewed):
            continue
        facts = _facts(one, verbose=verbose)
        score = f"score {one.confidence.score:.2f}{'  REVIEW' * one.is_reviewed}"
        key = (name,) if verbose or not facts else (one.written, score, facts)
        line = f"{one.written}, {printable(ends)}{loop}, {score}"
        groups.setdefault(key, []).append((name, f"{line}\n    {printable(facts)}" if facts else line))
    return [line for rows in groups.values() for line in _alike(rows, "  ", ": ")]


def _alike(rows: Sequence[tuple[str, str]], indent: str, mark: str) -> list[str]:
    """The name of the first row and what all of them share, then the names of the others."""
    (name, text), *others = rows
    lines = [f"{indent}{printable(name)}{mark}{text}"]
    return [*lines, f"{indent}  the same: {', '.join(printable(name) for name, _ in others)}"] if others else lines


def _facts(one: "DraftJoint | DraftClosure", *, verbose: bool) -> str:
    """The doubts of a joint, then its evidence; its beginning unless verbose."""
    weak = f"weak: {one.doubt}" if one.doubt else ""
    facts = "; ".join(filter(None, (one.review, weak, *one.confidence.evidence)))
    if not verbose and len(facts) > _LONGEST_FACTS:
        facts = f"{facts[: _LONGEST_FACTS - 1].rstrip()}…"
    return facts


def _fused(draft: "Draft", names: Sequence[str], *, verbose: bool) -> list[str]:
    """Parts that look movable and were fused; how to free them."""
    if not draft.fused:
        return []
    groups: dict[tuple[str, ...], list[tuple[str, str]]] = {}
    for one, name in zip(draft.fused, names, strict=True):
        text = f"({one.type}) in '{printable(one.link)}', held by: {printable(one.held)}"
        groups.setdefault((name,) if verbose else (one.type, one.held), []).append((name, text))
    shown = [*groups.values()][: None if verbose else _FUSED]
    more = len(draft.fused) - sum(len(rows) for rows in shown)
    head = f"  fused, though {counted(len(draft.fused), 'part')} might move: uncomment the lines of a part to free it"
    lines = [head, *(line for rows in shown for line in _alike(rows, "    ", " "))]
    return [*lines, f"    {more} more; -v shows them"] if more else lines


def _asked(draft: "Draft") -> list[str]:
    """The questions that are left."""
    if not draft.questions:
        return []
    lines = [f"  {counted(len(draft.questions), 'question')} for `init --interactive`, or as `answers` in the sidecar:"]
    for question in draft.questions:
        others = ", ".join(option.value for option in question.options if option is not question.drafted)
        lines.append(
            f"    {printable(question.text)} drafted: {printable(question.drafted.value)}; or {printable(others)}"
        )
    return lines


def _counts(draft: "Draft") -> str:
    counts = [(len(draft.links), "link"), (len(draft.joints), "joint"), (len(draft.closures), "closure")]
    return ", ".join(counted(count, noun) for count, noun in counts if count or noun != "closure")


def _todo(draft: "Draft") -> int:
    return sum(joint.limits is None and joint.written.bounded for joint in draft.joints)


def _questions(draft: "Draft", text: str) -> list[str]:
    """What the author of a drafted sidecar has to decide."""
    reviews, todo = text.count(_MARK), _todo(draft)
    marks = [counted(reviews, "REVIEW mark")] if reviews else []
    return [*marks, *([f"{todo} `limits: todo`"] if todo else [])]


def _next(sidecar: Path, questions: list[str]) -> list[str]:
    """The commands that follow: to see and decide, to check, to convert."""
    path = printable(shlex.quote(sidecar.as_posix()))
    see = [f"  stepbot view --edit {path}    shows each joint and takes the decisions"] if questions else []
    return ["next:", *see, f"  stepbot check --step {path}", f"  stepbot convert {path}"]


def asked(draft: "Draft", dialogue: "Dialogue | None" = None) -> "Draft":
    """The draft after the answers, or, of joints that are not inferred, with the root chosen; Enter keeps all."""
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

    numbers = click.Choice([str(number) for number in range(1, len(options) + 1)])
    try:
        return int(click.prompt("number", default=str(default + 1), type=numbers, show_choices=False, err=True)) - 1
    except click.Abort as stop:
        if not isinstance(stop.__context__, EOFError):  # but Ctrl-C
            raise
        click.echo("\nend of input: left as drafted", err=True)
        return default


@click.command(cls=Command, epilog="Example: stepbot init arm.step")
@click.argument("step", metavar="STEP", type=PATH)
@click.option(
    "-o",
    "--output",
    type=PATH,
    metavar="FILE",
    help="Sidecar to write.  [default: name of STEP with .robot.yaml, in the same folder]",
)
@click.option(
    "--from",
    "description",
    type=PATH,
    metavar="ROBOT",
    help="URDF, SDFormat or MJCF of the same robot: take its names, joints, limits and masses.",
)
@click.option("--force", is_flag=True, help="Overwrite an existing sidecar.")
@click.option("-i", "--interactive", is_flag=True, help="Ask the questions, at most five, that most joints depend on.")
@click.option(
    "--answers",
    "answers_file",
    type=PATH,
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
    from stepbot.sidecar.starter import starter_name

    if interactive and display.json:
        raise click.UsageError("--interactive and --json cannot be combined")
    sidecar = output or step.parent / starter_name(step)
    diagnostics = Diagnostics()
    if exists(sidecar) and not force:
        help = ["write another file with -o, or overwrite it with --force"]
        diagnostics.add("SB012", "sidecar already exists", Span(sidecar.as_posix()), help=help)
        return _show_result(None, "", sidecar, step, diagnostics, display)
    answers = _answers(answers_file or sidecar)
    with ExitStack() as bar:
        progress = bar.enter_context(progress_bar(("read", "joints", "stops"), options))

        def ask(draft: "Draft", dialogue: "Dialogue | None") -> "Draft":
            bar.close()
            return asked(draft, dialogue)

        drafting = draft_step(step, options, description, ask if interactive else None, answers, progress)
    diagnostics.extend(drafting.diagnostics)
    draft, text = drafting.draft, ""
    if draft is not None:
        draft = replace(draft, robot=default_output(sidecar).name)
        text = write_draft(draft, sidecar, step, options.encoding, diagnostics)
    report_trouble(options.cache, diagnostics)
    return _show_result(draft, text, sidecar, step, diagnostics, display)


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


def _show_result(
    draft: "Draft | None", text: str, sidecar: Path, step: Path, diagnostics: Diagnostics, display: Display
) -> int:
    """Print a draft and what to do next; ``text`` is the sidecar as written."""
    if display.json:
        document: dict[str, Any] = {"step": step.as_posix(), "sidecar": sidecar.as_posix()}
        if draft is not None:
            document |= {"written": not diagnostics.has_errors, **draft_document(draft, text)}
        return write_document(document, diagnostics)
    if draft is not None and not diagnostics.has_errors and display.shows_results:
        write_result(draft_text(draft, sidecar, text, verbose=display.verbose))
    then = f"{sidecar.as_posix()} is unchanged" if exists(sidecar) else "nothing is written"
    after_verdict = write_verdict(f"{step.as_posix()}: not drafted", diagnostics, display, then)
    show_diagnostics(diagnostics, display, after_verdict=after_verdict)
    return diagnostics.exit_code
