"""A process that runs ``stepbot`` on many mutants, each in a forked process and a sandbox of its own.

python -m tests.hostile.mutant_runner BASES FOLDER     reads names of mutants, one per line; answers with lines of JSON

The commands' workers are forked from processes that have loaded kernel and engines, as in tests: that is what makes
thousands of commands an hour possible. A name gives the command, too, so ``--only NAME`` repeats one.
"""

import atexit
import contextlib
import gc
import importlib
import json
import os
import pkgutil
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from random import Random
from typing import Any

from msgspec import Struct
from msgspec.structs import asdict, replace

from stepbot.diagnostics import Diagnostics
from stepbot.diagnostics.codes import CODES
from stepbot.formats import FORMATS
from stepbot.formats.rendering import render
from stepbot.robot.mesh_files import share_meshes
from stepbot.runtime import temporary
from stepbot.runtime.cache.sources import environment
from stepbot.runtime.worker import Worker
from stepbot.sidecar.load import load_sidecar
from stepbot_cli import main as command
from tests.fuzz.judge import FAILED, OF_PYDANTIC, Verdict
from tests.robots import ROBOTS
from tests.warm import warm_processes

from . import sandbox
from .mutant_files import COMPOSED, DESCRIPTIONS, VARIANTS, FileMutant

LIMIT = 25
"""Time limit [s] of kernel and engines that the commands get."""
HANGS_AFTER = 6.0 * LIMIT
"""Seconds after which a command counts as hung: several engines may need their limit in turn."""
LONGEST = 1.2 * LIMIT
"""Processor time limit [s] of the command's own process, without its workers: it ends itself a little earlier."""
LARGEST = 1 << 30
"""Memory limit [bytes] of the command's own process."""
_ADDRESS_SPACE = 16 << 30
_ALL = "urdf,sdf,mjcf,usd,webots"
_TRACEBACK = re.compile(r"^Traceback \(most recent call last\)|^\w+(Error|Exception|Warning): ", re.MULTILINE)
_CODE = re.compile(r"\bSB\d\d\d\b")


class Run(Struct, frozen=True):
    """How a command is run on a mutant."""

    arguments: tuple[str, ...]
    writes: tuple[str, ...] = ()
    """Paths in the sandbox that it may change if it succeeds."""
    has_output: bool = False
    """Whether there is earlier output."""
    withholds: tuple[str, ...] = ()
    """Paths in the sandbox that it may change in any case: where files go that fail their proof."""


def planned(mutant: FileMutant, file: str) -> Run:
    """The command for a mutant; the same for the same name."""
    rng = Random(f"{mutant.name} command")
    limits = ("--timeout", str(LIMIT), "--memory-limit", "4G")
    shown = rng.choice(((), ("--json",), ("--json",), ("-v",), ("--concise",)))
    into = ("-o", "out", *limits, *shown)
    if mutant.group == "sidecar":
        run = _on_sidecar(file, rng, into, (*limits, *shown))
        if mutant.base == COMPOSED and run.arguments[0] == "convert" and rng.random() < 0.5:
            return replace(run, arguments=(*run.arguments, "--variant", rng.choice(VARIANTS)))
        return run
    if mutant.group == "step":
        return rng.choice(
            (
                Run(("inspect", file, *limits, *shown)),
                Run(("convert", "one.robot.yaml", "--no-verify", "-f", _ALL, *into), (sandbox.OUTPUT,), True),
                Run(
                    ("init", file, "-o", "drafted.robot.yaml", *limits),
                    ("work/drafted.robot.yaml", "work/robot-1.schema.json"),
                ),
            )
        )
    if mutant.group == "mesh":
        file = f"main.{DESCRIPTIONS[mutant.base.partition('-')[2]]}"
    way = rng.random()
    if way < 0.6:
        options = (*rng.choice(((), ("--base", "floating"), ("--strict",), ("--assume-inertia", "1000"))),)
        return Run(("convert", file, "--no-verify", "-f", _ALL, *options, *into), (sandbox.OUTPUT,), True)
    if way < 0.67:
        return Run(("convert", file, *into), (sandbox.OUTPUT,), True, (f"{sandbox.OUTPUT}.failed",))
    if way < 0.77:
        return Run(("verify", file, *limits, *shown))
    if way < 0.87:
        sound = f"sound.{file.rpartition('.')[2]}"
        return Run(("diff", *rng.sample((sound, file), 2), *limits, *(one for one in shown if one != "--concise")))
    if way < 0.9:
        return Run(("datasheet", file, *limits, *shown))
    if way < 0.94:
        return Run(("collisions", file, "--samples", "20", *limits, *shown))
    return Run(
        ("render", file, "-o", "picture.png", "--size", "40x30", "--samples", "1", *limits), ("work/picture.png",)
    )


