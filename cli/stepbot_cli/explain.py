"""``stepbot explain``: explain a diagnostic code."""

import sys
import textwrap

import click

from stepbot.diagnostics import did_you_mean
from stepbot.diagnostics.codes import CODES, Code, current, full_code

from .command import Command
from .terminal import text_width, write_result


@click.command(cls=Command, epilog="Example: stepbot explain SB301")
@click.argument("code", required=False)
def command(code: str | None) -> int:
    """Explain a diagnostic CODE: what it means, why it matters, and how to fix it.

    Without CODE, list all codes.
    """
    if code is None:
        listed = sorted(CODES.values(), key=lambda c: c.id)
        write_result("\n".join(f"{c.id}  {c.severity:<7}  {c.title}" for c in listed))
        return 0
    wanted = full_code(code)
    known = current(wanted)
    if not known:
        near = "; ".join(did_you_mean(code.upper(), CODES))
        raise click.BadParameter(f"unknown code '{code}'" + (f"; {near}" if near else ""), param_hint="CODE")
    renamed = "" if known == (wanted,) else f"{wanted} of earlier versions is {', '.join(known)} now.\n\n"
    write_result(renamed + "\n\n".join(map(_explanation, dict.fromkeys(CODES[one] for one in known))))
    return 0


def _explanation(code: Code) -> str:
    width = text_width(sys.stdout) - 2
    paragraphs = [("What it means", code.explanation), ("How to fix it", code.fix)]
    paragraphs += [("Features", ", ".join(code.features))] if code.features else []
    body = "\n\n".join(f"{title}:\n{textwrap.indent(_filled(text, width), '  ')}" for title, text in paragraphs)
    return f"{code.id} ({code.severity}): {code.title}\n\n{body}"


def _filled(text: str, width: int) -> str:
    """``text`` in lines that fit a terminal; indented lines are snippets and not wrapped."""
    return "\n".join(
        line if line.startswith(" ") else textwrap.fill(line, width, break_long_words=False, break_on_hyphens=False)
        for line in text.splitlines()
    )
