"""Reads thousands of damaged STEP files, and reports those that reveal a bug."""

import argparse
import contextlib
import json
import queue
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from msgspec import Struct

from tests.conftest import ROOT

from . import bases as base_files
from .judge import FAILED, OUT_OF_TIME, OUTCOMES, Verdict
from .mutant import ALL_KINDS, Mutant, plan
from .runner import TIMEOUT

PATIENCE = 4 * TIMEOUT + 60.0
"""Seconds after which stepbot's process counts as hung: twice the sum of two readings at the kernel's limit."""


class Named(Protocol):
    """A mutant as its runner identifies it."""

    @property
    def name(self) -> str:
        """The name from which the runner creates it."""
        ...


M = TypeVar("M", bound=Named)


class Trial(Struct, Generic[M], frozen=True):
    """A mutant and its outcome."""

    mutant: M
    verdict: Verdict
    seconds: float


class _Runner:
    """A process in place of stepbot's; it is replaced when it dies."""

    def __init__(self, bases: Path, runner: str) -> None:
        self._bases, self._runner = bases, runner
        self._process: subprocess.Popen[str] | None = None

    def try_out(self, mutant: Named) -> Verdict:
        process = self._process or self._start()
        assert process.stdin is not None
        assert process.stdout is not None
        timed_out = threading.Event()

        def end() -> None:
            timed_out.set()
            process.kill()

        timer = threading.Timer(PATIENCE, end)
        timer.start()
        try:
            process.stdin.write(mutant.name + "\n")
            process.stdin.flush()
            line = process.stdout.readline()
        except BrokenPipeError:
            line = ""
        finally:
            timer.cancel()
        if line:
            return _parsed(line)
        status = process.wait()
        self.close()
        how = f"hangs for {PATIENCE:g} s" if timed_out.is_set() else f"ended with status {status}"
        return Verdict(FAILED, faults=(f"stepbot's own process {how}",))

    def close(self) -> None:
        if self._process is not None:
            assert self._process.stdin is not None
            assert self._process.stdout is not None
            with contextlib.suppress(BrokenPipeError):  # it has died already
                self._process.stdin.close()
            self._process.wait()
            self._process.stdout.close()
            self._folder.cleanup()
            self._process = None

    def _start(self) -> "subprocess.Popen[str]":
        self._folder = tempfile.TemporaryDirectory(prefix="stepbot-mutants-")
        command = [sys.executable, "-m", self._runner, str(self._bases), self._folder.name]
        self._process = subprocess.Popen(
            command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8"
        )
        return self._process


def try_all(mutants: Sequence[M], bases: Path, *, jobs: int, runner: str = "tests.fuzz.runner") -> Iterator[Trial[M]]:
    """Try mutants, several at once; yields their trials as they end."""
    waiting: queue.SimpleQueue[M | None] = queue.SimpleQueue()
    done: queue.SimpleQueue[Trial[M] | BaseException | None] = queue.SimpleQueue()
    for mutant in (*mutants, *[None] * jobs):
        waiting.put(mutant)

    def work() -> None:
        player = _Runner(bases, runner)
        try:
            while (mutant := waiting.get()) is not None:
                start = time.monotonic()
                verdict = player.try_out(mutant)
                done.put(Trial(mutant, verdict, time.monotonic() - start))
        except BaseException as error:  # noqa: BLE001 - raised where the trials are taken
            done.put(error)
        finally:
            player.close()
            done.put(None)

    threads = [threading.Thread(target=work, daemon=True) for _ in range(jobs)]
    for thread in threads:
        thread.start()
    working = jobs
    try:
        while working:
            ended = done.get()
            if isinstance(ended, BaseException):
                raise ended
            if ended is None:
                working -= 1
            else:
                yield ended
    finally:  # when no more trials are requested, wait for the running ones
        with contextlib.suppress(queue.Empty):
            while True:
                waiting.get_nowait()
        for _ in threads:
            waiting.put(None)
        for thread in threads:
            thread.join()


