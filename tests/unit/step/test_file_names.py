"""STEP files whose names are not UTF-8."""

import os
import sys
from pathlib import Path

import pytest

from stepbot.step.exchange.encodings import as_utf8


@pytest.mark.skipif(sys.platform != "linux", reason="file names are Unicode there")
@pytest.mark.parametrize("encoding", ["ascii", "utf-8"])
def test_kernel_gets_a_name_that_it_can_open(tmp_path: Path, encoding: str) -> None:
    """The kernel gets a UTF-8 path to the same content."""
    path = tmp_path / os.fsdecode(b"a\xe9.step")
    path.write_bytes("ISO-10303-21;".encode(encoding))
    with as_utf8(path, encoding) as copy:
        assert str(copy).encode("utf-8")
        assert copy.read_bytes() == path.read_bytes()
