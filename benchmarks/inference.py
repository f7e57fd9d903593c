"""Quality of links and joints inferred from plain STEP files, robot by robot.

    full       with names and subassemblies
    nameless   without names
    bare       without names and subassemblies

``to 1e-6`` counts the found joints whose axis is within 1e-6 m and 1e-6 rad of the reference; ``not drawn`` those of
the others whose reference axis the faces of one link or both do not have, because one or the other is rounded.

The robots are those of the library, and the real assemblies of the corpus that have a hand-written sidecar.
"""

import os
import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from msgspec import Struct

from stepbot.diagnostics import Diagnostics
from stepbot.draft.contacts.survey import Sources
from stepbot.draft.inference import infer_mechanism
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly, MeshTolerance, ReadOptions
from stepbot.step.reader import read_assembly

from .contenders import ROOT
from .scoring import Score, is_unmarked, score
from .truth import read_truth

MODES = {"full": Sources(), "nameless": Sources(names=False), "bare": Sources(names=False, tree=False)}
"""Sources of evidence that inference may use."""
_COARSE = MeshTolerance(relative=0.05, angle=0.8)
"""Coarse: meshes are not compared here."""
_NO_ROBOTS = ("as1-oc-214", "dm1_ideas_inch", "eight_cylinders_multi_root", "rotor_pump_ap203", "s1_autocad_foot")
_TABLE = re.compile(r"(<!-- inference -->\n).*?(<!-- end -->)", re.DOTALL)
_COLUMNS = {
    ("library", "full"): "library, as it is",
    ("library", "nameless"): "without names",
    ("library", "bare"): "without names and tree",
    ("real", "full"): "real, as they are",
    ("real", "nameless"): "without names",
    ("real", "bare"): "without names and tree",
}
_CELLS: dict[str, Callable[["Total"], str]] = {
    "found": lambda of: f"{of.found} of {of.true}",
    "axis to 1e-6 m and rad": lambda of: f"{of.exact} of {of.found}",
    "axis not drawn to 1e-6": lambda of: f"{of.undrawn}",
    "seen": lambda of: f"{of.seen} of {of.true}",
    "right among those drafted": lambda of: f"{of.found / max(1, of.drafted):.0%}".replace("%", " %"),
    "wrong without a mark": lambda of: f"{of.unmarked}",
    "volume in the right link": lambda of: f"{of.volume:.1%}".replace("%", " %"),
}
_HEADS = ("found", "to 1e-6", "not drawn", "seen", "precision", "wrong (unmarked)", "volume in the right link", "root")


class Subject(Struct, frozen=True):
    """An assembly and its sidecar with the true joints, if there is one."""

    name: str
    group: str
    step: Path
    truth: Path | None = None


def subjects(corpus: Path | None) -> Iterator[Subject]:
    """The library, then the available part of the corpus."""
    for step in sorted((ROOT / "robot_library").glob("*/*.step")):
        yield Subject(step.parent.name, "library", step, step.with_suffix(".robot.yaml"))
    if corpus is None:
        return
    for sidecar in sorted((corpus / "joints").glob("*.robot.yaml")):
        name = sidecar.name.removesuffix(".robot.yaml")
        (step,) = (path for path in corpus.glob("*.step") if path.name in sidecar.read_text(encoding="utf-8"))
        yield Subject(name, "real", step, sidecar)
    follower = "low_cost_robot_follower"
    yield Subject(follower, "real", corpus / f"{follower}.step", ROOT / "tests" / "corpus" / f"{follower}.robot.yaml")
    for name in _NO_ROBOTS:
        yield Subject(name, "no robot", corpus / f"{name}.step")


def measure(corpus: Path | None, only: str = "") -> dict[tuple[str, str], list[Score]]:
    """Print a row per robot and mode, then the sums of each group; returns the scores of each group and mode."""
    sums: dict[tuple[str, str], list[Score]] = {}
    print(f"{'':28}{'':10}" + "".join(f"{head:>{_width(head)}}" for head in _HEADS))
    for subject in subjects(corpus):
        if only not in subject.name:
            continue
        assembly = read_for_inference(subject.step)
        for mode, sources in MODES.items():
            start = time.perf_counter()
            inferred = infer_mechanism(assembly, sources)
            seconds = time.perf_counter() - start
            if subject.truth is None:
                arcs = [arc for arc in inferred.arcs if arc.evidence.type != JointKind.FIXED]
                unmarked = sum(map(is_unmarked, arcs))
                print(f"{subject.name:28}{mode:10}  {len(arcs)} joints drafted, {unmarked} unmarked")
                continue
            result = score(inferred, read_truth(subject.truth, assembly))
            sums.setdefault((subject.group, mode), []).append(result)
            print(f"{subject.name:28}{mode:10}{_row([result])}  {seconds:.1f} s", flush=True)
    for (group, mode), results in sums.items():
        print(f"{group:28}{mode:10}{_row(results)}")
    return sums


def page_with_table(text: str, sums: Mapping[tuple[str, str], Sequence[Score]]) -> str:
    """The page with the table between its markers."""
    columns = [results for group, mode in _COLUMNS if (results := sums.get((group, mode)))]
    if len(columns) < len(_COLUMNS):
        raise SystemExit("the table needs the library and the corpus of real assemblies: see STEPBOT_CORPUS")
    rows = [["", *(_COLUMNS[key] for key in _COLUMNS)], ["---"] * (len(columns) + 1)]
    for head, cell in _CELLS.items():
        rows.append([head, *(cell(Total(results)) for results in columns)])
    lines = "".join(f"| {' | '.join(row)} |\n".replace("|  |", "| |") for row in rows)
    return _TABLE.sub(lambda match: match[1] + lines + match[2], text)


def corpus_folder() -> Path | None:
    """The folder of real assemblies: ``STEPBOT_CORPUS``, or next to the checkout; None if there is none."""
    folder = Path(os.environ.get("STEPBOT_CORPUS") or ROOT.parent / "shared" / "corpus")
    return folder if folder.is_dir() else None


def read_for_inference(step: Path) -> Assembly:
    """Read with its faces; exits if it cannot be read."""
    diagnostics = Diagnostics()
    assembly = read_assembly(step, ReadOptions(tolerance=_COARSE, faces=True), diagnostics)
    if assembly is None:
        raise SystemExit(f"{step}: {'; '.join(d.message for d in diagnostics)}")
    return assembly


class Total:
    """Sums of the scores of several robots."""

    def __init__(self, results: Sequence[Score]) -> None:
        self.robots = len(results)
        self.true, self.found = sum(r.true for r in results), sum(r.found for r in results)
        self.exact, self.undrawn = sum(r.exact for r in results), sum(r.undrawn for r in results)
        self.seen, self.drafted = sum(r.seen for r in results), sum(r.drafted for r in results)
        self.wrong, self.unmarked = sum(len(r.wrong) for r in results), sum(r.unmarked for r in results)
        self.volume, self.roots = sum(r.volume for r in results) / len(results), sum(r.root for r in results)


def _row(results: Sequence[Score]) -> str:
    of = Total(results)
    cells = (
        f"{of.found}/{of.true}",
        f"{of.exact}/{of.found}",
        f"{of.undrawn}",
        f"{of.seen}/{of.true}",
        f"{of.found / max(1, of.drafted):.0%}",
        f"{of.wrong} ({of.unmarked})",
        f"{of.volume:.1%}",
        f"{of.roots}/{of.robots}",
    )
    return "".join(f"{cell:>{_width(head)}}" for cell, head in zip(cells, _HEADS, strict=True))


def _width(head: str) -> int:
    return max(len(head), len("000/000")) + 2
