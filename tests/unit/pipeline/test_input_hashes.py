"""The input files of a report and their hashes."""

import hashlib
from pathlib import Path

from stepbot.pipeline.loading import input_hashes, input_names


def test_files_of_one_name_in_several_packages_are_told_apart(tmp_path: Path) -> None:
    """Names are relative to the description's folder; outside of it, with as many folders as they need."""
    files = [tmp_path / name for name in ("a/meshes/link.stl", "b/meshes/link.stl", "robot/parts/link.stl")]
    for path in (*files, tmp_path / "robot/robot.urdf"):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(str(path), encoding="utf-8")
    named = input_names(tmp_path / "robot/robot.urdf", [*files, files[0]])
    assert list(named) == ["robot.urdf", "link.stl", "meshes/link.stl", "parts/link.stl"]
    assert input_hashes(named) == {name: hashlib.sha256(str(path).encode()).hexdigest() for name, path in named.items()}


def test_a_file_that_is_gone_leaves_no_hashes(tmp_path: Path) -> None:
    """Which version of the others was read is unknown then, too."""
    (tmp_path / "here").write_text("a", encoding="utf-8")
    assert input_hashes({"here": tmp_path / "here", "gone": tmp_path / "gone"}) == {}
