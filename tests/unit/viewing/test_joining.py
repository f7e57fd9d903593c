"""Axes for a joint between two parts."""

from pathlib import Path

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Vector3
from stepbot.step.assembly import Assembly, ReadOptions
from stepbot.step.features.axes import Selector
from stepbot.step.reader import start_reading
from stepbot.viewing.joining import SharedLine, lines_of_origin, shared_lines
from tests.parts import write_hinge


def read(path: Path) -> Assembly:
    """The assembly of a STEP file."""
    assembly = start_reading(path, ReadOptions()).finish(Diagnostics())
    assert assembly is not None
    return assembly


def indices(assembly: Assembly, *paths: str) -> list[int]:
    """Indices of components."""
    return [next(one.index for one in assembly.components if one.path == path) for path in paths]


def distance(assembly: Assembly, line: SharedLine, point: Vector3) -> float:
    """Distance [m] of a point of the assembly from a line."""
    X_WC = next(one.X_WC for one in assembly.components if one.path == line.component)
    arm = np.array(point) - X_WC.apply(line.point)
    return float(np.linalg.norm(np.cross(arm, X_WC.turn(line.direction))))


def test_the_line_that_both_share(tmp_path: Path) -> None:
    """A pin and a bore share the line on which they are drawn; its words give its direction and its place."""
    write_hinge(tmp_path / "hinge.step")
    hinge = read(tmp_path / "hinge.step")
    plate, arm = indices(hinge, "plate", "arm")
    (line,) = shared_lines(hinge, plate, arm)
    assert (line.form, line.chosen, line.radius, line.near) == ("mate", True, None, None)
    assert distance(hinge, line, (0.1, 0.011, 0.05)) < 1e-9
    assert line.words == "shaft in bore, radius 10.05 and 10 mm, +y through [100, 11, 50] mm"


def test_lines_of_each_part_where_none_is_shared(tmp_path: Path) -> None:
    """Where a bore misses the pin, the axes of each part alone remain: first that of the part that moves."""
    write_hinge(tmp_path / "hinge.step", miss=1.0)
    hinge = read(tmp_path / "hinge.step")
    plate, arm = indices(hinge, "plate", "arm")
    moving, standing = shared_lines(hinge, plate, arm)
    assert (moving.form, moving.component, standing.form, standing.component) == ("second", "arm", "first", "plate")
    assert distance(hinge, standing, (0.1, 0.011, 0.05)) < 1e-9
    assert distance(hinge, moving, (0.1, 0.011, 0.05)) == pytest.approx(1e-3)


@pytest.mark.slow
def test_lines_of_the_link_where_the_part_shares_none(robot_library: Path) -> None:
    """A pillar shares no line with a crank; the bar on the same link has the pin that the crank turns on."""
    assembly = read(robot_library / "stepbot_four_bar" / "four_bar.step")
    pillar, bar, crank = indices(assembly, "frame/pillar:1", "frame/ground bar", "crank")
    (line,) = shared_lines(assembly, pillar, crank, [pillar, bar])
    assert line.form == "auto"
    assert distance(assembly, line, (0.0, 0.0, 0.12)) < 1e-9


def test_lines_of_an_origin(tmp_path: Path) -> None:
    """All lines of a mate are offered; the one that its selectors mean is marked, the default needs none."""
    write_hinge(tmp_path / "hinge.step", bolts=True)
    hinge = read(tmp_path / "hinge.step")
    plate, arm = ([index] for index in indices(hinge, "plate", "arm"))
    pin, *bolts = lines_of_origin(hinge, plate, arm, Selector())
    assert len(bolts) == 4
    assert pin.chosen
    assert (pin.radius, pin.near) == (None, None)
    assert not any(one.chosen for one in bolts)
    for bolt in bolts:
        assert bolt.near is not None
        again = lines_of_origin(hinge, plate, arm, Selector(bolt.radius, bolt.near))
        assert [one.words for one in again if one.chosen] == [bolt.words]
    explicit = lines_of_origin(hinge, plate, arm, Selector(), all_explicit=True)[0]
    assert (explicit.words, explicit.chosen, explicit.radius) == (pin.words, True, 0.01005)
    assert lines_of_origin(hinge, [], None, Selector()) == ()
    assert pytest.approx(0.0, abs=1e-9) == distance(
        hinge, lines_of_origin(hinge, plate, None, Selector())[0], (0.1, 0.0, 0.05)
    )
