"""The questions of ``stepbot init --interactive``: decisions that a STEP file cannot answer."""

from typing import TYPE_CHECKING

import click

from .diagnostic_text import printable

if TYPE_CHECKING:
    from stepbot.authoring.draft import Draft, DraftJoint


def asked(draft: "Draft") -> "Draft":
    """The draft after the user's answers; Enter keeps the drafted value."""
    from stepbot.authoring.answers import chosen, confirmed, fixed, rerooted

    root = _root(draft)
    if root != draft.root:
        draft = rerooted(draft, root)
    for joint in [one for one in draft.joints if one.is_reviewed]:
        answer = _motion(joint)
        if answer == 0:
            draft = confirmed(draft, joint.name)
        elif answer <= len(joint.alternatives):
            draft = chosen(draft, joint.name, joint.alternatives[answer - 1])
        elif answer == len(joint.alternatives) + 1:
            draft = fixed(draft, joint.name)
    return draft


def _root(draft: "Draft") -> str:
    """Ask for the root link."""
    if len(draft.links) == 1:
        return draft.root
    click.echo("Which link is the root (the base)?", err=True)
    return draft.links[_choice([link.name for link in draft.links])].name


def _motion(joint: "DraftJoint") -> int:
    """Ask for the type of a joint: 0 as drafted, then its alternatives, then fixed, then unknown."""
    what = f"{joint.name}: how do '{joint.parts[0]}' and '{joint.parts[1]}' move ({joint.parent} -> {joint.child})?"
    click.echo(printable(what), err=True)
    options = [f"{joint.type} (drafted, score {joint.confidence.score:.2f})"]
    options += [f"{one.type} (score {one.confidence.score:.2f})" for one in joint.alternatives]
    options += ["fixed, no relative motion", "unknown, keep the REVIEW mark"]
    return _choice(options, default=len(options) - 1)


def _choice(options: list[str], default: int = 0) -> int:
    for number, option in enumerate(options, 1):
        click.echo(f"  {number}  {printable(option)}", err=True)
    answer: int = click.prompt("number", type=click.IntRange(1, len(options)), default=default + 1, err=True)
    return answer - 1
