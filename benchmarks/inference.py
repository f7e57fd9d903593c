"""Quality of links and joints inferred from plain STEP files, robot by robot.

    full       with names and subassemblies
    nameless   without names
    bare       without names and subassemblies

``to 1e-6`` counts the found joints whose axis is within 1e-6 m and 1e-6 rad of the reference; ``not drawn`` those of
the others whose reference axis the faces of one link or both do not have, because one or the other is rounded.

The robots are those of the library, and the real assemblies of the corpus that have a hand-written sidecar.
"""

import os
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from stepbot.authoring.inference import infer_mechanism
from stepbot.authoring.survey import Sources
from stepbot.diagnostics import Diagnostics
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
_HEADS = ("found", "to 1e-6", "not drawn", "seen", "precision", "wrong (unmarked)", "volume in the right link", "root")


@dataclass(frozen=True)
class Subject:
    """An assembly and its sidecar with the true joints, if there is one."""

    name: str
    group: str
    step: Path
    truth: Path | None = None


def subjects(corpus: Path | None) -> Iterator[Subject]:
    """The library, then the available part of the corpus."""
    for sidecar in sorted((ROOT / "robot_library").glob("*/*.robot.yaml")):
        (step,) = sidecar.parent.glob("*.step")
        yield Subject(sidecar.parent.name, "library", step, sidecar)
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


def measure(corpus: Path | None, only: str = "") -> None:
    """Print a row per robot and mode, then the sums of each group."""
    sums: dict[tuple[str, str], list[Score]] = {}
    print(f"{'':28}{'':10}" + "".join(f"{head:>{_width(head)}}" for head in _HEADS))
    for subject in subjects(corpus):
        if only not in subject.name:
            continue
        assembly = _read(subject.step)
        for mode, sources in MODES.items():
            start = time.perf_counter()
            inferred = infer_mechanism(assembly, sources)
            seconds = time.perf_counter() - start
            if subject.truth is None:
                arcs = [arc for arc in inferred.arcs if arc.hinge.type != JointKind.FIXED]
                unmarked = sum(map(is_unmarked, arcs))
                print(f"{subject.name:28}{mode:10}  {len(arcs)} joints drafted, {unmarked} unmarked")
                continue
            result = score(inferred, read_truth(subject.truth, assembly))
            sums.setdefault((subject.group, mode), []).append(result)
            print(f"{subject.name:28}{mode:10}{_row([result])}  {seconds:.1f} s", flush=True)
    for (group, mode), results in sums.items():
        print(f"{group:28}{mode:10}{_row(results)}")


def corpus_folder() -> Path | None:
    """The folder of real assemblies: ``STEPBOT_CORPUS``, or next to the checkout; None if there is none."""
    folder = Path(os.environ.get("STEPBOT_CORPUS") or ROOT.parent / "shared" / "corpus")
    return folder if folder.is_dir() else None


def _read(step: Path) -> Assembly:
    found = Diagnostics()
    assembly = read_assembly(step, ReadOptions(tolerance=_COARSE, faces=True), found)
    if assembly is None:
        raise SystemExit(f"{step}: {'; '.join(d.message for d in found)}")
    return assembly


def _row(results: Iterable[Score]) -> str:
    rows = list(results)
    counts = "true", "found", "exact", "undrawn", "seen", "drafted"
    true, found, exact, undrawn, seen, drafted = (sum(getattr(r, name) for r in rows) for name in counts)
    wrong, unmarked = sum(len(r.wrong) for r in rows), sum(r.unmarked for r in rows)
    volume = sum(r.volume for r in rows) / len(rows)
    cells = (
        f"{found}/{true}",
        f"{exact}/{found}",
        f"{undrawn}",
        f"{seen}/{true}",
        f"{found / max(1, drafted):.0%}",
        f"{wrong} ({unmarked})",
        f"{volume:.1%}",
        f"{sum(r.root for r in rows)}/{len(rows)}",
    )
    return "".join(f"{cell:>{_width(head)}}" for cell, head in zip(cells, _HEADS, strict=True))


def _width(head: str) -> int:
    return max(len(head), len("000/000")) + 2