def table(trials: Sequence[Trial[Mutant]]) -> str:
    """Table of outcomes by kind of damage, and the number of each error."""
    counts = Counter((trial.mutant.kind, trial.verdict.outcome) for trial in trials)
    rows = [["", *OUTCOMES, "all"]]
    for kind in ALL_KINDS:
        of_kind = [counts[kind, outcome] for outcome in OUTCOMES]
        rows.append([kind, *map(str, of_kind), str(sum(of_kind))])
    totals = [sum(counts[kind, outcome] for kind in ALL_KINDS) for outcome in OUTCOMES]
    rows.append(["all", *map(str, totals), str(sum(totals))])
    lines = ["".join(cell.ljust(12) if not i else cell.rjust(13) for i, cell in enumerate(row)) for row in rows]
    codes = Counter(code for trial in trials for code in dict.fromkeys(trial.verdict.codes))
    return "\n".join([*lines, "", "errors: " + ", ".join(f"{code} {count}" for code, count in sorted(codes.items()))])


def described(trial: Trial[Mutant]) -> str:
    """Describe a mutant that found a defect, with the command that repeats it."""
    faults = "\n".join(trial.verdict.faults)
    return f"{trial.mutant.name}\n{faults}\n  python -m tests.fuzz.mutants --only '{trial.mutant.name}' --keep DIR\n"


def _parsed(line: str) -> Verdict:
    fields = json.loads(line)
    codes, notes, faults = (tuple(fields[name]) for name in ("codes", "notes", "faults"))
    return Verdict(fields["outcome"], codes, fields["message"], notes, faults)


def _keep(trial: Trial[Mutant], bases: Path, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / trial.mutant.file_name
    path.write_bytes(trial.mutant.content(bases))
    verdict = trial.verdict
    reported = "\n".join((trial.mutant.name, verdict.outcome, verdict.message, *verdict.notes, *verdict.faults))
    path.with_suffix(".txt").write_text(reported + "\n", encoding="utf-8", newline="\n")


def _arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz.mutants", description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=2000, help="how many mutants (2000)")
    parser.add_argument("--seed", type=int, default=1, help="of the random choices (1)")
    parser.add_argument("--jobs", type=int, default=2, help="how many at once (2)")
    parser.add_argument(
        "--keep", type=Path, metavar="DIR", help="where to put mutants that find faults or end the kernel"
    )
    parser.add_argument("--only", nargs="+", metavar="NAME", help="try these mutants, base:kind:seed:number")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> int:
    """Try the mutants; returns 1 if any finds a defect."""
    arguments = _arguments(argv)
    if base_files.absent():
        sys.stdout.write(f"\n*** NOT TRIED: {base_files.absent()}\n*** mutants of drawings alone prove less\n\n")
    with tempfile.TemporaryDirectory(prefix="stepbot-bases-") as folder:
        bases = Path(folder)
        subprocess.run([sys.executable, "-m", "tests.fuzz.bases", folder], cwd=ROOT, check=True)
        if arguments.only:
            mutants = [Mutant.named(name) for name in arguments.only]
        else:
            mutants = plan(base_files.names(bases), arguments.count, arguments.seed)
        trials = []
        for trial in try_all(mutants, bases, jobs=arguments.jobs):
            trials.append(trial)
            if arguments.only:
                sys.stdout.write(f"{trial.mutant.name}: {trial.verdict.outcome} {trial.verdict.message}\n")
            ended_badly = trial.verdict.outcome in (FAILED, "kernel died", OUT_OF_TIME)
            if arguments.keep and (ended_badly or arguments.only):
                _keep(trial, bases, arguments.keep)
            if len(trials) % 100 == 0:
                sys.stdout.write(f"{len(trials)} of {len(mutants)}\n")
                sys.stdout.flush()
    failed = sorted((t for t in trials if t.verdict.faults), key=lambda trial: trial.mutant.number)
    sys.stdout.write("\n" + table(trials) + "\n\n" + "\n".join(map(described, failed)))
    sys.stdout.write(f"{len(failed)} of {len(trials)} mutants found a fault\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
