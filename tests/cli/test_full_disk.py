"""Files that commands write beside robots are written whole or not at all, as on a disk that is full."""

import resource
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.jobs.batch.summary import INDEX, write_index
from stepbot.pictures.picture import Picture
from stepbot_cli.render import write_picture

from .conftest import Stepbot

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs limits of the size of files")


@contextmanager
def _full_after(size: int) -> Iterator[None]:
    """No file of this process can be larger."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_picture_is_kept(tmp_path: Path) -> None:
    """The picture of before is as it was."""
    path = tmp_path / "arm.png"
    path.write_bytes(b"before")
    pixels = np.random.default_rng(1).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    diagnostics = Diagnostics()
    with _full_after(4096):
        write_picture(path, Picture(pixels), diagnostics)
    assert [one.code for one in diagnostics] == ["SB004"]
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == {"arm.png": b"before"}


def test_the_index_of_a_batch_is_kept(tmp_path: Path) -> None:
    """It is read while a batch goes on."""
    (tmp_path / INDEX).write_bytes(b"before")
    with _full_after(100), pytest.raises(OSError, match="too large"):
        write_index(tmp_path, [])
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == {INDEX: b"before"}


def test_exported_files_are_whole(tmp_path: Path, stepbot: Stepbot) -> None:
    """A STEP file that is cut off would be taken for the robot's by the next command."""
    with _full_after(50_000):
        run = stepbot("library", "export", "arm2", "--source", "-o", str(tmp_path / "out"))
    assert run.code == 2
    assert "error[SB004]: cannot write" in run.err
    assert not (tmp_path / "out" / "arm2.step").exists()
