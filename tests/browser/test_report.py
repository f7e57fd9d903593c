"""The report of the delta robot in a browser: it moves, and its loops stay closed."""

from pathlib import Path

import numpy as np
import pytest

from stepbot.pipeline.conversion import REPORT_PAGE, Options
from stepbot.pipeline.stages import produce
from stepbot.robot.closures import Loops
from stepbot.robot.model import Robot

from .page import Page

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def delta(robot_library: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Robot, Path]:
    """The robot, and its report on disk."""
    folder = tmp_path_factory.mktemp("report")
    sidecar = robot_library / "stepbot_delta" / "delta.robot.yaml"
    conversion = produce(sidecar, Options(folder, formats=("urdf",), verify=False, html=True))
    assert conversion.robot is not None
    path = folder / REPORT_PAGE
    path.write_bytes(conversion.files[REPORT_PAGE])
    return conversion.robot, path


def test_the_robot_moves_and_its_loops_stay_closed(delta: tuple[Robot, Path], page: Page) -> None:
    """Each slider moves the platform; stepbot's own closures are closed at the positions that the page solved."""
    robot, path = delta
    page.open(path.as_uri())
    loops = Loops(robot)
    before = np.array(page.poses()["platform"])
    for number, (name, value) in enumerate((("shoulder_1", 20.0), ("shoulder_2", -15.0), ("shoulder_3", 35.0))):
        page.slide(name, value)
        q = page.positions()
        assert q[name] == pytest.approx(np.radians(value), abs=1e-9), number
        gaps = loops.gaps(loops.tree.vector(q))
        assert max(distance for distance, _ in gaps.values()) < 1e-8
        after = np.array(page.poses()["platform"])
        assert np.linalg.norm(after[9:] - before[9:]) > 5e-3
        np.testing.assert_allclose(after[:9], np.eye(3).ravel(), atol=1e-6)  # a delta keeps its platform level
        before = after


@pytest.mark.parametrize("width", [1280, 420])
def test_the_page_fits_its_window(width: int, delta: tuple[Robot, Path], page: Page) -> None:
    """Wide tables scroll in themselves, not the page; the robot is above the tables."""
    page.resize(width, 800)
    page.open(delta[1].as_uri())
    assert page.run("return document.documentElement.scrollWidth") <= width
    stage, report = (page.element(selector).rect for selector in ("#stage", "#report"))
    assert stage["height"] > 250
    assert report["y"] >= stage["y"] + stage["height"]
