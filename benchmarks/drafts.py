"""Scores `stepbot init` through the command line on assemblies that others published and people labelled.

Labels are in ``benchmarks/truth`` (its README states their form and which assemblies are held out) and in the corpus,
below ``assemblies/truth``; the STEP files are in the corpus. A joint is found if its axis, type and both links are
right; it is merged if one of its links also holds another true link; the other drafted ones are wrong.
"""

import json
import re
import subprocess
import tomllib
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from msgspec import Struct, field
from msgspec.structs import asdict
from ruamel.yaml import YAML

from stepbot.step.assembly import Component
from stepbot.step.structure.paths import ComponentPaths, nearest_claim

from .contenders import STEPBOT

TRUTH = Path(__file__).with_name("truth")
HELD_OUT, OPENED = ("b6", "rzlli_quadruped", "spot"), ("elmo",)
"""Drawn by lot before any of the 13 was drafted, and what of these was opened for tuning; see the labels' README."""
_IGNORED = "_ignore"
_HEADS = ("found", "merged", "wrong, unmarked", "wrong, REVIEW", "volume", "root")


class Outcome(Struct):
    """What became of the true joints of some assemblies."""

    assemblies: int = 0
    failed: list[str] = field(default_factory=list)
    """Assemblies without a draft."""
    joints: int = 0
    found: int = 0
    merged: int = 0
    unmarked: int = 0
    """Wrong ones without a REVIEW mark."""
    reviewed: int = 0
    """Wrong ones with one."""
    judged: list[tuple[str, bool, bool]] = field(default_factory=list)
    """Evidence of each drafted joint, whether it is right, and whether it is marked."""
    fused: list[tuple[str, bool]] = field(default_factory=list)
    """What holds each part that looks movable and was fused, and whether the label has that joint."""
    volume: float = 0.0
    """Sum over the assemblies of the share of the volume that is in the right link."""
    roots: int = 0

    def add(self, other: "Outcome") -> None:
        """Add the counts of another one."""
        for name, value in asdict(other).items():
            setattr(self, name, getattr(self, name) + value)

    def row(self) -> str:
        """Cells of a Markdown row."""
        drafted = max(1, self.assemblies - len(self.failed))
        cells = (f"{self.found} of {self.joints}", self.merged, self.unmarked, self.reviewed)
        return " | ".join(
            map(str, (*cells, f"{self.volume / drafted:.0%}".replace("%", " %"), f"{self.roots} of {self.assemblies}"))
        )


Scores = dict[str, dict[str, Outcome]]
"""By group and name of the assembly."""


def labelled(corpus: Path) -> Iterator[tuple[str, Path, Path]]:
    """Group (``tuned``, ``labelled later``, ``opened later``, ``held out``), label and STEP file of each assembly."""
    for label in sorted((corpus / "assemblies" / "truth").glob("*.yaml")):
        yield "tuned", label, corpus / "assemblies" / f"{label.stem}.step"
    for label in sorted(TRUTH.glob("*.yaml")):
        group = "opened later" if label.stem in OPENED else "labelled later"
        yield "held out" if label.stem in HELD_OUT else group, label, corpus / "assemblies" / f"{label.stem}.step"


def score_drafts(corpus: Path, only: str = "", *, held_out: bool = False, timeout: float = 600.0) -> Scores:
    """Print a row per assembly, then the sums of each group; returns the outcomes by group and name."""
    scores: Scores = defaultdict(dict)
    print(f"| assembly | {' | '.join(_HEADS)} |\n| --- |{' --- |' * len(_HEADS)}")
    for group, label, step in labelled(corpus):
        if only not in label.stem or (group == "held out") != held_out:
            continue
        outcome = score_draft(label, step, timeout)
        print(f"| {label.stem} | {outcome.row()} |{' no draft' if outcome.failed else ''}", flush=True)
        scores[group][label.stem] = outcome
    for group, outcomes in scores.items():
        total = _total(outcomes.values())
        print(f"| **{group}** ({total.assemblies}, {len(total.failed)} without a draft) | {total.row()} |")
    return scores


def score_draft(label: Path, step: Path, timeout: float = 600.0) -> Outcome:
    """The outcome of one assembly by its label."""
    outcome = _outcome(YAML(typ="safe").load(label.read_text(encoding="utf-8")), step, timeout)
    outcome.failed = [label.stem] * len(outcome.failed)
    return outcome


