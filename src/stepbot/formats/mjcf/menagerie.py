"""A robot's MJCF in the form of MuJoCo Menagerie, with licence and changelog.

https://github.com/google-deepmind/mujoco_menagerie: its checks ask for these files by name, and for its form of XML.
"""

import re
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.resources import files
from pathlib import PurePosixPath

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.model import Robot
from stepbot.version import __version__

from . import FORMAT

_ASSETS = "assets"
_WIDTH = 120
"""Columns from which attributes continue in the next line."""
_LONG = re.compile(r'( *)<([\w.-]+)((?: [\w:.-]+="[^"]*")+)(/?>)')
_ATTRIBUTE = re.compile(r'[\w:.-]+="[^"]*"')
_LICENSE = "LICENSE"
_LICENSES = ("Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "MIT")
"""Licences with a text here, by SPDX identifier: those that Menagerie recognizes."""
_HOLDER = "<copyright holders>"
"""Where the text of a licence names them."""


def menagerie_files(robot: Robot, written: Mapping[str, bytes]) -> dict[str, bytes]:
    """The files of the folder, by path relative to it, without the README and the picture.

    Args:
        robot: The robot as MJCF expresses it.
        written: The files of the format, by path relative to the output folder, the main one first.
    """
    main = next(iter(written))
    scene = f"{robot.name}{FORMAT.scene}"
    meshes = {path: content for path, content in written.items() if PurePosixPath(path).parent.name == "meshes"}
    files = {main: _styled(written[main], bool(meshes)), "scene.xml": _styled(written[scene], False)}
    files |= {f"{_ASSETS}/{PurePosixPath(path).name}": content for path, content in sorted(meshes.items())}
    if text := _license(robot):
        files[_LICENSE] = text.encode()
    return files | {"CHANGELOG.md": _changelog(robot).encode()}


def report_missing_license(robot: Robot, diagnostics: Diagnostics) -> None:
    """Report that there is no text of the robot's licence (SB643)."""
    stated, holder = robot.metadata.license, robot.metadata.maintainer
    if _license(robot):
        return
    if not stated:
        what = "no licence is stated, so the folder has no LICENSE"
    elif stated in _LICENSES and not holder:
        what = f"the text of {stated} names its holder, and no maintainer is stated: the folder has no LICENSE"
    else:
        what = f"stepbot has no text of the licence '{stated}', so the folder has no LICENSE"
    help = [
        "in the sidecar: `metadata: {maintainer: Ada Lovelace <ada@example.com>, license: Apache-2.0}`",
        f"stepbot has the texts of {', '.join(_LICENSES)}; put another one into the folder as LICENSE",
    ]
    diagnostics.add("SB643", what, Span(_LICENSE), help=help)


def _license(robot: Robot) -> str:
    """The text of the robot's licence; empty without one, or without the holder that it names."""
    stated, holder = robot.metadata.license, robot.metadata.maintainer
    text = _text_of(stated) if stated in _LICENSES else ""
    return text.replace(_HOLDER, holder) if holder or _HOLDER not in text else ""


@cache
def _text_of(license: str) -> str:
    return files(__package__).joinpath("licenses", f"{license}.txt").read_text(encoding="utf-8")


def _changelog(robot: Robot) -> str:
    return f"""\
# Changelog – {robot.name} Description

All notable changes to this model will be documented in this file.

## [{robot.metadata.version or "1.0.0"}]

- Initial release, converted{f" from {robot.source}" if robot.source else ""} by stepbot {__version__}.
"""


def _styled(mjcf: bytes, has_meshes: bool) -> bytes:
    """A written file without declaration and comment, in lines of 120 columns, with meshes in the folder of assets."""
    _, _, *lines = mjcf.decode().split("\n")
    if has_meshes:
        folder = f'meshdir="{_ASSETS}"'
        if lines[1].startswith("  <compiler "):
            lines[1] = lines[1].replace("/>", f" {folder}/>")
        else:
            lines.insert(1, f"  <compiler {folder}/>")
        lines = [line.replace(' file="meshes/', ' file="') if "<mesh " in line else line for line in lines]
    return "\n".join(part for line in lines for part in _wrapped(line)).encode()


def _wrapped(line: str) -> Iterator[str]:
    """A line with an element, or several: as many attributes in each as there is room for."""
    match = _LONG.fullmatch(line) if len(line) > _WIDTH else None
    if match is None:
        yield line
        return
    indent, tag, given, end = match.groups()
    *attributes, last = _ATTRIBUTE.findall(given)
    line = f"{indent}<{tag}"
    for attribute in (*attributes, f"{last}{end}"):
        longer = f"{line} {attribute}"
        if len(longer) > _WIDTH:
            yield line
            longer = f"{indent}  {attribute}"
        line = longer
    yield line
