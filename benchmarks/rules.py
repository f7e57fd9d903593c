"""What each rule of drafting earns: joints of the labelled assemblies that are lost without it.

``python -m benchmarks.rules`` leaves out one function of evidence at a time. ``--thresholds MODULE`` changes each
number of one module below ``stepbot.draft``, such as ``contacts.captured``, by a fifth down and up. ``--perturbed``
drafts the assemblies without names or subassemblies, turned, and with parts moved at random (PCG64, seed 1).
"""

from argparse import ArgumentParser
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from ruamel.yaml import YAML

from stepbot.draft import inference
from stepbot.draft.contacts.survey import ALL_SOURCES, Sources
from stepbot.draft.draft_robot import infer
from stepbot.geometry.spatial import IDENTITY, Array, Pose, rotation_about, unit
from stepbot.step.assembly import Assembly
from stepbot_cli.init import draft_document

from .drafts import Outcome, judged, labelled
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


Moves = Callable[[Assembly, np.random.Generator], dict[int, Pose]]
"""How components are moved in the assembly, by index; one that is not named is not moved."""


def as_drawn(_assembly: Assembly, _rng: np.random.Generator) -> dict[int, Pose]:
    """Nothing is moved."""
    return {}


def total(of: Cases, sources: Sources = ALL_SOURCES, moves: Moves = as_drawn) -> Outcome:
    """The outcome of all assemblies, drafted in this process; where everything is moved alike, the labels are, too."""
    result = Outcome()
    for truth, assembly in of.values():
        by = moves(assembly, np.random.default_rng(1))
        placed = [replace(c, X_WC=by[c.index] @ c.X_WC) if c.index in by else c for c in assembly.components]
        document = draft_document(infer(replace(assembly, components=tuple(placed)), "robot", sources), "")
        alike = set(by.values()) if len(by) == len(assembly.components) - 1 else set()
        back = alike.pop().inverse() if len(alike) == 1 else IDENTITY
        for joint in (*document["joints"], *document["closures"]):
            for key, move in (("point", back.apply), ("direction", back.turn)):
                joint[key] = None if joint[key] is None else move(joint[key]).tolist()
        result.add(judged(truth, document, _components(assembly)))
    return result


def _moved_about(rng: np.random.Generator, middle: Array, far: float) -> Pose:
    """A random motion by ``far`` [m], and by 5 mrad per millimetre of it about a point; normal, for each axis."""
    turn, shift = rng.normal(size=(2, 3)) * far
    R = rotation_about(unit(turn), 5.0 * float(np.linalg.norm(turn)))
    return Pose.of(R, middle - R @ middle + shift)


def turned(assembly: Assembly, rng: np.random.Generator) -> dict[int, Pose]:
    """Everything turned alike, and moved by some 0.5 m."""
    q = rng.normal(size=4)
    X = Pose.from_quaternion((q / np.linalg.norm(q)).tolist(), 0.3 * rng.normal(size=3))
    return dict.fromkeys(range(1, len(assembly.components)), X)


def shaken(far: float) -> Moves:
    """Each body moved by itself, about its centre of mass."""

    def moves(assembly: Assembly, rng: np.random.Generator) -> dict[int, Pose]:
        found = {}
        for c in assembly.components:
            exact = assembly.bodies[c.body].exact if c.body >= 0 else None
            if exact is not None:
                found[c.index] = _moved_about(rng, c.X_WC.apply(np.array(exact.unit_density.com)), far)
        return found

    return moves


def misplaced(far: float, share: float = 0.3) -> Moves:
    """A share of the pieces at the top of the tree moved, each as a whole."""

    def moves(assembly: Assembly, rng: np.random.Generator) -> dict[int, Pose]:
        top = 0
        while len(assembly.children[top]) == 1:
            top = assembly.children[top][0]
        found = {}
        for piece in assembly.children[top]:
            if rng.random() < share:
                below = assembly.subtree(piece)
                middle = np.mean([assembly.components[i].X_WC.p for i in below], axis=0)
                found.update(dict.fromkeys(below, _moved_about(rng, middle, far)))
        return found

    return moves


def show_perturbed(of: Cases) -> None:
    """Print a row for each way to perturb the assemblies."""
    print("| | found | wrong, unmarked | wrong, REVIEW | root |\n| --- | --- | --- | --- | --- |")
    for name, sources, moves in (
        ("as they are", ALL_SOURCES, as_drawn),
        ("without names", Sources(names=False), as_drawn),
        ("without names and tree", Sources(names=False, tree=False), as_drawn),
        ("the whole turned", ALL_SOURCES, turned),
        ("all parts 50 µm and 0.25 mrad off", ALL_SOURCES, shaken(5e-5)),
        ("30 % of the pieces 0.2 mm and 1 mrad off", ALL_SOURCES, misplaced(2e-4)),
    ):
        found = total(of, sources, moves)
        cells = (
            f"{found.found} of {found.joints}",
            found.unmarked,
            found.reviewed,
            f"{found.roots} of {found.assemblies}",
        )
        print(f"| {name} | {' | '.join(map(str, cells))} |", flush=True)


def ablated() -> Iterator[tuple[str, Any]]:
    """For each function of evidence, its name and the change that leaves it out."""
    for name in vars(inference):
        if name.endswith("_evidence") and name != "fact_evidence":
            yield name, patch.object(inference, name, _nothing)
    yield "repeated_joints", patch.object(inference, "repeated_joints", lambda *_: [])


def changed(module: str) -> Iterator[tuple[str, Any]]:
    """For each number of a module, its change by a fifth down and up; counts of three and more are rounded."""
    home = import_module(f"stepbot.draft.{module}")
    for name, value in list(vars(home).items()):
        if name.startswith("_") and type(value) in (int, float) and abs(value) not in (0, 1, 2):
            for factor in _FIFTH:
                new = type(value)(round(value * factor) if type(value) is int else value * factor)
                yield f"{name} {value:g} to {new:g}", patch.object(home, name, new)


def _nothing(*_: object, **__: object) -> None:
    """No evidence."""


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