def page_with_scores(text: str, scores: Scores) -> str:
    """The page with a table for each group that was scored, between its markers."""
    known = tomllib.loads((TRUTH / "assemblies.toml").read_text(encoding="utf-8"))
    for group, outcomes in scores.items():
        rows = [
            table_row(f"[{name}](https://github.com/{known[name]['source']}): {known[name]['what']}", outcome)
            for name, outcome in sorted(outcomes.items())
        ]
        head = f"| {group} | {' | '.join(_HEADS)} |\n| --- |{' --- |' * len(_HEADS)}\n"
        table = head + "".join(rows) + table_row(f"**all {len(outcomes)}**", _total(outcomes.values()))
        block = re.compile(rf"(<!-- drafts: {group} -->\n).*?(<!-- end -->)", re.DOTALL)
        text = block.sub(lambda match, table=table: match[1] + table + match[2], text)
    return text


def table_row(first: str, outcome: Outcome) -> str:
    """A Markdown row."""
    return f"| {first} | {outcome.row()} |\n"


def _total(outcomes: Iterable[Outcome]) -> Outcome:
    total = Outcome()
    for outcome in outcomes:
        total.add(outcome)
    return total


def _outcome(truth: Mapping[str, Any], step: Path, timeout: float) -> Outcome:
    with TemporaryDirectory() as folder:
        draft = _document(["init", str(step), "-o", f"{folder}/draft.robot.yaml", "--json"], timeout)
    shown = _document(["inspect", str(step), "--json"], timeout) if draft and draft.get("links") else None
    if draft is None or shown is None:
        return Outcome(1, [""], sum(len(joint) == 6 for joint in truth["joints"]))
    return judged(truth, draft, shown["components"])


def judged(truth: Mapping[str, Any], draft: Mapping[str, Any], parts: Sequence[Mapping[str, Any]]) -> Outcome:
    """The outcome of a draft, as the command prints it, of an assembly of components, as ``inspect`` prints them."""
    result = Outcome(assemblies=1, joints=sum(len(joint) == 6 for joint in truth["joints"]))
    drafted = _assigned(
        parts, {one["name"]: [*one["parts"], *(["*rest*"] if one["rest"] else [])] for one in draft["links"]}
    )
    one = {link["name"]: link["name"] for link in draft["links"]}
    for joint in draft["joints"]:
        if joint["type"] == "fixed":
            one = {k: one[joint["parent"]] if v == one[joint["child"]] else v for k, v in one.items()}
    true = _assigned(parts, truth["links"])
    judged = {i: parts[i]["volume"] or 0.0 for i in true if true[i] != _IGNORED and parts[i]["body"] >= 0}
    shared: dict[tuple[str, str], float] = defaultdict(float)
    for i, volume in judged.items():
        if i in drafted:
            shared[one[drafted[i]], true[i]] += volume + 1e-15
    means: dict[str, str] = {}
    home: dict[str, str] = {}
    for d, t in sorted(shared, key=lambda key: (-shared[key], key)):
        if d not in means and t not in means.values():
            means[d] = t
        home.setdefault(t, d)
    right = sum(volume for i, volume in judged.items() if i in drafted and means.get(one[drafted[i]]) == true[i])
    result.volume = right / (sum(judged.values()) or 1.0)
    result.roots = int(means.get(one[draft["root"]]) == truth["root"])
    moving = [(j, j["parent"], j["child"]) for j in draft["joints"] if j["type"] != "fixed"]
    moving += [(j, j["link_a"], j["link_b"]) for j in draft["closures"]]
    _match(truth, [(j, {one[a], one[b]}) for j, a, b in moving], means, home, result)
    link_of = {part["path"]: true[i] for i, part in enumerate(parts) if i in true}
    for fused in draft["fused"]:
        sides = {link_of.get(fused["part"], _IGNORED), link_of.get(fused["with"], _IGNORED)}
        if _IGNORED not in sides:
            result.fused.append((fused["held_by"], _is_joint(fused, sides, truth)))
    return result


def _is_joint(drafted: Mapping[str, Any], sides: set[str], truth: Mapping[str, Any]) -> bool:
    """Whether the label has a drafted joint between two links, or between others on one pin with them."""
    kind = drafted["type"].replace("continuous", "revolute")
    return len(sides) > 1 and any(
        kind == joint[1] and _is_on(drafted, joint, truth) and sides <= _on_pin(joint, truth)
        for joint in truth["joints"]
    )


