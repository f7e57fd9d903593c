"""The kernel is started early if a STEP will be read, and only then."""

from pathlib import Path

import pytest

from stepbot.pipeline import prestart as warmup
from stepbot.pipeline.conversion import Options
from stepbot.runtime.cache import Cache, file_digest

SIDECAR = "version: 1\nrobot: arm\nstep: {}\nlinks: {{base: {{rest: true}}}}\n"


@pytest.fixture(autouse=True)
def started(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Functions for which processes would be started."""
    functions: list[str] = []

    class Noted:
        def __init__(self, function: str, *, memory_limit: int | None = None) -> None:
            assert memory_limit is None
            functions.append(function)

    monkeypatch.setattr(warmup, "Worker", Noted)
    return functions


@pytest.mark.parametrize("written", ["a b.step", '"a b.step"', "'a b.step'", "a b.step   # the arm"])
def test_step_that_the_sidecar_names(tmp_path: Path, started: list[str], written: str) -> None:
    """The STEP is found beside the sidecar in each spelling of its name."""
    sidecar = tmp_path / "arm.robot.yaml"
    sidecar.write_text(SIDECAR.format(written), encoding="utf-8")
    assert warmup.started_kernel(sidecar, Options(tmp_path)) is None
    (tmp_path / "a b.step").write_bytes(b"")
    assert warmup.started_kernel(sidecar, Options(tmp_path)) is not None
    assert started == [warmup.KERNEL]


def test_no_kernel_for_what_was_read(tmp_path: Path, started: list[str]) -> None:
    """Cached geometry starts no kernel until the STEP changes."""
    step, cache = tmp_path / "arm.step", Cache(tmp_path / "kept")
    step.write_bytes(b"one")
    options = Options(tmp_path, step=step, cache=cache)
    warmup.note_read(cache, file_digest(step) or "")
    assert warmup.started_kernel(tmp_path / "no.robot.yaml", options) is None
    step.write_bytes(b"two")
    assert warmup.started_kernel(tmp_path / "no.robot.yaml", options) is not None


def test_rubbish_starts_nothing(tmp_path: Path, started: list[str]) -> None:
    """A file that is not a sidecar starts no process."""
    assert warmup.started_kernel(tmp_path, Options(tmp_path)) is None
    (tmp_path / "x").write_bytes(bytes(range(256)))
    assert warmup.started_kernel(tmp_path / "x", Options(tmp_path)) is None
    assert started == []
