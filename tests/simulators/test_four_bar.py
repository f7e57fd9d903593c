"""The four-bar closes: by MuJoCo's rows, by PyBullet's constraints, and in the text of the SDFormat."""

from math import pi
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.engines.observation import Quantity, Request
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import Joint, JointKind, Link, Mimic
from stepbot.verification.compare import compare
from tests.robots import four_bar, four_bar_angles, four_bar_with_zeros
from tests.simulators.conftest import Folder, failures, look, write


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    """The four-bar on disk."""
    return write(four_bar(), tmp_path_factory.mktemp("four_bar"))


def _closed_form(turn: float) -> dict[str, float]:
    """Joint positions for a rotation of the crank from the drawn 60 degrees, by the four-bar's equation."""
    coupler0, rocker0 = four_bar_angles(pi / 3)
    coupler, rocker = four_bar_angles(pi / 3 + turn)
    return {"crank_pin": turn, "coupler_pin": coupler - coupler0 - turn, "ground_pin": rocker - rocker0}


def _full_turn() -> tuple[tuple[dict[str, float], ...], ...]:
    return (tuple(_closed_form(turn) for turn in np.linspace(0.0, 2 * pi, 49)),)


def _turning(folder: Folder, format_name: str) -> Request:
    """A request to close the loop over a full turn of the crank."""
    return Request(
        str(folder.written[format_name].path),
        format_name,
        closures=folder.robot.closures,
        ways=_full_turn(),
        driven=("crank_pin",),
        simulate=0.0,
    )


@pytest.mark.mujoco
def test_newton_in_mujoco_agrees_with_the_closed_form_over_a_full_turn(folder: Folder) -> None:
    """MuJoCo's rows of the MJCF alone give the equation's angles to 1e-9 rad and m."""
    request = _turning(folder, "mjcf")
    (closure,) = look("mujoco", request).closures or ()
    assert closure.name == "rocker_pin"
    assert closure.axes is not None  # by a second constraint, rocker_pin::axis
    assert closure.angle_error is not None
    assert closure.angle_error < 1e-9
    assert closure.residual is not None
    assert closure.residual < 1e-9


def test_drake_holds_what_follows_the_crank(tmp_path: Path) -> None:
    """Drake reads no mimics; a follower beside the loop is set by the crank, and the loop closes to 1e-9."""
    robot = four_bar()
    hand = Link("hand", mass_properties=robot.link_by_name["crank"].mass_properties)
    pin = Joint("hand_pin", JointKind.CONTINUOUS, "ground", "hand", mimic=Mimic("crank_pin", 0.5))
    folder = write(replace(robot, links=(*robot.links, hand), joints=(*robot.joints, pin)), tmp_path)
    observed = look("drake", folder.request("drake.sdf"))
    assert Quantity.CLOSURES not in failures(folder.expected("drake.sdf"), observed)
    (closure,) = observed.closures or ()
    assert closure.residual is not None
    assert 0.0 < closure.residual < 1e-11


@pytest.mark.slow
@pytest.mark.pybullet
def test_pybullet_closes_the_tree_by_a_constraint(folder: Folder) -> None:
    """With the constraint the URDF's residual is below 1e-5 m at 1 ms steps and 1 rad/s, over a full turn."""
    request = _turning(folder, "urdf")
    (closure,) = look("pybullet", request).closures or ()
    assert closure.residual is not None
    assert 0.0 < closure.residual < 1e-5
    assert closure.angle_error is not None
    assert 0.0 < closure.angle_error < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("build", [four_bar, four_bar_with_zeros])
def test_the_closing_joint_parsed_back_is_the_models(build: type, tmp_path: Path) -> None:
    """Both frames of the closing joint are the closure's to 1e-9, also if q = 0 is not the drawn pose."""
    folder = write(build(), tmp_path)
    observed = look("reader", folder.request("sdf"))
    (closure,) = observed.closures or ()
    (expected,) = folder.written["sdf"].robot.closures
    assert (closure.link_a, closure.link_b, closure.kind) == (expected.link_a, expected.link_b, "revolute")
    for seen, ours in ((closure.X_AF, expected.X_AF), (closure.X_BF, expected.X_BF)):
        assert seen is not None
        assert max(seen.distance_to(ours)) < 1e-9
    assert failures(folder.expected("sdf"), observed) == set()


@pytest.mark.slow
@pytest.mark.mujoco
def test_a_loop_without_its_constraint_does_not_follow(folder: Folder, tmp_path: Path) -> None:
    """Without the equality MuJoCo has a tree, and the check fails."""
    path = folder.path / "open.xml"
    text = folder.written["mjcf"].path.read_text(encoding="utf-8")
    start, end = text.index("<equality>"), text.index("</equality>")
    path.write_text(text[:start] + "<equality>" + text[end:], encoding="utf-8")
    request = folder.request("mjcf")
    observed = look("mujoco", replace(request, file=str(path)))
    results = {str(one.quantity): one for one in compare(folder.expected("mjcf"), observed)}
    assert [str(failure) for failure in results["closures"].deviations.failures] == ["closure 'rocker_pin' is missing"]


def test_the_loop_closes_in_the_reference_too() -> None:
    """The position of the pin is the same by the closed form and by stepbot's forward kinematics."""
    robot = four_bar()
    (closure,) = robot.closures
    for q in _full_turn()[0]:
        X_W = link_poses(robot, q)
        gap = (X_W[closure.link_a] @ closure.X_AF).p - (X_W[closure.link_b] @ closure.X_BF).p
        assert float(np.linalg.norm(gap)) < 1e-12