def _match(
    truth: Mapping[str, Any],
    moving: Sequence[tuple[dict[str, Any], set[str]]],
    means: Mapping[str, str],
    home: Mapping[str, str],
    result: Outcome,
) -> None:
    """Give each true joint the drafted one that fits best, and count."""
    taken: dict[int, bool] = {}
    for joint in truth["joints"]:
        wanted, required = {joint[2], joint[3]}, len(joint) == 6
        on_pin = _on_pin(joint, truth)
        best: tuple[int, int] | None = None
        for n, (drafted, ends) in enumerate(moving):
            if n in taken or not _is_on(drafted, joint, truth):
                continue
            sides = {means.get(end, "") for end in ends}
            both = sides == wanted or (len(on_pin) > 2 and len(ends) == 2 and sides <= on_pin)
            rank = 2 * both + (drafted["type"].replace("continuous", "revolute") == joint[1])
            if best is None or rank > best[0]:
                best = (rank, n)
        if best is None:
            continue
        rank, n = best
        is_merged = rank == 1 and moving[n][1] == {home.get(joint[2]), home.get(joint[3])} and len(moving[n][1]) == 2
        taken[n] = rank == 3 or is_merged
        result.found += rank == 3 and required
        result.merged += is_merged and required
    for n, (drafted, _) in enumerate(moving):
        result.judged.append((drafted["evidence"][0], taken.get(n, False), bool(drafted["review"])))
        if not taken.get(n):
            result.reviewed += bool(drafted["review"])
            result.unmarked += not drafted["review"]


def _is_on(drafted: Mapping[str, Any], joint: Sequence[Any], truth: Mapping[str, Any]) -> bool:
    """Whether a drafted axis is the true one within the accuracy of the label."""
    offset = 1e3 * np.array(drafted["point"]) - np.array(joint[4], float)
    axis = np.array(joint[5], float) / np.linalg.norm(joint[5])
    tolerance = truth.get("tol", 0.1)
    if drafted["direction"] is None:
        return bool(joint[1] == "ball" and np.linalg.norm(offset) < tolerance)
    sine = float(np.linalg.norm(np.cross(drafted["direction"], axis)))
    if sine > np.sin(np.radians(truth.get("angtol", 0.1))):
        return False
    slides = drafted["type"] == joint[1] == "prismatic"
    return bool(slides or np.linalg.norm(np.cross(offset, axis)) < tolerance)


def _on_pin(joint: Sequence[Any], truth: Mapping[str, Any]) -> set[str]:
    """Links that turn on the line of a joint and are reached from it: any tree of joints between them is right."""
    links, before = {joint[2], joint[3]}, 0
    while joint[1] == "revolute" and len(links) != before:
        before = len(links)
        for other in truth["joints"]:
            if other[1] == "revolute" and {other[2], other[3]} & links:
                as_drafted = {"type": "", "point": np.array(other[4], float) * 1e-3, "direction": other[5]}
                as_drafted["direction"] = np.array(other[5], float) / np.linalg.norm(other[5])
                links |= {other[2], other[3]} if _is_on(as_drafted, joint, truth) else set()
    return links


def _assigned(components: Sequence[Mapping[str, Any]], claims: Mapping[str, Sequence[str]]) -> dict[int, str]:
    """The link of each component by claims, as a sidecar's are read: the nearest one wins, one link has the rest."""
    placed = [
        Component(n, one["parent"], one["path"].rpartition("/")[2], one["path"], one["product"], "", 1)
        for n, one in enumerate(components)
    ]
    find = ComponentPaths(placed).find
    names = list(claims)
    rest = next((n for n, name in enumerate(names) if "*rest*" in claims[name]), -1)
    found = [(find(path).indices, n) for n, name in enumerate(names) for path in claims[name] if path != "*rest*"]
    owner = nearest_claim(placed, found, rest)
    return {i: names[owner[i]] for i in range(len(placed)) if owner[i] >= 0}


def _document(arguments: Sequence[str], timeout: float) -> dict[str, Any] | None:
    """The JSON that a command prints; None if it printed none in time."""
    try:
        run = subprocess.run([*STEPBOT, *arguments], capture_output=True, timeout=timeout, check=False)
        document: dict[str, Any] = json.loads(run.stdout)
    except (subprocess.TimeoutExpired, ValueError):
        return None
    return document
