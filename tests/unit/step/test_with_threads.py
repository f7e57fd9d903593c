"""A kernel process with a thread, started by an import, makes all bodies itself."""

from pathlib import Path

import pytest

from stepbot.step import reader
from stepbot.step.assembly import ReadOptions
from tests import parts
from tests.conftest import ReadDiagnostics


@pytest.mark.long
def test_a_body_that_takes_too_long(
    tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A body that takes too long is stopped and reported by name, long before the time limit of the file."""
    monkeypatch.setattr(reader, "KERNEL", "tests.unit.step.stuck_kernel:hanging_beside_a_thread")
    monkeypatch.setattr(reader, "BODY_SECONDS", 5.0)
    path = parts.write_nested(tmp_path / "nested.step").path
    assembly = reader.start_reading(path, ReadOptions()).finish(diagnostics, timeout=90.0)
    assert assembly is not None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB213"
    assert "time limit of 5 s exceeded" in diagnostic.message
    assert [len(body.mesh.faces) > 0 for body in assembly.bodies].count(False) == 1
