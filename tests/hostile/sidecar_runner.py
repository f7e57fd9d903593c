"""A process in place of stepbot's for many sidecars: an exception or hang here would be one of the command.

python -m tests.hostile.sidecar_runner BASES FOLDER     reads names of mutants, one per line; answers with lines of JSON
"""

import json
import sys
import time
import traceback
import warnings
from pathlib import Path

from msgspec.structs import asdict

from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import load_sidecar
from stepbot.sidecar.located import Sidecar
from tests.fuzz.judge import FAILED, Verdict, make_robot, unsound_diagnostics

from .sidecar_mutant import SidecarMutant, assembly_of

BUILT = 4
"""Every so many mutants one is built, if its check finds no error."""
LONGEST_CHECK = 10.0
"""Processor time limit [s] of a check; valid sidecars take hundredths."""
LONGEST = 60.0
"""Processor time limit [s] of a mutant."""


def try_out(mutant: SidecarMutant, bases: Path, folder: Path) -> Verdict:
    """Create a mutant, check it, build the robot if planned, and return the outcome."""
    path = folder / "mutant.robot.yaml"
    path.write_bytes(mutant.content(bases))
    diagnostics, faults, outcome, began = Diagnostics(), list[str](), FAILED, time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            sidecar = _checked(path, diagnostics)
            faults += _took(began, LONGEST_CHECK, "check")
            if sidecar is None:
                outcome = "refused"
            elif mutant.number % BUILT:
                outcome = "clean"
            else:
                robot = make_robot(*assembly_of(bases / mutant.base), sidecar, diagnostics, faults)
                outcome = "robot" if robot else "no robot"
                faults += _took(began, LONGEST, "build")
    except Exception:  # noqa: BLE001 - to find those is what this is for
        faults.append(traceback.format_exc())
    faults += unsound_diagnostics(diagnostics)
    errors = [diagnostic for diagnostic in diagnostics if diagnostic.severity == "error"]
    codes, message = tuple(error.code for error in errors), str(errors[0]) if errors else ""
    return Verdict(FAILED if faults else outcome, codes, message, faults=tuple(faults))


def _checked(path: Path, diagnostics: Diagnostics) -> Sidecar | None:
    sidecar = load_sidecar(path, diagnostics)
    if sidecar is None:
        assert diagnostics.has_errors, "no sidecar, and no error that says why"
        return None
    check_sidecar(sidecar, diagnostics)
    return None if diagnostics.has_errors else sidecar


def _took(began: float, longest: float, what: str) -> list[str]:
    seconds = time.process_time() - began
    return [f"the {what} takes {seconds:.0f} s"] if seconds > longest else []


def main(bases: Path, folder: Path) -> None:
    """Answer until there are no more names."""
    for line in sys.stdin:
        verdict = try_out(SidecarMutant.named(line.strip()), bases, folder)
        sys.stdout.write(json.dumps(asdict(verdict)) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
