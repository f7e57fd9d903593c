"""The size of a tree is computed before the kernel expands it."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.step.assembly import ReadOptions
from stepbot.step.reader import start_reading
from tests.hostile.trees import write_tree


@pytest.mark.parametrize(("levels", "children", "count"), [(8, 10, "111,111,111"), (30, 2, "2,147,483,647")])
def test_shared_assemblies_of_millions_are_refused(tmp_path: Path, levels: int, children: int, count: str) -> None:
    """A few kilobytes that expand to 10^8 components or more are rejected with the number."""
    step = tmp_path / "tree.step"
    write_tree(step, levels, children)
    assert step.stat().st_size < 100_000
    diagnostics = Diagnostics()
    assert start_reading(step, ReadOptions(), memory_limit=2 << 30).finish(diagnostics) is None
    (error,) = diagnostics
    assert error.code == "SB215"
    assert count in error.message


def test_shared_assemblies_are_read(tmp_path: Path) -> None:
    """The same structure with few components is read: 1 + 3 + 9 + 27."""
    step = tmp_path / "tree.step"
    write_tree(step, 3, 3)
    diagnostics = Diagnostics()
    assembly = start_reading(step, ReadOptions()).finish(diagnostics)
    assert assembly is not None, list(map(str, diagnostics))
    assert len(assembly.components) == 40
