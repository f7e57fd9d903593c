"""Vertices of mesh files that descriptions name."""

from pathlib import Path

import pytest

from stepbot.engines.resources import mesh_file_bounds, vertices_of
from stepbot.geometry.spatial import IDENTITY

_BAD = (
    b"",
    b"f 1 2 3\n",
    b"v 1 2\n",
    b"v 0 0 0\nv 1 2\n",
    b"v x y z\n",
    b"v nan 0 0\n",
    b"v 1e400 0 0\n",
    bytes(range(256)),
)


@pytest.mark.parametrize("content", _BAD)
@pytest.mark.parametrize("suffix", [".obj", ".stl", ".dae", ".ply"])
def test_a_mesh_without_finite_vertices_has_no_size(content: bytes, suffix: str, tmp_path: Path) -> None:
    """Nothing raises over a file that is empty, broken or of another kind."""
    path = tmp_path / f"part{suffix}"
    path.write_bytes(content)
    assert vertices_of(path) is None
    assert mesh_file_bounds(path.name, tmp_path / "robot.urdf", IDENTITY) == (None, [])


def test_an_obj_with_colours_of_vertices_has_its_size(tmp_path: Path) -> None:
    """Words after the coordinates are colours or a weight."""
    (tmp_path / "part.obj").write_bytes(b"# made\nv 0 0 0 1 0 0\nv 1 2 3 1 0 0\n")
    assert mesh_file_bounds("part.obj", tmp_path / "robot.urdf", IDENTITY)[0] == ((0, 0, 0), (1, 2, 3))
