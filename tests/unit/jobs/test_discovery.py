"""Finding sidecars."""

from pathlib import Path

from stepbot.jobs.discovery import find_sidecars, robot_name
from tests.conftest import ReadDiagnostics


def make(folder: Path, *names: str) -> None:
    """Create empty files."""
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("", encoding="utf-8")


def test_folder(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """All sidecars below a folder are found in order; none in hidden folders, and no files with similar names."""
    names = ["b/robot.yaml", "a/arm.robot.yml", "c.robot.yaml"]
    make(tmp_path, *names, ".git/x.robot.yaml", "a/myrobot.yaml", "a/arm.robot.yaml.orig", "robots.yaml")
    sidecars = find_sidecars([tmp_path], diagnostics)
    assert [path.relative_to(tmp_path).as_posix() for path in sidecars] == ["c.robot.yaml", *sorted(names[:2])]


def test_list(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A list names sidecars and folders relative to itself; each is used once."""
    make(tmp_path, "robots/a.robot.yaml", "other/b.robot.yaml")
    (tmp_path / "all.txt").write_text("# ours\n\nother/b.robot.yaml\nrobots\n", encoding="utf-8")
    sidecars = find_sidecars([tmp_path / "all.txt", tmp_path / "robots" / "a.robot.yaml"], diagnostics)
    assert [path.name for path in sidecars] == ["b.robot.yaml", "a.robot.yaml"]


def test_lists_that_name_each_other(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Each list is read once."""
    make(tmp_path, "a.robot.yaml", "b.robot.yaml")
    (tmp_path / "one.txt").write_text("two.txt\nb.robot.yaml\none.txt\n", encoding="utf-8")
    (tmp_path / "two.txt").write_text("a.robot.yaml\none.txt\n", encoding="utf-8")
    assert [path.name for path in find_sidecars([tmp_path / "one.txt"], diagnostics)] == [
        "a.robot.yaml",
        "b.robot.yaml",
    ]
    assert not diagnostics.codes()


def test_nothing_there(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A folder without sidecars and a missing list are errors; a missing sidecar is reported later."""
    assert find_sidecars([tmp_path, tmp_path / "no.txt", tmp_path / "no.robot.yaml"], diagnostics) == [
        tmp_path / "no.robot.yaml"
    ]
    assert diagnostics.codes() == ["SB001", "SB001"]


def test_help_for_a_folder_without_sidecars(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A STEP file can be drafted; a description is converted where it is named."""
    make(tmp_path, "my arm.step", "b.urdf", "notes.md")
    assert not find_sidecars([tmp_path], diagnostics)
    assert next(iter(diagnostics)).help[1:] == (
        f"`stepbot init '{tmp_path.as_posix()}/my arm.step'` drafts one",
        f"batch takes descriptions by their path: '{tmp_path.as_posix()}/b.urdf'",
    )


def test_names(tmp_path: Path) -> None:
    """A robot is named after its sidecar, or after the folder if the file name is generic."""
    assert robot_name(Path("x/arm.robot.yaml")) == "arm"
    assert robot_name(Path("x/arm.yml")) == "arm"
    assert robot_name(tmp_path / "arm7" / "robot.yaml") == "arm7"
