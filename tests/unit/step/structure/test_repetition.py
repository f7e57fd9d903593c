"""Many occurrences of one product are placed without the kernel, with the same result."""

from pathlib import Path

import numpy as np
import pytest

from robot_library.moments import pose, turn
from robot_library.step_file import Assembly, LengthUnit, Occurrence
from stepbot.step.assembly import Component, ReadOptions
from stepbot.step.structure import repetition
from tests import parts, solids
from tests.unit.step.in_process import read_quietly

TREE = ReadOptions(geometry=False)


def write_alternating(path: Path, unit: LengthUnit = "mm", color: str = "") -> list[str]:
    """Pins and blocks in turn, forty of each, all rotated differently; their names in file order."""
    pin, block = parts.drawn("pin", solids.cylinder(2, 10)), parts.drawn("block", solids.box(1, 2, 3))
    children = [
        Occurrence(
            (pin, block)[i % 2],
            f"{'pin' if i % 2 == 0 else 'block'}:{i}",
            pose((3.3 * i, -i, 0.1 * i * i), turn("x", 0.1 * i) @ turn("z", 1.7 * i)),
            color=color if i == 33 else "",
        )
        for i in range(80)
    ]
    holder = Assembly("holder", children)
    root = Assembly("root", [Occurrence(holder, "a", pose((7, 8, 9), turn("y", 0.3))), Occurrence(holder, "b")])
    parts.draw(path, root, unit)
    return [child.name for child in children]


def kernel_places_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the kernel place every occurrence."""
    monkeypatch.setattr(repetition, "MANY", 10_000)


def assert_same(found: tuple[Component, ...], expected: tuple[Component, ...]) -> None:
    """Assert equal trees, and poses equal except for the last bits."""
    assert [(c.path, c.product, c.occurrence, c.parent, c.body, c.color) for c in found] == [
        (c.path, c.product, c.occurrence, c.parent, c.body, c.color) for c in expected
    ]
    for a, b in zip(found, expected, strict=True):
        assert np.abs(a.X_WC.matrix - b.X_WC.matrix).max() < 1e-12


@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_placed_as_the_kernel_would(unit: LengthUnit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names, order and poses are those of the kernel."""
    path = tmp_path / "many.step"
    names = write_alternating(path, unit)
    quick = read_quietly(path, TREE).components
    kernel_places_all(monkeypatch)
    assert_same(quick, read_quietly(path, TREE).components)
    assert [c.occurrence for c in quick if c.parent == 1] == names


def test_a_kernel_that_disagrees_gets_all_the_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the formula does not give the kernel's pose, the kernel places all."""
    path = tmp_path / "many.step"
    write_alternating(path)
    expected = read_quietly(path, TREE).components
    checked = []

    def disagree(self: repetition.Repetition, placed: object) -> None:
        checked.append(placed)
        raise repetition.MisplacedOccurrence

    monkeypatch.setattr(repetition.Repetition, "check", disagree)
    assert_same(read_quietly(path, TREE).components, expected)
    assert checked


def test_a_turn_is_another_placement_however_far_away() -> None:
    """Of two poses 1000 km from the origin, one is turned by a microradian: rounding is 1e-10 m there."""
    far = np.array(pose((1e6, -2e6, 3e6), turn("x", 0.3)))
    found = repetition.Repetition(0, {0: far})
    found.check(np.array(pose((1e6 + 1e-9, -2e6, 3e6), turn("x", 0.3))))
    with pytest.raises(repetition.MisplacedOccurrence):
        found.check(np.array(pose((1e6, -2e6, 3e6), turn("x", 0.3 + 1e-6))))


def test_coloured_occurrences_are_left_to_the_kernel(tmp_path: Path) -> None:
    """Coloured occurrences are placed by the kernel, which attaches the colours."""
    path = tmp_path / "many.step"
    write_alternating(path, color="#ff0000")
    colored = [c.occurrence for c in read_quietly(path, TREE).components if c.color == (1.0, 0.0, 0.0, 1.0)]
    assert colored == ["block:33", "block:33"]


@pytest.mark.slow
def test_thousands_cost_next_to_nothing(tmp_path: Path) -> None:
    """Three thousand occurrences of one pin have one body."""
    path = tmp_path / "row.step"
    parts.write_many(path, 3000)
    assembly = read_quietly(path)
    assert (len(assembly.components), len(assembly.bodies)) == (3001, 1)
    assert [c.X_WC.position[0] for c in assembly.components[1:]] == pytest.approx([0.005 * i for i in range(3000)])
