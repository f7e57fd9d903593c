"""Install the wheel like a user: into a fresh environment of every supported Python, with the newest dependencies.

    build the wheel
    each Python    install; convert robots; run the tests marked `portable` against the installed package
    --oldest       the oldest Python once more, with the oldest dependencies that pyproject.toml allows
    all            the same bytes from each, with BLAS for other processors: URDF, SDFormat, MJCF, meshes, reports

Prints which Pythons were found and which were not; the exit code is 1 after any failure.
"""

import argparse
import hashlib
import os
import re
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from itertools import cycle
from pathlib import Path

from msgspec import Struct
from pythons import SUPPORTED, found_pythons

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT))

from tests.portable import PORTABLE  # noqa: E402

BUILD = ROOT / "build" / "wheels"
ROBOTS = ("stepbot_four_bar", "stepbot_delta", "stepbot_diff_drive", "stepbot_quadruped", "stepbot_upper_body")
"""Closed loops, hulls of thousands of vertices, fitted shapes, a hundred meshes."""
PROVEN = "stepbot_four_bar"
"""This robot is verified too: the engines load it."""
KERNELS = ("", "Prescott", "Nehalem", "Sandybridge")
"""OpenBLAS's kernels, taken in turn, the processor's own first: they must not change what is written."""
_LOWEST = re.compile(r"([\w.-]+)\s*>=\s*([\w.]+)")


class Failed(Exception):
    """A command failed; its output has been printed."""


class Environment(Struct, frozen=True):
    """One Python with one choice of dependencies."""

    name: str
    python: Path
    pins: tuple[str, ...] = ()

    @property
    def folder(self) -> Path:
        """Folder of the environment."""
        return BUILD / self.name.replace(" ", "-")

    @property
    def programs(self) -> Path:
        """Folder of its programs."""
        return self.folder / "venv" / ("Scripts" if sys.platform == "win32" else "bin")

    @property
    def engines(self) -> str:
        """The engines that its installation must have: there is no wheel of PyBullet for Python 3.14."""
        return "mujoco,yourdfpy" if self.name.startswith("Python 3.14") else "mujoco,pybullet,yourdfpy"

    @property
    def converted(self) -> Path:
        """Folder of its robots."""
        return self.folder / "robots"


def main() -> int:
    """Run everything; returns the exit code."""
    parser = argparse.ArgumentParser(description="Try the wheel in every supported Python that is found.")
    parser.add_argument("--no-tests", action="store_true", help="install, convert and compare only")
    parser.add_argument("--oldest", action="store_true", help="try the oldest dependencies too")
    options = parser.parse_args()
    environments = _environments(oldest_too=options.oldest)
    shutil.rmtree(BUILD, ignore_errors=True)
    failed = []
    wheel = _built()
    start = time.monotonic()
    with ThreadPoolExecutor(2) as pool:  # one downloads while the other unpacks
        installed = [pool.submit(_install, one, wheel) for one in environments]
    _say(f"installed into {len(environments)} environments", start)
    for one, installation, kernel in zip(environments, installed, cycle(KERNELS), strict=False):
        start = time.monotonic()
        try:
            installation.result()
            _convert(one, kernel)
            if not options.no_tests:
                _test(one)
        except Failed as failure:
            failed.append(f"{one.name}: {failure}")
        _say(f"{one.name}: {'FAILED' if failed and failed[-1].startswith(one.name) else 'passed'}", start)
    failed += _differences(environments)
    print("\n".join(["", *(f"FAILED {failure}" for failure in failed)]) if failed else "all Pythons passed", flush=True)
    return 1 if failed else 0


def _environments(*, oldest_too: bool) -> list[Environment]:
    pythons = found_pythons()
    for version in SUPPORTED:
        name = f"Python {version[0]}.{version[1]}"
        print(f"{name}: {f'{pythons[version][1]} at {pythons[version][0]}' if version in pythons else 'not found'}")
    if not pythons:
        sys.exit("no supported Python was found")
    found = [Environment(f"Python {full}", path) for path, full in pythons.values()]
    if not oldest_too:
        return found
    oldest, full = next(iter(pythons.values()))
    return [*found, Environment(f"Python {full} with oldest dependencies", oldest, _lower_bounds())]