def _on_sidecar(file: str, rng: Random, into: tuple[str, ...], options: tuple[str, ...]) -> Run:
    way = rng.random()
    if way < 0.5:
        more = rng.choice(((), ("--strict",), ("--package", "mutant"), ("--gazebo",), ("--ros2", "mutant")))
        formats = () if more and more[0] in ("--ros2", "--gazebo") else ("-f", _ALL)
        return Run(("convert", file, "--no-verify", *formats, *more, *into), (sandbox.OUTPUT,), True)
    if way < 0.7:
        return Run(
            ("check", file, *(one for one in options if one not in ("--timeout", "--memory-limit", "4G", str(LIMIT))))
        )
    if way < 0.8:
        return Run(("lock", file, *options), ("work/main.lock.json", "work/arm2.lock.json"))
    if way < 0.9:
        return Run(
            ("diff", *rng.sample(("sound.robot.yaml", file), 2), *(one for one in options if one != "--concise"))
        )
    if way < 0.95:
        return Run(("datasheet", file, *options))
    return Run(("collisions", file, "--samples", "20", *options))


def try_out(mutant: FileMutant, bases: Path, folder: Path) -> Verdict:
    """Run the command on a mutant in a new sandbox, and return the outcome."""
    place = folder / "sandbox"
    if place.exists():
        shutil.rmtree(place)
    place.mkdir()
    name, content = mutant.damaged(bases)
    run = planned(mutant, name)
    base = bases / mutant.base
    sandbox.build(place, base, _earlier(base, folder) if run.has_output else None)
    work = place / sandbox.WORK
    source = mutant.source(bases)
    shutil.copyfile(source, work / f"sound.{source.name.partition('.')[2]}")
    (work / name).write_bytes(content)
    before = sandbox.entries(place)
    ended = _run(run.arguments, place, folder / "cache")
    after = sandbox.entries(place)
    faults = list(ended.faults())
    faults += sandbox.changed(before, after, (*run.withholds, *(run.writes if ended.code == 0 else ())))
    faults += [
        f"leaves '{path.name}' in the folder for temporary files" for path in (place / sandbox.TEMPORARY).iterdir()
    ]
    codes = tuple(dict.fromkeys(_CODE.findall(ended.text)))
    if faults:
        faults.append(f"stepbot {' '.join(run.arguments)}")
    outcome = FAILED if faults else f"{run.arguments[0]} {('clean', 'findings', 'could not run')[ended.code]}"
    return Verdict(outcome, codes, faults=tuple(faults))


def _earlier(base: Path, folder: Path) -> Path:
    """Output of the valid file, converted once."""
    output = folder / "earlier" / base.name
    if not output.exists():
        place = folder / "earlier-sandbox"
        shutil.copytree(base, place / sandbox.WORK)
        (place / sandbox.TEMPORARY).mkdir()
        source = next(
            path.name for name in ("one", "main") for path in sorted((place / sandbox.WORK).glob(f"{name}.*"))
        )
        ended = _run(("convert", source, "--no-verify", "-f", _ALL, "-o", "out"), place, folder / "cache")
        output.parent.mkdir(exist_ok=True)
        if (place / sandbox.OUTPUT).exists():
            shutil.move(place / sandbox.OUTPUT, output)
        else:  # a valid file may need an option, as a robot whose links have no mass
            assert not ended.faults(), ended.text
            output.mkdir()
        shutil.rmtree(place)
    return output


class Ended(Struct, frozen=True):
    """The end of a command."""

    code: int
    """Exit code; negative for a signal."""
    out: str
    err: str
    hung: bool
    seconds: float
    """Processor time of its own process."""
    memory: int
    """Largest memory [bytes] of its own process."""

    @property
    def text(self) -> str:
        """Both streams."""
        return self.out + self.err

    def faults(self) -> list[str]:
        """Forbidden results."""
        shown = self.text[-3000:]
        found = []
        if self.hung:
            found.append(f"no end after {HANGS_AFTER:g} s\n{shown}")
        elif self.code not in (0, 1, 2):
            found.append(f"exit code {self.code}\n{shown}")
        if _TRACEBACK.search(self.text) or "SB901" in self.text:
            found.append(f"a traceback, or an internal error\n{shown}")
        if self.seconds > LONGEST:
            found.append(f"the command's own process takes {self.seconds:.0f} s")
        if self.memory > LARGEST:
            found.append(f"the command's own process takes {self.memory / 1e9:.1f} GB")
        if self.code == 2 and not _CODE.search(self.text) and "Usage" not in self.text:
            found.append(f"exit code 2 without a code\n{shown}")
        if OF_PYDANTIC.search(self.text):
            found.append(f"a message of pydantic's\n{shown}")
        if any(not (character.isprintable() or character in "\n\r") for character in self.err):
            found.append(f"a control character in {self.err[:3000]!r}")
        return [*found, *_unsound_json(self.out)]


