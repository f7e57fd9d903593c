"""Update the library, ``python -m robot_library``, or list outdated parts with ``--check``.

For every robot, several in parallel: draw its STEP, convert and verify it into ``build/library/<folder>``, drive it
there, render its picture if outdated, write the tables of its README; then the gallery of all. Failed drive tests are
in the tables, too, and are reported at the end. ``--check`` compares only hashes: it needs
neither build123d nor Embree, and takes no time.
"""

import argparse
import subprocess
import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING

from . import drives, fingerprints, pages

if TYPE_CHECKING:
    from stepbot.pipeline.stages import Conversion
    from stepbot.robot.model import MassProperties

LIBRARY = Path(__file__).resolve().parent
OUTPUT = LIBRARY.parent / "build" / "library"
_PAGE = "README.md"


def folders(names: Iterable[str] = ()) -> list[Path]:
    """The folders of the robots that are drawn, or of the named ones."""
    found = sorted(path.parent for path in LIBRARY.glob("*/build.py"))
    wanted = set(names)
    unknown = wanted - {path.name for path in found}
    if unknown:
        raise SystemExit(f"no robot {', '.join(sorted(unknown))}; there are {', '.join(path.name for path in found)}")
    return [path for path in found if not wanted or path.name in wanted]


def stale(folder: Path) -> list[str]:
    """The outdated results of a robot."""
    from .preview import stale as picture_is_stale

    recorded = pages.made_from((folder / _PAGE).read_text(encoding="utf-8"))
    found = []
    if recorded is None or recorded[0] != fingerprints.drawing(folder):
        found.append("the STEP, or its expected.json and scripts")
    if recorded is None or recorded[1] != fingerprints.robot(folder):
        found.append("the tables of README.md")
    if picture_is_stale(folder):
        found.append("preview.png")
    if drives.stale(folder):
        found.append(drives.PICTURE)
    return found


def make(folder: Path, force: bool = False) -> str:
    """Make one robot; returns the reason for a failure, or an empty string.

    Args:
        folder: The robot's folder.
        force: Whether to draw and render also what is up to date.
    """
    recorded = pages.made_from((folder / _PAGE).read_text(encoding="utf-8"))
    if force or recorded is None or recorded[0] != fingerprints.drawing(folder):
        run = _python("-m", f"robot_library.{folder.name}.build")
        if run.returncode:
            return f"{folder.name}: drawing failed\n{run.stderr}"
    conversion = _converted(folder)
    if conversion.diagnostics.has_errors:
        return f"{folder.name}: conversion failed\n" + "\n".join(map(str, conversion.diagnostics))
    page = folder / _PAGE
    found, driven = drives.driven(folder, OUTPUT / folder.name)
    part = pages.robot_part(folder, conversion, _own_mass(folder), drives.section(driven) if driven else [])
    page.write_text(pages.with_part(page.read_text(encoding="utf-8"), part), encoding="utf-8", newline="\n")
    if driven is not None:
        try:
            drives.draw(driven, folder)
        except ModuleNotFoundError as error:
            return f"{folder.name}: no plots: {error}; pip install -e '.[draw]'"
    run = _python("-m", "robot_library.preview", str(folder), *(["--force"] if force else []))
    if run.returncode:
        return f"{folder.name}: rendering failed\n{run.stderr}"
    failed = [str(one) for one in found if one.severity == "error"]
    return f"{folder.name}: made, but drive tests failed\n" + "\n".join(failed) if failed else ""


def _python(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *arguments]
    return subprocess.run(command, cwd=LIBRARY.parent, capture_output=True, encoding="utf-8", check=False)


def _converted(folder: Path) -> "Conversion":
    from stepbot.pipeline.stages import Options, convert

    (sidecar,) = folder.glob("*.robot.yaml")
    return convert(sidecar, Options(OUTPUT / folder.name))


def _own_mass(folder: Path) -> dict[str, "MassProperties"]:
    """Mass properties, from their shapes only, of the links with shapes whose sidecar gives others."""
    from ruamel.yaml import YAML

    from stepbot.pipeline.stages import Options, convert

    (sidecar,) = folder.glob("*.robot.yaml")
    yaml = YAML()
    content = yaml.load(sidecar.read_text(encoding="utf-8"))
    drawn = {name: link for name, link in content["links"].items() if "parts" in link}
    given = [name for name, link in drawn.items() if link.pop("inertial", None) is not None]
    if not given:
        return {}
    plain = OUTPUT / f"{folder.name}.shapes.robot.yaml"
    with plain.open("w", encoding="utf-8") as file:
        yaml.dump(content, file)
    options = Options(OUTPUT / f"{folder.name}.shapes", ("mjcf",), step=folder / content["step"], verify=False)
    conversion = convert(plain, options)
    if conversion.robot is None:
        raise ValueError(f"{folder.name}: the shapes have no mass\n" + "\n".join(map(str, conversion.diagnostics)))
    return {name: conversion.robot.link_by_name[name].mass_properties for name in given}


def fresh_gallery() -> str:
    """The library's README with pictures and table of all robots, from their pages."""
    from stepbot.runtime.robot_library import LibraryRobot, library_robots

    robots = [LibraryRobot(folder, next(folder.glob("*.robot.yaml"))) for folder in folders()]
    composed = [robot for robot in library_robots() if robot.is_composed and robot.picture.is_file()]
    return pages.with_part((LIBRARY / _PAGE).read_text(encoding="utf-8"), pages.gallery(robots, composed))


def gallery_is_stale() -> bool:
    """Whether a robot's page differs from the gallery, or is missing there."""
    return (LIBRARY / _PAGE).read_text(encoding="utf-8") != fresh_gallery()


def main() -> int:
    """Run the command line; returns the exit code."""
    parser = argparse.ArgumentParser(description="Draw, convert, verify and render the robots of the library.")
    parser.add_argument("names", nargs="*", metavar="FOLDER", help="only these robots")
    parser.add_argument("--check", action="store_true", help="list outdated results and exit")
    parser.add_argument("--stale", action="store_true", help="update only outdated robots")
    parser.add_argument("--force", action="store_true", help="draw and render also what is up to date")
    parser.add_argument("--jobs", type=int, default=None, help="robots in parallel (default: one per core)")
    options = parser.parse_args()
    wanted = folders(options.names)
    if options.check:
        found = [f"{folder.name}: outdated: {what}" for folder in wanted for what in stale(folder)]
        found += ["README.md: outdated: the gallery"] if gallery_is_stale() else []
        print("\n".join([*found, *(["run `make library`"] if found else [])]), end="\n" if found else "")
        return 1 if found else 0

    OUTPUT.mkdir(parents=True, exist_ok=True)
    wanted = [folder for folder in wanted if not options.stale or stale(folder)]
    faults = []
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        for folder, fault in zip(wanted, pool.map(make, wanted, [options.force] * len(wanted)), strict=True):
            print(fault or f"{folder.name}: made", flush=True)
            faults += [fault] if fault else []
    gallery = fresh_gallery()
    (LIBRARY / _PAGE).write_text(gallery, encoding="utf-8", newline="\n")
    return 1 if faults else 0