def _lower_bounds() -> tuple[str, ...]:
    """The oldest series of each dependency that the metadata allows."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    bounds = [match for one in project["dependencies"] if ";" not in one and (match := _LOWEST.match(one))]
    return tuple(f"{match[1]}~={match[2] if match[2].count('.') > 1 else f'{match[2]}.0'}" for match in bounds)


def _test_requirements() -> list[str]:
    """The tests' dependencies besides the wheel, in the ranges of pyproject.toml."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = ("hypothesis", "jsonschema", "pytest", "pytest-xdist")
    return [one for one in project["optional-dependencies"]["dev"] if re.split("[><=]", one)[0] in wanted]


def _built() -> Path:
    start = time.monotonic()
    _run("build", sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(BUILD), cwd=ROOT)
    (wheel,) = BUILD.glob("*.whl")
    _say(f"built {wheel.name}", start)
    return wheel


def _install(one: Environment, wheel: Path) -> None:
    one.folder.mkdir(parents=True)
    _run("venv", str(one.python), "-m", "venv", "venv", cwd=one.folder)
    install = [
        str(one.programs / "python"),
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--no-compile",
    ]
    _run("install", *install, str(wheel), *one.pins, *_test_requirements(), cwd=one.folder)


def _convert(one: Environment, kernel: str) -> None:
    """Convert like a user, outside the checkout, with one kind of OpenBLAS's kernels."""
    one.converted.mkdir()
    changes = {"OPENBLAS_CORETYPE": kernel}
    for robot in ROBOTS:
        (sidecar,) = (ROOT / "robot_library" / robot).glob("*.robot.yaml")
        command = [str(one.programs / "stepbot"), "convert", "--no-cache", str(sidecar)]
        _run(f"convert {robot}", *command, "--no-verify", "-o", robot, cwd=one.converted, changes=changes)
        if robot == PROVEN:
            proven = ("-o", str(one.folder / "proven"), "--require", one.engines)
            _run(f"prove {robot}", *command, *proven, cwd=one.converted, changes=changes)
    export = [str(one.programs / "stepbot"), "library", "export", "arm2", "--require", one.engines]
    _run("export arm2", *export, "--no-cache", "-o", str(one.folder / "arm2"), cwd=one.converted, changes=changes)


def _test(one: Environment) -> None:
    """The portable tests; the sources are not on the import path, so that the wheel is tested."""
    pytest = [
        str(one.programs / "python"),
        "-m",
        "pytest",
        "-q",
        "-n",
        "auto",
        "--dist",
        "loadgroup",
        "-p",
        "no:cacheprovider",
    ]
    log = one.folder / "tests.log"
    with log.open("wb") as file:
        code = subprocess.run(
            [*pytest, "-m", "portable and not slow and not long", *(f"tests/{name}" for name in PORTABLE)],
            cwd=ROOT,
            env=_clean(),
            stdout=file,
            stderr=subprocess.STDOUT,
            check=False,
        ).returncode
    lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
    print("\n".join(lines if code else lines[-1:]), flush=True)
    if code:
        raise Failed("tests")


def _differences(environments: list[Environment]) -> Iterator[str]:
    """Differences between the robots of the first environment and those of the others."""
    first, *others = environments
    expected = _digests(first.converted)
    print(f"{len(expected)} files of {len(ROBOTS)} robots by {first.name}", flush=True)
    for other in others:
        found = _digests(other.converted)
        names = sorted(name for name in expected | found if expected.get(name) != found.get(name))
        if names or not expected:
            yield f"{other.name}: other bytes than {first.name}: {', '.join(names[:10])}{' ...' if names[10:] else ''}"
        else:
            print(f"the same bytes by {other.name}", flush=True)


def _digests(folder: Path) -> dict[str, str]:
    """Hash of each file below a folder."""
    files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
    return {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def _run(what: str, *command: str, cwd: Path, changes: Mapping[str, str] | None = None) -> None:
    environment = _clean() | dict(changes or {})
    run = subprocess.run(
        command, cwd=cwd, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False
    )
    if run.returncode:
        print(run.stdout.decode("utf-8", "replace"), flush=True)
        raise Failed(f"{what}: exit code {run.returncode}")


def _clean() -> dict[str, str]:
    """The environment without variables that lead Python to the checkout or to another environment."""
    return {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV"))}


def _say(text: str, start: float) -> None:
    print(f"{text}, {time.monotonic() - start:.0f} s", flush=True)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failed as failure:
        sys.exit(str(failure))
