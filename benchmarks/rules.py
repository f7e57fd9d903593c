"""What each rule of drafting earns: joints of the labelled assemblies that are lost without it.

``python -m benchmarks.rules`` leaves out one function of evidence at a time. ``--thresholds MODULE`` changes each
number of one module below ``stepbot.draft``, such as ``contacts.captured``, by a fifth down and up.
"""

from argparse import ArgumentParser
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any
from unittest.mock import patch

from ruamel.yaml import YAML

from stepbot.draft import inference
from stepbot.draft.draft_robot import infer
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


def total(of: Cases) -> Outcome:
    """The outcome of all assemblies, drafted in this process."""
    result = Outcome()
    for truth, assembly in of.values():
        result.add(judged(truth, draft_document(infer(assembly, "robot"), ""), _components(assembly)))
    return result


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
    module = parser.parse_args().thresholds
    corpus = corpus_folder()
    if corpus is None:
        raise SystemExit("this needs the corpus of published assemblies: see STEPBOT_CORPUS")
    show(cases(corpus), (lambda: changed(module)) if module else ablated)


if __name__ == "__main__":
    main()
