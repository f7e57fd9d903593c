"""Mass properties by trimesh, against closed forms."""

import subprocess
import sys

import numpy as np
import pytest

from stepbot.geometry.mass_properties import measured
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.mesh_worker import MESH_WORKER
from stepbot.geometry.spatial import Pose, rotation_from_rpy
from tests.processes import call_isolated

CORNERS = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)
FACES = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
)
SIZE = np.array([0.03, 0.05, 0.07])
X_AB = Pose.of(rotation_from_rpy((0.3, -1.1, 2.0)), (1000.0, -2000.0, 500.0))


def box() -> TriMesh:
    """A box of 30 x 50 x 70 mm with a corner at the origin."""
    return TriMesh.of(CORNERS * SIZE, FACES)


def test_box() -> None:
    """Volume, com and inertia of a box."""
    found = measured(box())
    assert found is not None
    volume = SIZE.prod()
    a, b, c = SIZE**2
    assert found.volume == pytest.approx(volume, rel=1e-12)
    assert found.unit_density.com == pytest.approx(SIZE / 2, rel=1e-12)
    expected = volume / 12 * np.diag([b + c, a + c, a + b])
    assert np.abs(np.array(found.unit_density.inertia) - expected).max() < 1e-12 * expected.max()


def test_far_from_the_origin() -> None:
    """Kilometres from the origin, where vertices are rounded to nanometres, six digits remain."""
    far = measured(box().moved(X_AB))
    near = measured(box())
    assert far is not None
    assert near is not None
    moved = near.unit_density.moved(X_AB)
    assert far.volume == pytest.approx(near.volume, rel=1e-6)
    assert np.abs(np.subtract(far.unit_density.com, moved.com)).max() < 1e-9
    inertia = np.array(moved.inertia)
    assert np.abs(np.array(far.unit_density.inertia) - inertia).max() < 1e-6 * np.abs(inertia).max()


def test_the_order_of_summation_makes_no_difference() -> None:
    """The bytes do not depend on the order of summation, which differs between processors and versions of numpy."""
    rng = np.random.default_rng(5)
    angles = 2 * np.pi * np.arange(2000) / 2000
    rim = np.c_[np.cos(angles), np.sin(angles), np.zeros(2000)]
    vertices = 0.03 * np.vstack([rim, [(0.1, 0.2, -1.0), (0.0, 0.1, 1.0)]])
    near, far = np.arange(2000), np.roll(np.arange(2000), -1)
    faces = np.vstack([np.c_[far, near, np.full(2000, 2000)], np.c_[near, far, np.full(2000, 2001)]])
    expected = measured(TriMesh.of(vertices, faces))
    assert expected is not None
    for _ in range(20):
        assert measured(TriMesh.of(vertices, rng.permutation(faces))) == expected


@pytest.mark.parametrize(
    "mesh",
    [
        TriMesh.of(np.empty((0, 3)), np.empty((0, 3))),
        TriMesh.of(CORNERS, FACES[:-1]),
        TriMesh.of(CORNERS, FACES[:, ::-1]),
        TriMesh.of(CORNERS, np.vstack([FACES[:1, ::-1], FACES[1:]])),
        TriMesh.of(CORNERS * (1, 1, 0), FACES),
    ],
    ids=["empty", "open", "inside out", "one face turned", "flat"],
)
def test_no_volume(mesh: TriMesh) -> None:
    """A mesh without volume has no mass properties."""
    assert measured(mesh) is None


def test_in_a_process_of_its_own() -> None:
    """In a separate process without trimesh's optional imports the numbers are equal to the last bit."""
    meshes = (box(), box().moved(X_AB), TriMesh.of(CORNERS, FACES[1:]))
    before = {name for name in ("scipy", "networkx") if name in sys.modules}
    assert call_isolated(MESH_WORKER, "measures", meshes) == tuple(map(measured, meshes))
    assert call_isolated(MESH_WORKER, "measures", meshes)[2] is None
    assert before <= set(sys.modules)


@pytest.mark.slow
def test_what_is_withheld_comes_back() -> None:
    """scipy can be imported after trimesh."""
    program = (
        "import sys; from stepbot.geometry.mass_properties import prepare; prepare();"
        "assert 'trimesh.triangles' in sys.modules; assert 'scipy' not in sys.modules; import scipy, networkx"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", program], check=True)
