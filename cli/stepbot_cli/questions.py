"""The questions of ``stepbot init --interactive``: decisions that a STEP file cannot answer."""

from typing import TYPE_CHECKING

import click

from .diagnostic_text import printable

if TYPE_CHECKING:
    from stepbot.draft.draft import Draft
    from stepbot.draft.questions import Dialogue


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
