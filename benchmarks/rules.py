"""What each rule of drafting earns: joints of the labelled assemblies that are lost without it.

``python -m benchmarks.rules`` leaves out one function of evidence at a time. ``--thresholds MODULE`` changes each
number of one module below ``stepbot.draft``, such as ``contacts.captured``, by a fifth down and up. ``--perturbed``
drafts the assemblies as other exports of the same robot have them: without names, subassemblies or screws, in another
order, mirrored, turned, and with parts moved at random (PCG64, seed 1).
"""

from argparse import ArgumentParser
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from ruamel.yaml import YAML

from stepbot.draft import inference
from stepbot.draft.contacts.survey import ALL_SOURCES, Sources, Survey
from stepbot.draft.draft_robot import infer
from stepbot.geometry.spatial import Array, Pose, rotation_about, unit
from stepbot.geometry.volume import VolumeProperties
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


Change = Callable[[Assembly, np.random.Generator], tuple[Assembly, Array]]
"""Gives the changed assembly, and the map (4, 4) that takes the old place of a point to the new one."""


def as_drawn(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Nothing is changed."""
    return assembly, np.eye(4)


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


def _moved_about(rng: np.random.Generator, middle: Array, far: float) -> Pose:
    """A random motion by ``far`` [m], and by 5 mrad per millimetre of it about a point; normal, for each axis."""
    turn, shift = rng.normal(size=(2, 3)) * far
    R = rotation_about(unit(turn), 5.0 * float(np.linalg.norm(turn)))
    return Pose.of(R, middle - R @ middle + shift)


def turned(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Everything turned alike, and moved by some 0.5 m."""
    q = rng.normal(size=4)
    X = Pose.from_quaternion((q / np.linalg.norm(q)).tolist(), 0.3 * rng.normal(size=3))
    placed = np.block([[X.R, np.array(X.p)[:, None]], [np.zeros(3), 1.0]])
    return _moved(assembly, dict.fromkeys(range(1, len(assembly.components)), X)), placed


def shaken(far: float) -> Change:
    """Each part moved by itself, about its centre of mass; the bodies of a product of several stay in place in it."""

    def change(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
        found: dict[int, Pose] = {}
        of: dict[int, Pose] = {}
        for c in assembly.components:
            exact = assembly.bodies[c.body].exact if c.body >= 0 else None
            if exact is not None:
                part = c.index if c.product or c.parent <= 0 else c.parent
                if part not in of:
                    of[part] = _moved_about(rng, c.X_WC.apply(np.array(exact.unit_density.com)), far)
                found[c.index] = of[part]
        return _moved(assembly, found), np.eye(4)

    return change


def misplaced(far: float, share: float = 0.3) -> Change:
    """A share of the pieces at the top of the tree moved, each as a whole."""

    def change(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
        top = 0
        while len(assembly.children[top]) == 1:
            top = assembly.children[top][0]
        found = {}
        for piece in assembly.children[top]:
            if rng.random() < share:
                below = assembly.subtree(piece)
                middle = np.mean([assembly.components[i].X_WC.p for i in below], axis=0)
                found.update(dict.fromkeys(below, _moved_about(rng, middle, far)))
        return _moved(assembly, found), np.eye(4)

    return change


def _moved(assembly: Assembly, by: Mapping[int, Pose]) -> Assembly:
    """With components moved in the assembly, by their indices."""
    placed = [replace(c, X_WC=by[c.index] @ c.X_WC) if c.index in by else c for c in assembly.components]
    return replace(assembly, components=tuple(placed))


def mirrored(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """The whole mirrored in y, each body in its own y."""
    signs = np.array([1.0, -1.0, 1.0])
    return _reflected(assembly, signs, [signs] * len(assembly.bodies)), np.diag([*signs, 1.0])


def reframed(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Each body drawn in a frame of its own that is turned by half a turn, about x, y or z; all stay in place."""
    half_turns = 2.0 * np.eye(3) - 1.0
    signs = [half_turns[k] for k in rng.integers(3, size=len(assembly.bodies))]
    return _reflected(assembly, np.ones(3), signs), np.eye(4)


def _reflected(assembly: Assembly, whole: Array, bodies: Sequence[Array]) -> Assembly:
    """With the signs of coordinates changed: those of the assembly, and those of each body's frame."""
    changed = []
    for body, signs in zip(assembly.bodies, bodies, strict=True):
        exact = body.exact
        if exact is not None:
            of = exact.unit_density
            exact = VolumeProperties.of(
                of.mass, np.array(of.com) * signs, np.array(of.inertia) * np.outer(signs, signs)
            )
        faces = tuple(face.scaled(signs, 1.0) for face in body.faces)
        changed.append(replace(body, exact=exact, faces=faces))
    placed = []
    for c in assembly.components:
        signs = bodies[c.body] if c.body >= 0 else whole
        placed.append(replace(c, X_WC=Pose.of(whole[:, None] * c.X_WC.R * signs, whole * c.X_WC.p)))
    return replace(assembly, components=tuple(placed), bodies=tuple(changed))


def shuffled(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
    """The children of each component in another order."""

    def below(index: int) -> Iterator[int]:
        yield index
        for child in rng.permutation(np.array(assembly.children[index], dtype=int)).tolist():
            yield from below(child)

    return _only(assembly, list(below(0))), np.eye(4)


def without_screws(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """What is named or shaped as a fastener left out."""
    small = Survey(assembly, ALL_SOURCES).small
    return _only(assembly, [c.index for c in assembly.components if c.index not in small]), np.eye(4)


def _only(assembly: Assembly, order: Sequence[int]) -> Assembly:
    """With some of the components, in another order."""
    row = {old: new for new, old in enumerate(order)}
    some = [replace(assembly.components[old], index=row[old]) for old in order]
    return replace(assembly, components=tuple(replace(c, parent=row.get(c.parent, -1)) for c in some))


def renamed(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Products named by a number alone, their occurrences not at all."""
    names = [f"Part {c.definition}" if c.product else "" for c in assembly.components]
    some = [replace(c, product=name, occurrence="") for c, name in zip(assembly.components, names, strict=True)]
    return replace(assembly, components=tuple(some)), np.eye(4)


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
