"""The questions of ``stepbot init --interactive``: decisions that a STEP file cannot answer."""

from dataclasses import replace
from typing import TYPE_CHECKING

import click

from .diagnostic_text import printable

if TYPE_CHECKING:
    from stepbot.draft.draft import Draft, DraftConnection
    from stepbot.pipeline.drafting import Again


def asked(draft: "Draft", again: "Again | None" = None) -> "Draft":
    """The draft after the user's answers; Enter keeps the drafted value.

    Each answer is a fact from which links and joints are inferred again, before the next question.

    Args:
        draft: The first draft.
        again: Infers again from facts; None if the joints are not inferred: then the draft itself is changed.
    """
    return _corrected(draft) if again is None else _inferred(draft, again)


def _inferred(draft: "Draft", again: "Again") -> "Draft":
    """Infer again after each answer; an open question is not repeated."""
    from stepbot.draft.answers import Facts, known_fixed, known_joint

    facts = Facts()
    root = _root(draft)
    if root != draft.root:
        (link,) = (link for link in draft.links if link.name == root)
        facts = replace(facts, root=link.components[0])
        draft = again(facts)
    asked_about: set[frozenset[str]] = set()
    while one := next((one for one in _open_ones(draft) if frozenset(one[0].parts) not in asked_about), None):
        joint, ends = one
        asked_about.add(frozenset(joint.parts))
        answer = _motion(joint, ends)
        if answer <= len(joint.alternatives):
            facts = facts.with_joint(known_joint(joint, joint.alternatives[answer - 1] if answer else None))
        elif answer == len(joint.alternatives) + 1:
            facts = facts.with_joint(known_fixed(joint))
        else:
            continue
        draft = again(facts)
    return draft


def _open_ones(draft: "Draft") -> list[tuple["DraftConnection", str]]:
    """Joints and closures whose type or links are uncertain, and what they connect."""
    connections: list[tuple[DraftConnection, str]] = [(j, f"{j.parent} -> {j.child}") for j in draft.joints]
    connections += [(c, f"{c.link_a}, {c.link_b}") for c in draft.closures]
    return [(one, ends) for one, ends in connections if one.is_open]


def _corrected(draft: "Draft") -> "Draft":
    """The draft with each answer applied to the joint that it is about."""
    from stepbot.draft.answers import chosen, confirmed, fixed, rerooted

    root = _root(draft)
    if root != draft.root:
        draft = rerooted(draft, root)
    for joint in [one for one in draft.joints if one.is_open]:
        answer = _motion(joint, f"{joint.parent} -> {joint.child}")
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


def _motion(joint: "DraftConnection", ends: str) -> int:
    """Ask for the type of a joint: 0 as drafted, then its alternatives, then fixed, then unknown."""
    what = f"{joint.name}: how do '{joint.parts[0]}' and '{joint.parts[1]}' move ({ends})?"
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
