"""Available memory, against the system's values."""

import os
from pathlib import Path

import pytest

from stepbot.runtime import memory


@pytest.mark.skipif(os.name != "posix", reason="sysconf is POSIX")
def test_memory_of_the_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a container it is the machine's memory."""
    monkeypatch.setattr(memory, "_CONTAINER", ())
    size = memory.memory_size()
    assert size == os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    assert memory.worker_limit() == max(size * 3 // 4, 4 << 30)


@pytest.mark.skipif(os.name != "posix", reason="sysconf is POSIX")
@pytest.mark.parametrize(("text", "counts"), [("123456789\n", True), ("max\n", False), ("", False)])
def test_memory_of_a_container(text: str, counts: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a container it is the container's lower limit; a worker may always use what its libraries reserve."""
    file = tmp_path / "memory.max"
    file.write_text(text, encoding="ascii")
    monkeypatch.setattr(memory, "_CONTAINER", (file, tmp_path / "absent"))
    assert (memory.memory_size() == 123456789) == counts
    assert (memory.worker_limit() == memory.LEAST) == (counts or (memory.memory_size() or 0) * 3 // 4 <= memory.LEAST)


def test_a_system_that_does_not_tell(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a value from the system there is no limit."""
    monkeypatch.delattr(os, "sysconf", raising=False)
    assert memory.memory_size() is None
    assert memory.worker_limit() is None
