"""`stepbot datasheet` of robots of the library, against the figures that their makers publish."""

import json
from math import hypot
from pathlib import Path
from typing import Any

import pytest

from .conftest import Stepbot

LIBRARY = Path(__file__).parents[2] / "robot_library"


def sheet_of(stepbot: Stepbot, robot: str) -> Any:
    """The data sheet of a robot of the library."""
    (sidecar,) = (LIBRARY / robot).glob("*.robot.yaml")
    return json.loads(stepbot("datasheet", str(sidecar), "--json").out)["datasheet"]


@pytest.mark.slow
def test_ur5e(stepbot: Stepbot) -> None:
    """Denavit-Hartenberg parameters are those that Universal Robots publishes, the reach is 850 mm, the payload 5 kg.

    https://www.universal-robots.com/articles/ur/application-installation/dh-parameters-for-calculations-of-kinematics-and-dynamics/
    """
    sheet = sheet_of(stepbot, "universal_robots_ur5e")
    (arm,) = sheet["arms"]
    rows = arm["dh"]["rows"]
    assert [row["d"] for row in rows] == pytest.approx([0.1625, 0.0, 0.0, 0.1333, 0.0997, 0.0996], abs=1e-6)
    assert [abs(row["a"]) for row in rows] == pytest.approx([0.0, 0.425, 0.3922, 0.0, 0.0, 0.0], abs=1e-6)
    assert hypot(rows[1]["a"] + rows[2]["a"], rows[3]["d"] + rows[5]["d"]) == pytest.approx(0.850, abs=1e-3)
    assert arm["dh"]["deviation"] < 1e-6
    assert 5.0 < arm["payloads"][-1][1] < 12.5
    assert all(joint["acceleration"] > 0.0 for joint in sheet["joints"])


@pytest.mark.long
def test_panda(stepbot: Stepbot) -> None:
    """The reach is 855 mm within a tenth, and efforts hold more than 3 kg at it; a DH row of the published table."""
    (arm,) = sheet_of(stepbot, "franka_panda")["arms"]
    assert arm["reach"] == pytest.approx(0.855, rel=0.1)
    assert 3.0 < arm["payloads"][-1][1] < 9.0
    distances = [row["d"] for row in arm["dh"]["rows"]]
    assert [distances[0], distances[2], distances[4]] == pytest.approx([0.333, 0.316, 0.384], abs=1e-6)


@pytest.mark.long
def test_youbot(stepbot: Stepbot) -> None:
    """Axes are 33, 155 and 135 mm apart, and the arm holds its 0.5 kg stretched."""
    (arm,) = sheet_of(stepbot, "kuka_youbot")["arms"]
    assert sorted(abs(row["a"]) for row in arm["dh"]["rows"])[-3:] == pytest.approx([0.033, 0.135, 0.155], abs=1e-3)
    assert arm["payloads"][-1][1] > 0.5


@pytest.mark.slow
def test_page_is_markdown(stepbot: Stepbot) -> None:
    """Without `--json` it is a page with a table of joints and of arms."""
    page = stepbot("datasheet", str(LIBRARY / "universal_robots_ur5e" / "ur5e.robot.yaml")).out
    assert page.startswith("# ur5e")
    assert "| elbow_joint | -3.142 to 3.142 | 3.142 | 150 |" in page
    assert "| DH, modified |" in page
