"""``make mutants``: do the tests notice small changes of the source?

400 random mutants of the rooms that decide what a robot is, each run against the tests that call the changed function.
A mutant whose tests still pass is a survivor. The sample depends on the source and the seed alone; results are kept in
``build/mutants``, so that a run can be continued.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

from . import runner
from .changes import Mutant, sample

ROOMS = ("robot", "step", "assemble", "formats", "verification", "draft")
_ROOT = Path(__file__).resolve().parents[2]
_TESTS = tuple(f"tests/unit/{room}" for room in (*ROOMS, "described", "engines", "pipeline", "geometry"))
_MOST_SECONDS = 40.0
"""Time [s] of the tests that one mutant is run against: the quickest ones that reach it."""


def main() -> int:
    """Run the mutants; returns 1 if fewer than 90 % are noticed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=400, help="number of mutants")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=1e9, help="stop after this time, to be continued")
    chosen = parser.parse_args()
    kept = _ROOT / "build" / "mutants"
    kept.mkdir(parents=True, exist_ok=True)
    deadline = time.monotonic() + chosen.seconds
    mutants = sample(_ROOT, ROOMS, chosen.n, chosen.seed)
    results = _read(kept / "results.json")
    with tempfile.TemporaryDirectory(prefix="mutants-") as place:
        folder = runner.copied(_ROOT, Path(place))
        os.environ["STEPBOT_NO_CACHE"] = "1"
        runner.preload()
        reached = _reached(folder, kept / "reached.json", deadline)
        for mutant in mutants:
            if str(mutant) in results or time.monotonic() > deadline:
                continue
            results[str(mutant)] = _judged(folder, mutant, reached)
            print(f"{results[str(mutant)]:8} {mutant}", flush=True)
            (kept / "results.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
    return _report([results[str(mutant)] for mutant in mutants if str(mutant) in results], len(mutants))


def _report(outcomes: list[str], total: int) -> int:
    survivors = sum(outcome in (runner.PASSED, "not run") for outcome in outcomes)
    share = 1.0 - survivors / len(outcomes) if outcomes else 0.0
    print(f"{len(outcomes)} of {total} mutants run, {share:.1%} noticed, {survivors} survivors")
    return 0 if share >= 0.9 else 1


def _reached(folder: Path, kept: Path, deadline: float) -> runner.Reached:
    """Tests by function, found once and kept; files of tests are run one by one."""
    files = sorted(
        path.relative_to(folder).as_posix() for place in _TESTS for path in (folder / place).rglob("test_*.py")
    )
    known = _read(kept)
    for file in files:
        if file not in known and time.monotonic() < deadline:
            known[file] = runner.reached_by(folder, [file], 300.0)
            kept.write_text(json.dumps(known), encoding="utf-8")
    reached: runner.Reached = {}
    for functions in known.values():
        for key, tests in functions.items():
            reached.setdefault(key, {}).update(tests)
    return reached


def _judged(folder: Path, mutant: Mutant, reached: runner.Reached) -> str:
    """Whether the tests that reach a mutant notice it; the quickest ones first, up to a time limit."""
    own, below = f"{mutant.file}:{mutant.first_line}", f"{mutant.file}:"
    tests = dict(reached.get(own, {})) if mutant.first_line else {}
    if not tests:  # a constant, or a function that another process calls: whatever uses the module
        for key, found in reached.items():
            if key.startswith(below):
                tests.update(found)
    chosen, seconds = [], 0.0
    for test in sorted(tests, key=lambda one: (tests[one], one)):
        if seconds + tests[test] > _MOST_SECONDS and chosen:
            break
        chosen.append(test)
        seconds += tests[test]
    if not chosen:
        return "not run"
    file, text = folder / mutant.file, (folder / mutant.file).read_bytes()
    try:
        file.write_bytes(mutant.applied(text))
        return runner.outcome(folder, chosen, 5.0 * seconds + 60.0)
    finally:
        file.write_bytes(text)


def _read(path: Path) -> dict[str, object]:
    return dict(json.loads(path.read_text(encoding="utf-8"))) if path.exists() else {}


if __name__ == "__main__":
    sys.exit(main())
