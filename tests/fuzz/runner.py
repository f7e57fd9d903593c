"""A process in place of stepbot's for many mutants in turn: a crash here would be one of the command.

python -m tests.fuzz.runner BASES FOLDER        reads names of mutants, one per line; answers each with a line of JSON
"""

import json
import sys
from pathlib import Path

from msgspec.structs import asdict, replace

from stepbot.diagnostics import Diagnostics
from stepbot.step.assembly import Assembly, ReadOptions
from stepbot.step.exchange.file_set import check_files
from stepbot.step.reader import Reading, start_reading

from .forking import ForkServer, can_fork
from .judge import FAILED, OUT_OF_TIME, Read, Verdict, judge
from .mutant import Mutant

FUNCTION = "stepbot.step.worker:read"
TIMEOUT = 60.0
"""Time limit [s] for one file; the bases take less than one."""
MEMORY_LIMIT = 4 << 30
"""Address space [bytes] of the kernel's process."""
SAMPLE = 40
"""Every so many mutants, one is read in both ways: by the fork server, and by a worker."""


def read_plainly(step: Path, diagnostics: Diagnostics) -> Assembly | None:
    """Read a STEP file as every conversion does: in a new worker, which loads the kernel."""
    return start_reading(step, ReadOptions(), memory_limit=MEMORY_LIMIT).finish(diagnostics, timeout=TIMEOUT)


def reading_by(server: ForkServer) -> Read:
    """The same reading, by a worker forked from a server."""

    def read(step: Path, diagnostics: Diagnostics) -> Assembly | None:
        looked = Diagnostics()
        files = check_files(step, str(step), looked)
        worker = None if files is None else server.call(files, ReadOptions())
        return Reading(worker, None, str(step), looked).finish(diagnostics, timeout=TIMEOUT)

    return read


def try_out(mutant: Mutant, bases: Path, folder: Path, read: Read, *, also_plainly: bool) -> Verdict:
    """Create a mutant and judge its outcome; with ``also_plainly`` both ways of reading must agree."""
    step = folder / "mutant.step"
    step.write_bytes(mutant.content(bases))
    verdict = judge(step, read)
    if also_plainly:
        plain = judge(step, read_plainly)
        # A time limit may apply to one of two readings on a busy machine.
        in_time = OUT_OF_TIME not in (plain.outcome, verdict.outcome)
        if plain.faults or (in_time and (plain.outcome, plain.codes) != (verdict.outcome, verdict.codes)):
            differs = f"read by a worker of its own it ends otherwise: {plain.outcome} {plain.codes} {plain.message}"
            return replace(verdict, outcome=FAILED, faults=(*verdict.faults, differs, *plain.faults))
    return verdict


def main(bases: Path, folder: Path) -> None:
    """Answer until there are no more names."""
    server = ForkServer(FUNCTION, folder, memory_limit=MEMORY_LIMIT) if can_fork() else None
    read = reading_by(server) if server is not None else read_plainly
    for line in sys.stdin:
        mutant = Mutant.named(line.strip())
        also_plainly = server is not None and mutant.number % SAMPLE == 0
        verdict = try_out(mutant, bases, folder, read, also_plainly=also_plainly)
        sys.stdout.write(json.dumps(asdict(verdict)) + "\n")
        sys.stdout.flush()
    if server is not None:
        server.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
