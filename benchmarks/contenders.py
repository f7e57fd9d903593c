"""The contenders, and their commands for a STEP file."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from msgspec import Struct, field

ROOT = Path(__file__).resolve().parents[1]
_CASCADIO = (
    "import sys, cascadio; sys.exit(cascadio.step_to_glb(sys.argv[1], sys.argv[2],"
    " tol_linear=0.002, tol_angular=0.2618, tol_relative=True, use_parallel=True))"
)
_COMMAND = (
    "import sys, stepbot_cli; sys.argv[0] = 'stepbot'; sys.exit(getattr(stepbot_cli, 'command', stepbot_cli.main)())"
)
STEPBOT = (sys.executable, "-P", "-c", _COMMAND)
"""The command as it is installed, of whatever revision is imported."""


class Case(Struct):
    """One robot to convert, in its own folder."""

    name: str
    folder: Path
    sidecar: Path
    """Copy in ``folder`` that may be edited."""
    step: Path
    edits: int = 0

    @property
    def environment(self) -> dict[str, str]:
        """Isolated from the caller's cache; Python keeps bytecode, as it does by default."""
        own = {"STEPBOT_CACHE": str(self.folder / "kept"), "STEPBOT_NO_CACHE": ""}
        return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"} | own

    @staticmethod
    def of(sidecar: Path, step: Path, folder: Path) -> "Case":
        """A case from copies of a sidecar and its STEP."""
        name = sidecar.name.removesuffix(".robot.yaml")
        folder = folder / name
        folder.mkdir(parents=True)
        copies = [folder / sidecar.name, folder / step.name]
        shutil.copy(sidecar, copies[0])
        shutil.copy(step, copies[1])
        return Case(name, folder, *copies)

    def edit(self) -> None:
        """Change the sidecar so that every written file changes: a named frame moves slightly."""
        self.edits += 1
        text = self.sidecar.read_text(encoding="utf-8")
        start = text.index("\nframes:")
        before, xyz, rest = text[start:].partition("xyz: [")
        rest = rest.partition("]")[2]
        self.sidecar.write_text(
            f"{text[:start]}{before}{xyz}0, 0, {0.001 + 1e-6 * self.edits:.6f}]{rest}", encoding="utf-8", newline="\n"
        )


def _nothing(case: Case) -> None:
    """Preparation of most contenders before a run."""


class Contender(Struct, frozen=True):
    """One contender."""

    name: str
    command: Callable[[Case], list[str]]
    before_each: Callable[[Case], None] = _nothing
    before_all: Callable[[Case], None] = _nothing
    environment: Mapping[str, str] = field(default_factory=dict)


def _convert(*options: str) -> Callable[[Case], list[str]]:
    return lambda case: [*STEPBOT, "convert", case.sidecar.name, "-o", "out", *options]


def _filling(case: Case) -> tuple[str, ...]:
    return ("convert", case.sidecar.name, "-o", "filled", "--no-verify")


def _fill_cache(case: Case) -> None:
    for command in (_filling(case), ("check", case.sidecar.name)):
        subprocess.run([*STEPBOT, *command], cwd=case.folder, env=case.environment, check=True, capture_output=True)


def _script(case: Case) -> list[str]:
    return [sys.executable, str(ROOT / "benchmarks" / "bare_occt.py"), case.step.name]


_TWICE = """\
import subprocess, sys
runs = [subprocess.Popen(sys.argv[2:])]
if sys.argv[1] == "in turn":
    runs[0].wait()
runs.append(subprocess.Popen(sys.argv[2:]))
sys.exit(any([run.wait() for run in runs]))
"""


def _twice(how: str) -> Contender:
    """The bare script twice: the speedup of independent processes on this machine."""
    return Contender(f"bare OCCT script, twice {how}", lambda case: [sys.executable, "-c", _TWICE, how, *_script(case)])


PLAIN = Contender(
    "plain converter script",
    lambda case: [sys.executable, str(ROOT / "benchmarks" / "plain_converter.py"), case.step.name, "plain"],
)
BARE = Contender("bare OCCT script", _script)
IN_TURN, AT_ONCE = _twice("in turn"), _twice("at once")
CLICK = Contender("import click", lambda case: [sys.executable, "-c", "import click"])
COLD = Contender("stepbot, cold", _convert("--no-cache", "--no-verify"))
VERIFIED = Contender("stepbot, cold, verified", _convert("--no-cache"))
EDITED = Contender("stepbot, sidecar edited", _convert("--no-verify"), Case.edit, _fill_cache)
EDITED_VERIFIED = Contender("stepbot, sidecar edited, verified", _convert(), Case.edit, _fill_cache)
VERSION = Contender("stepbot --version", lambda case: [*STEPBOT, "--version"])
HELP = Contender("stepbot --help", lambda case: [*STEPBOT, "--help"])
CHECK = Contender(
    "stepbot check, unchanged", lambda case: [*STEPBOT, "check", case.sidecar.name], before_all=_fill_cache
)
UNCHANGED = Contender("stepbot convert, unchanged", lambda case: [*STEPBOT, *_filling(case)], before_all=_fill_cache)


def cascadio(python: str) -> Contender:
    """STEP to GLB by cascadio, in a separate environment, because trimesh imports it if it is installed."""
    return Contender("cascadio, STEP to GLB", lambda case: [python, "-c", _CASCADIO, case.step.name, "out.glb"])


def batch(jobs: int, robots: Path) -> Contender:
    """All robots below a folder or on a list, on a number of cores."""
    return Contender(
        f"stepbot batch -j {jobs}",
        lambda case: [*STEPBOT, "batch", str(robots), "-o", "batch", "-j", str(jobs), "--no-cache"],
        _without_batch,
    )


def dask_batch(workers: int, robots: Path) -> Contender:
    """The same on a Dask cluster of this machine, of so many processes."""
    script = str(ROOT / "benchmarks" / "dask_batch.py")
    return Contender(
        f"stepbot batch, Dask with {workers} workers",
        lambda case: [sys.executable, script, str(workers), str(robots), "batch"],
        _without_batch,
    )


def _without_batch(case: Case) -> None:
    shutil.rmtree(case.folder / "batch", ignore_errors=True)


def revision(name: str, folder: Path) -> Contender:
    """stepbot at a commit or tag, without verification.

    Args:
        name: Its name in git.
        folder: Receives its source.
    """
    source = folder / "source"
    source.mkdir(parents=True)
    archive = subprocess.run(["git", "archive", name, "src", "cli"], cwd=ROOT, check=True, capture_output=True).stdout
    subprocess.run(["tar", "-x"], cwd=source, input=archive, check=True)
    paths = os.pathsep.join([str(source / "src"), str(source / "cli")])
    return Contender(
        f"stepbot at {name}, cold", _convert("--no-cache", "--no-verify"), environment={"PYTHONPATH": paths}
    )
