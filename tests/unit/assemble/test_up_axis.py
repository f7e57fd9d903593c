"""The warning about an assembly drawn with another axis up."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest

from stepbot.assemble import build_robot
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.inertia import DIRECTIONS, Direction, rotation_of, vector
from stepbot.geometry.spatial import Pose
from tests.unit.assemble.workshop import Workshop, at, sidecar

TEXT = """
    defaults: {{density: 1000}}
    {root}
    links: {{base: {{parts: [foot]}}, post: {{parts: [post]}}, arm: {{parts: [arm]}}}}
    joints:
      f: {{type: fixed, parent: base, child: post, origin: {{xyz: [0, 0, 0]}}}}
      j: {{type: continuous, parent: post, child: arm, origin: {{component: foot}}, axis: {axis}}}
"""


def codes(
    up: Direction, folder: Path, root: str = "", axis: str = "z", foot: float = 100.0, arm: float = 200.0
) -> list[str]:
    """The codes for a foot, a post on it and an arm that turns on it, drawn with an axis up."""
    forward: Direction = "y" if up.endswith("x") else "x"
    X = Pose.of(rotation_of(up, forward))
    shop = Workshop()
    shop.box("foot", (foot, foot, 10), X @ at(0, 0, 5))
    shop.box("post", (30, 30, 80), X @ at(0, 0, 50))
    shop.box("arm", (150, 30, arm), X @ at(0, 0, 90 + arm / 2, (0.2, 0.3, 0.1)))
    diagnostics = Diagnostics()
    loaded = sidecar(folder, TEXT.format(root=root, axis=axis))
    assert build_robot(shop.assembly, loaded, lambda: shop.measures, diagnostics) is not None
    return [str(d) for d in diagnostics if d.code == "SB421"]


@pytest.mark.parametrize("up", DIRECTIONS)
def test_arms_in_all_orientations(up: Direction, tmp_path: Path) -> None:
    """An arm lying on its side is reported with the axis to set; one that stands or hangs is not."""
    found = codes(up, tmp_path)
    if up.endswith("z"):
        assert found == []
        return
    (message,) = found
    assert f"drawn with {up} up" in message


@pytest.mark.parametrize(
    "root", ["root: {up: z}", "root: {up: y}", "root: {forward: y}", "root: {frame: {component: foot}}"]
)
def test_a_sidecar_that_sets_the_axis(root: str, tmp_path: Path) -> None:
    """A sidecar that sets an axis or a frame causes no warning."""
    assert codes("y", tmp_path, root) == []


def test_weak_evidence(tmp_path: Path) -> None:
    """Without a vertical joint, with a small foot, or with a low assembly, there is no warning."""
    assert codes("y", tmp_path) != []
    assert codes("y", tmp_path, axis="x") == []
    assert codes("y", tmp_path, foot=32.0) == []
    assert codes("y", tmp_path, foot=300.0, arm=20.0) != []  # 110 mm high on a plate of 300 mm, more than 0.4
    assert codes("y", tmp_path, foot=300.0, arm=1.0) == []


def test_rotations() -> None:
    """Each pair of directions gives a rotation whose columns are forward, left and up."""
    for up, forward in product(DIRECTIONS, DIRECTIONS):
        if up[-1] != forward[-1]:
            R = rotation_of(up, forward)
            assert np.linalg.det(R) == pytest.approx(1.0)
            assert (R[:, 0] == vector(forward)).all()
            assert (R[:, 2] == vector(up)).all()
