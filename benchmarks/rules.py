"""What each rule of drafting earns: joints of the labelled assemblies that are lost without it.

``python -m benchmarks.rules`` leaves out one function of evidence at a time. ``--thresholds MODULE`` changes each
number of one module below ``stepbot.draft``, such as ``contacts.captured``, by a fifth down and up. ``--perturbed``
drafts the assemblies as other exports of the same robot have them: without names, subassemblies or screws, in another
order, mirrored, turned, and with parts moved at random (PCG64, seed 1).
"""

from argparse import ArgumentParser
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from ruamel.yaml import YAML

from stepbot.draft import inference
from stepbot.draft.contacts.survey import ALL_SOURCES, Sources
from stepbot.draft.draft_robot import infer
from stepbot.draft.evidence import rules
from stepbot.step.assembly import Assembly
from stepbot_cli.init import draft_document

from .drafts import Outcome, judged, labelled
from .exports import (
    Change,
    all_named,
    as_drawn,
    far_off,
    halved,
    mirrored,
    misplaced,
    reexported,
    reexported_mirrored,
    reframed,
    renamed,
    shaken,
    shuffled,
    turned,
    without_screws,
)
from .inference import corpus_folder, read_for_inference

_FIFTH = (0.8, 1.2)
Cases = Mapping[str, tuple[dict[str, Any], Assembly]]
"""The label and the assembly by name."""


def cases(corpus: Path) -> Cases:
    """All labelled assemblies but those that are held out."""
    yaml = YAML(typ="safe")
    return {
        label.stem: (yaml.load(label.read_text(encoding="utf-8")), read_for_inference(step))
        for group, label, step in labelled(corpus)
        if group != "held out"
    }


def total(of: Cases, sources: Sources = ALL_SOURCES, change: Change = as_drawn) -> Outcome:
    """The outcome of all assemblies, drafted in this process."""
    result = Outcome()
    for truth, drawn in of.values():
        assembly, placed = change(drawn, np.random.default_rng(1))
        document = draft_document(infer(assembly, "robot", sources), "")
        for joint in (*document["joints"], *document["closures"]):
            for key, w in (("point", 1.0), ("direction", 0.0)):
                joint[key] = joint[key] and np.linalg.solve(placed, [*joint[key], w])[:3].tolist()
        result.add(judged(truth, document, _components(assembly)))
    return result


def show_perturbed(of: Cases) -> None:
    """Print a row for each way to perturb the assemblies."""
    print("| | found | wrong, unmarked | wrong, REVIEW | root |\n| --- | --- | --- | --- | --- |")
    for name, sources, change in (
        ("as they are", ALL_SOURCES, as_drawn),
        ("without names", Sources(names=False), as_drawn),
        ("products named 'Part 1' and so on", ALL_SOURCES, renamed),
        ("without the tree", Sources(tree=False), as_drawn),
        ("without names and tree", Sources(names=False, tree=False), as_drawn),
        ("without screws", ALL_SOURCES, without_screws),
        ("components in another order", ALL_SOURCES, shuffled),
        ("bodies in other frames of their own", ALL_SOURCES, reframed),
        ("the whole mirrored", ALL_SOURCES, mirrored),
        ("the whole turned", ALL_SOURCES, turned),
        ("each occurrence a product of its own, drawn in place", ALL_SOURCES, reexported),
        ("the same mirrored", ALL_SOURCES, reexported_mirrored),
        ("round faces in two halves", ALL_SOURCES, halved),
        ("1 m off the origin along each axis", ALL_SOURCES, far_off),
        ("all named 'Body1'", ALL_SOURCES, all_named("Body1")),
        ("all named '\u96f6\u4ef6'", ALL_SOURCES, all_named("\u96f6\u4ef6")),
        ("all parts 50 µm and 0.25 mrad off", ALL_SOURCES, shaken(5e-5)),
        ("30 % of the pieces 0.2 mm and 1 mrad off", ALL_SOURCES, misplaced(2e-4)),
    ):
        found = total(of, sources, change)
        cells = (
            f"{found.found} of {found.joints}",
            found.unmarked,
            found.reviewed,
            f"{found.roots} of {found.assemblies}",
        )
        print(f"| {name} | {' | '.join(map(str, cells))} |", flush=True)


def ablated() -> Iterator[tuple[str, Any]]:
    """For each function of evidence, its name and the change that leaves it out."""
    every = list(rules())
    for left_out, _ in every:
        others = [row for row in every if row[0] is not left_out]
        yield getattr(left_out, "func", left_out).__name__, patch.object(inference, "rules", others.copy)
    yield "repeated_joints", patch.object(inference, "repeated_joints", lambda *_: [])


def changed(module: str) -> Iterator[tuple[str, Any]]:
    """For each number of a module, its change by a fifth down and up; counts of three and more are rounded."""
    home = import_module(f"stepbot.draft.{module}")
    for name, value in list(vars(home).items()):
        if name.startswith("_") and type(value) in (int, float) and abs(value) not in (0, 1, 2):
            for factor in _FIFTH:
                new = type(value)(round(value * factor) if type(value) is int else value * factor)
                yield f"{name} {value:g} to {new:g}", patch.object(home, name, new)


def _components(assembly: Assembly) -> list[dict[str, Any]]:
    """The components as ``inspect --json`` has them, as far as labels need them."""
    rows = []
    for c in assembly.components:
        exact = assembly.bodies[c.body].exact if c.body >= 0 else None
        volume = exact.volume if exact is not None else 0.0
        rows.append({"path": c.path, "parent": c.parent, "product": c.product, "body": c.body, "volume": volume})
    return rows


def show(of: Cases, changes: Callable[[], Iterator[tuple[str, Any]]]) -> None:
    """Print a row for each change."""
    print("| | found | wrong, unmarked | wrong, REVIEW |\n| --- | --- | --- | --- |")
    whole = total(of)
    print(f"| as it is | {whole.found} of {whole.joints} | {whole.unmarked} | {whole.reviewed} |")
    for name, change in changes():
        with change:
            one = total(of)
        print(f"| {name} | {one.found - whole.found:+d} | {one.unmarked} | {one.reviewed} |", flush=True)


def main() -> None:
    """Measure."""
    parser = ArgumentParser(prog="python -m benchmarks.rules", description=__doc__)
    parser.add_argument("--thresholds", metavar="MODULE")
    parser.add_argument("--perturbed", action="store_true")
    chosen = parser.parse_args()
    module = chosen.thresholds
    corpus = corpus_folder()
    if corpus is None:
        raise SystemExit("this needs the corpus of published assemblies: see STEPBOT_CORPUS")
    if chosen.perturbed:
        show_perturbed(cases(corpus))
        return
    show(cases(corpus), (lambda: changed(module)) if module else ablated)


if __name__ == "__main__":
    main()
