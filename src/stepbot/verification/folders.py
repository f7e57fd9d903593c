"""The robot files in a folder that a conversion wrote, and remedies that name them."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span, did_you_mean
from stepbot.formats import FORMATS
from stepbot.formats.features import Feature, Level
from stepbot.robot.step_names import is_step_name
from stepbot.runtime.file import is_file, is_folder, open_regular

SCENES = (".drake.sdf", *(written.scene for written in FORMATS.values() if written.scene))
"""Ends of the names of files that contain the robot of a main file once more."""
_BEGINNING = 4096
"""Number of bytes in which the first element of a file is."""
_FROM_SIDECAR = "`stepbot convert SIDECAR` writes and verifies the descriptions; name one of these files"
_SHOWN = 5
"""Maximum number of files that a remedy lists."""


def main_files(folder: Path) -> list[Path]:
    """The main files in a folder, URDF first; else those in its folders, as in a ROS 2 package; empty if unreadable."""
    try:
        return _main_files(folder.glob("*")) or _main_files(folder.glob("*/*"))
    except OSError:
        return []


def robot_file(target: Path) -> Path:
    """The file to show of a folder with the files of one robot: the first that keeps loops; else the target itself."""
    files = main_files(target) if is_folder(target) else []
    if len({path.stem for path in files}) != 1:
        return target
    formats = {written.suffix: written for written in FORMATS.values()}
    loops = (path for path in files if formats[path.suffix].expresses[Feature.CLOSURE].level is Level.EXACT)
    return next(loops, files[0])


def _main_files(paths: Iterable[Path]) -> list[Path]:
    order = {written.suffix: place for place, written in enumerate(FORMATS.values())}
    named = (path for path in paths if path.suffix in order and not path.name.endswith(SCENES))
    return sorted(filter(_is_robot, named), key=lambda path: (order[path.suffix], path.as_posix()))


def _is_robot(path: Path) -> bool:
    """Whether a file of a robot's suffix may be one; of XML files, such as manifests, those with MJCF's element."""
    if path.suffix != ".xml":
        return is_file(path)
    try:
        with open_regular(path) as file:
            return b"<mujoco" in file.read(_BEGINNING)
    except OSError:
        return False


def is_robot_file(path: Path, found: Diagnostics) -> bool:
    """Whether a path is a file that may be a robot description.

    Args:
        found: Receives SB001 with the robot files in the folder, or beside the missing file; SB814 for a sidecar or
            STEP.
    """
    span = Span(path.as_posix())
    if is_file(path):
        source = "a sidecar" if path.suffix in (".yaml", ".yml") else "a STEP file" if is_step_name(path.name) else ""
        if source:
            found.add("SB814", f"{source}, not a robot description", span, help=[_FROM_SIDECAR])
        return not source
    if is_folder(path):
        inside = _listed(main_files(path))
        help = f"use a file in it: {inside}" if inside else "it contains no robot file; `stepbot convert` writes them"
        found.add("SB001", "is a folder, not a file", span, help=[help])
        return False
    beside = main_files(path.parent)
    near = did_you_mean(path.name, (file.name for file in beside))
    listed = [f"robot files in '{path.parent.as_posix()}': {_listed(beside)}"] if beside else []
    found.add("SB001", "file not found", span, help=near or listed)
    return False


def _listed(files: Sequence[Path]) -> str:
    more = len(files) - _SHOWN
    return ", ".join(f"'{path.as_posix()}'" for path in files[:_SHOWN]) + (f" and {more} more" if more > 0 else "")
