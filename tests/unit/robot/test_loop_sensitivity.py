"""Sensitivity of closed loops to gaps, against closed forms."""

from math import cos, sin, sqrt

import numpy as np
import pytest

from stepbot.geometry.spatial import Pose
from stepbot.robot.loop_followers import loop_sensitivity
from stepbot.robot.model import Joint, JointKind, Link, LoopClosure, Robot

_CRANK, _ROD = 0.03, 0.1


def _slider_crank() -> Robot:
    """A slider on x that pushes a rod, whose end is pinned to a crank about the origin, all in the plane of x and y."""
    links = (Link("base"), Link("crank"), Link("slider"), Link("rod"))
    z = (0.0, 0.0, 1.0)
    joints = (
        Joint("turn", JointKind.CONTINUOUS, "base", "crank", axis=z),
        Joint("slide", JointKind.PRISMATIC, "base", "slider", axis=(1.0, 0.0, 0.0)),
        Joint("pin", JointKind.CONTINUOUS, "slider", "rod", axis=z),
    )
    ends = Pose.of(position=(_CRANK, 0.0, 0.0)), Pose.of(position=(-_ROD, 0.0, 0.0))
    return Robot("r", links, joints, (LoopClosure("end", JointKind.REVOLUTE, "crank", ends[0], "rod", ends[1], z),))


def _closed(slide: float) -> dict[str, float]:
    """The configuration at a position of the slider, by the law of cosines."""
    at_origin = (slide**2 + _CRANK**2 - _ROD**2) / (2.0 * slide * _CRANK)
    turn = np.arccos(at_origin)
    y, x = _CRANK * sin(turn), slide - _CRANK * cos(turn)
    return {"slide": slide, "turn": float(turn), "pin": -float(np.arctan2(y, x))}


@pytest.mark.parametrize("slide", [0.1, 0.12, 0.129, 0.12999])
def test_driven_by_the_slider(slide: float) -> None:
    """The rows of crank and rod span the gap; towards the dead centre they become parallel."""
    q = _closed(slide)
    along = [(-_CRANK * sin(q["turn"]), _CRANK * cos(q["turn"])), (_ROD * sin(q["pin"]), -_ROD * cos(q["pin"]))]
    (a, b), (c, d) = along
    squares, determinant = a * a + b * b + c * c + d * d, a * d - b * c
    least = sqrt((squares - sqrt(squares**2 - 4.0 * determinant**2)) / 2.0)
    assert loop_sensitivity(_slider_crank(), [q], ("slide",)) == pytest.approx(1.0 / least, rel=1e-9)


def test_worst_configuration_counts() -> None:
    """Of several configurations, the one that is nearest to the dead centre counts."""
    robot, near, far = _slider_crank(), _closed(0.1299), _closed(0.11)
    both = loop_sensitivity(robot, [far, near], ("slide",))
    assert both == loop_sensitivity(robot, [near], ("slide",)) > loop_sensitivity(robot, [far], ("slide",))


def test_robot_without_loops() -> None:
    """Without loops there are no gaps."""
    robot = _slider_crank()
    assert loop_sensitivity(Robot("r", robot.links, robot.joints), [_closed(0.1)], ("slide",)) == 0.0
