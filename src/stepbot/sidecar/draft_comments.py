"""The comments that `stepbot init` writes about a joint or link: the evidence for it, and what to review."""

import re
from collections.abc import Sequence

_EVIDENCE = re.compile(r" *# (score \d|limits: |stop found by collision |stops: |REVIEW: )")
_CONTINUED = re.compile(r" *#   \S")
_REVIEW = re.compile(r" *# REVIEW: (.*)")
_SCORE = re.compile(r" *# score \d")
_ENTRY = re.compile(r"  (\S.*?):(?: .*)?$")


def above(lines: Sequence[str], entry: int) -> tuple[int, ...]:
    """Indices of the draft's comment lines above an entry, among comments of the user."""
    start = entry
    while start > 0 and lines[start - 1].lstrip(" ").startswith("#"):
        start -= 1
    found: list[int] = []
    for at in range(start, entry):
        if _EVIDENCE.match(lines[at]) or (found and found[-1] == at - 1 and _CONTINUED.match(lines[at])):
            found.append(at)
    return tuple(found)


def below(lines: Sequence[str], after: int, name: str) -> int:
    """Index behind the alternatives of the draft to a joint, each in a comment from index ``after`` on."""
    alternative = re.compile(rf" *# {re.escape(name)}: \{{.*\}}  # (alternative|a guess), score ")
    while after < len(lines) and alternative.match(lines[after]):
        after += 1
    return after


def drafted_reviews(text: str) -> dict[str, str]:
    """What to review of each joint and closure that still has its score from the draft and a REVIEW comment."""
    lines = text.split("\n")
    found = {}
    for index, line in enumerate(lines):
        entry = _ENTRY.match(line)
        if entry is None or line.lstrip(" ").startswith("#"):
            continue
        written = [lines[at] for at in above(lines, index)]
        if any(map(_SCORE.match, written)):
            found[entry[1].strip("\"'")] = "; ".join(_reviews(written))
    return found


def _reviews(lines: Sequence[str]) -> list[str]:
    """The texts of REVIEW comments, with the lines that continue them."""
    texts: list[str] = []
    is_open = False
    for line in lines:
        review = _REVIEW.match(line)
        if review is not None:
            texts.append(review[1])
        elif is_open and _CONTINUED.match(line):
            texts[-1] += f" {line.lstrip(' #')}"
        is_open = review is not None or (is_open and _CONTINUED.match(line) is not None)
    return texts
