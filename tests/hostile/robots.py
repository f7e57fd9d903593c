"""Two versions of a robot to convert, their expected files, and a cache with both."""

import shutil
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from msgspec import Struct

from stepbot.runtime.cache.sources import own_code
from tests.command_line import snapshot
from tests.conftest import ROOT

from .command import stepbot

MANIFEST = ".stepbot.json"
_STAGING = ".stepbot-"
_FOLDERS: list[TemporaryDirectory[str]] = []
"""Removed when the process ends."""


class Versions(Struct, frozen=True):
    """A robot before and after an edit of its sidecar."""

    folder: Path
    """Folder of ``old.robot.yaml``, ``new.robot.yaml`` and their STEP; both use one robot name."""
    old: dict[str, bytes]
    """Files of the output, except stepbot's file list, which each run stamps."""
    new: dict[str, bytes]
    cache: Path
    """A cache with the geometry of the STEP and no derived results."""
    seconds: float
    """Duration [s] of a conversion with cached geometry."""

    def put_old(self, output: Path) -> None:
        """Put the files of the old version into a folder."""
        for name, content in self.old.items():
            (output / name).parent.mkdir(parents=True, exist_ok=True)
            (output / name).write_bytes(content)

    def torn(self, output: Path) -> list[str]:
        """Files of neither version, except those that are being written."""
        return [
            f"'{name}' is neither the old file nor the new one"
            for name, content in files_in(output).items()
            if not name.startswith(_STAGING)
            and name != MANIFEST
            and content not in (self.old.get(name), self.new.get(name))
        ]


def files_in(output: Path) -> dict[str, bytes]:
    """Files in an output folder, hidden ones too, except the file list and those being written."""
    files = snapshot(output).items()
    return {name: content for name, content in files if name != MANIFEST and not name.startswith(_STAGING)}


def two_versions(name: str = "stepbot_arm2") -> Versions:
    """Convert both versions of a robot of the library, once for all experiments; the new one is heavier."""
    return _converted(name, own_code())


@cache
def _converted(name: str, code: str) -> Versions:
    _FOLDERS.append(TemporaryDirectory(prefix=f"hostile-{name}-"))
    folder = Path(_FOLDERS[-1].name).resolve()
    (source,) = (ROOT / "robot_library" / name).glob("*.robot.yaml")
    (step,) = (ROOT / "robot_library" / name).glob("*.step")
    shutil.copy(step, folder)
    text = source.read_text(encoding="utf-8")
    heavier = text.replace("1010 kg/m^3", "1020 kg/m^3").replace("2700 kg/m^3", "2710 kg/m^3")
    assert heavier != text
    (folder / "old.robot.yaml").write_text(text, encoding="utf-8")
    (folder / "new.robot.yaml").write_text(heavier, encoding="utf-8")
    kept, written, seconds = folder / "cache", {}, 0.0
    known = stepbot(
        "check", "--step", step.name, "old.robot.yaml", "--cache", kept, folder=folder, temporary=folder / "tmp"
    )
    assert known.code == 0, known.text
    shutil.copytree(kept, folder / "geometry")
    for version in ("old", "new"):
        output = folder / f"{version}.out"
        ended = stepbot(
            "convert", f"{version}.robot.yaml", "-o", output, "--cache", kept, folder=folder, temporary=folder / "tmp"
        )
        assert ended.code == 0, ended.text
        assert not ended.left, ended.left
        written[version], seconds = files_in(output), ended.seconds
    shutil.rmtree(kept)
    return Versions(folder, written["old"], written["new"], folder / "geometry", seconds)
