"""Sidecars, STEP files, descriptions and meshes with damaged structure are given to every command that reads them."""

from collections.abc import Iterator

from tests.fuzz.mutants import try_all

from .experiment import Experiment, Setting, Trial
from .mutant_files import FileMutant, collect, plan


def run(setting: Setting) -> Iterator[Trial]:
    """Run a command on each mutant, in a sandbox with earlier output and files of others."""
    bases = setting.folder / "bases"
    if not bases.is_dir():
        collect(bases)
    mutants = [FileMutant.named(name) for name in setting.names] or plan(bases, setting.count, setting.seed)
    for trial in try_all(mutants, bases, jobs=setting.jobs, runner="tests.hostile.mutant_runner"):
        yield Trial(trial.mutant.name, trial.verdict.outcome, trial.verdict.faults)


EXPERIMENT = Experiment(
    "mutants",
    "damaged sidecars, STEP files, URDF, SDFormat, MJCF and meshes, given to the commands that read them",
    "exit code 0, 1 or 2 with a code, in bounded time and memory; after an error the earlier output; no byte changes "
    "outside of the output folder, the cache and the folder for temporary files",
    run,
    short=24,
    long=20_000,
    repaired=(
        "URDF with a byte that is no character raised an exception in `convert` and `verify` (SB814)",
        "MJCF that is no XML, or whose encoding hides tags, reached MuJoCo, which opened includes anywhere (SB814)",
        "MJCF with hundreds of nested bodies was refused by our parser, and MuJoCo's full stack was SB901 (SB801)",
        "a description or a sidecar with a line of 50 kB took minutes, since a search for names of files was quadratic",
        "an OBJ without vertices, or with broken ones, raised an exception in our parsers, which know no size of it",
        "SDFormat with sizes and scales of other than three numbers raised an exception, and poses took NaN (SB823)",
        "a vertex at 1e300 in a mesh of a description raised an exception in OpenUSD (SB414)",
        "a link named `{x}` raised an exception in the comparison, which took its name for a template",
        "`verify` of a file that stepbot's own parser alone reads ended in an exception",
        "libsdformat's command wrote a log into the user's home",
        "`diff` of a file that no engine reads ended with code 2 and without a word (SB815)",
        "a screw without pitch that turns without end raised an exception in the writer for Webots",
        "SDFormat whose moments of inertia are not finite raised an exception (SB414)",
        "SDFormat with a lidar whose scan is infinite raised an exception in `convert` and `verify` (SB823)",
        "an effort limit near the smallest number raised an exception in computed gains and accelerations for MoveIt",
        "a URDF of 2,000 links that no joint connects took minutes, in time that grew with the cube of their number",
        "a placement without its point, of a part that occurs many times in a STEP file, raised an exception",
        "of 9,600 trials of seed 301 three found a fault: the infinite scan, the effort limit and the loose links; "
        "these 2,004 links take 31 s of processor time still, in linear time (open)",
    ),
)