def _unsound_json(out: str) -> list[str]:
    """Defects of a JSON document and its diagnostics."""
    if not re.match(r'\{\s*(["}]|$)', out):  # text may begin with the name of a robot, such as {arm}
        return []
    try:
        document: dict[str, Any] = json.loads(out, parse_constant=_refuse)
    except ValueError as error:
        return [f"no JSON: {error}: {out[-500:]}"]
    found = []
    for one in document.get("diagnostics", ()):
        if one["code"] not in CODES:
            found.append(f"no such code: {one}")
        if "\n" in one["message"] or not one["message"].isprintable():
            found.append(f"{one['code']}: not one printable line: {one['message']!r}")
        if not one["file"]:
            found.append(f"{one['code']}: no place")
        if one["severity"] == "error" and not any(one["help"]):
            found.append(f"{one['code']}: no remedy: {one['message']}")
    return found


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is not JSON")


def _run(arguments: Sequence[str], place: Path, cache: Path) -> Ended:
    """Run ``stepbot`` in a forked process."""
    out, err = place.with_name("out"), place.with_name("err")
    pid = os.fork()
    if pid == 0:
        _serve(arguments, place, cache, out, err)
    deadline = time.monotonic() + HANGS_AFTER
    while True:
        ended, status, usage = os.wait4(pid, os.WNOHANG)
        hung = not ended and time.monotonic() > deadline
        if hung:
            os.kill(pid, signal.SIGKILL)
            _, status, usage = os.wait4(pid, 0)
        if ended or hung:
            break
        time.sleep(0.002)
    streams = (path.read_bytes().decode("utf-8", "replace") for path in (out, err))
    code, seconds = os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime
    return Ended(code, *streams, hung, seconds, usage.ru_maxrss * 1024)


def _serve(arguments: Sequence[str], place: Path, cache: Path, out: Path, err: Path) -> None:
    """Be the command's process; never returns."""
    code = 120
    try:
        resource.setrlimit(resource.RLIMIT_AS, (_ADDRESS_SPACE, _ADDRESS_SPACE))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        for descriptor, path in ((1, out), (2, err)):
            opened = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(opened, descriptor)
            os.close(opened)
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        sys.stdin, sys.stdout, sys.stderr = (
            open(descriptor, mode, encoding="utf-8", closefd=False)  # noqa: SIM115
            for descriptor, mode in ((0, "r"), (1, "w"), (2, "w"))
        )
        os.chdir(place / sandbox.WORK)
        os.environ |= {
            "TMPDIR": str(place / sandbox.TEMPORARY),
            "HOME": str(place / sandbox.HOME),
            "STEPBOT_CACHE": str(cache),
        }
        tempfile.tempdir = None
        temporary.run_folder.cache_clear()
        os.environ["TMPDIR"] = str(temporary.run_folder())  # as for workers that are not forked from a server
        code = command([*arguments])
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
    except BaseException:  # noqa: BLE001 - reported as every traceback
        os.write(2, traceback.format_exc().encode("utf-8", "backslashreplace"))
    finally:
        os._exit(code)


def main(bases: Path, folder: Path) -> None:
    """Answer until there are no more names."""
    _import_rooms()
    _use_once(bases)
    gc.freeze()  # memory that nobody writes to stays shared
    with warm_processes():
        for function in _WORKERS:
            with contextlib.closing(Worker(function)) as worker:  # the servers are started here, once
                assert worker.pid
        for line in sys.stdin:
            verdict = try_out(FileMutant.named(line.strip()), bases, folder)
            sys.stdout.write(json.dumps(asdict(verdict)) + "\n")
            sys.stdout.flush()
            if any("no end after" in fault for fault in verdict.faults):
                # Its workers still run; they end with their servers, and those with this process's threads.
                os.execv(sys.executable, [sys.executable, "-m", "tests.hostile.mutant_runner", *sys.argv[1:]])


def _import_rooms() -> None:
    """Import what commands import when they need it: each forked process would import it anew."""
    for room in _ROOMS:
        package = importlib.import_module(room)
        for module in pkgutil.walk_packages(package.__path__, f"{room}."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)


def _use_once(bases: Path) -> None:
    """Make what a process makes at its first use: each forked process would make it anew.

    These are hashes of stepbot and of the installed packages, the validators of sidecars, and compiled expressions.
    """
    environment()
    for sidecar in sorted(bases.glob("sidecar-*/main.robot.yaml")):
        load_sidecar(sidecar, Diagnostics())
    for written_in in FORMATS:
        render(share_meshes(ROBOTS["equipped"]()), written_in, Diagnostics())


_ROOMS = (
    "stepbot_cli",
    *(f"stepbot.{one}" for one in ("assemble", "described", "diagnostics", "draft", "formats", "jobs", "pipeline")),
    *(f"stepbot.{one}" for one in ("report", "revisions", "robot", "runtime", "sidecar", "verification", "viewing")),
)
_WORKERS = ("stepbot.step.worker:read", "stepbot.engines.describe:describe", "stepbot.engines.file_references:refusals")

if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]).resolve())
