"""Nothing in the library is older than what it was made from; judged by hashes, without drawing anything."""

from pathlib import Path

import pytest

from robot_library import fingerprints, making, pages, preview
from tests.library.conftest import LIBRARY, every_robot


@every_robot
def test_nothing_is_stale(robot: str) -> None:
    """STEP, tables and picture were made from the scripts, the sidecar and the renderer that there are now."""
    assert making.stale(LIBRARY / robot) == [], "run `make library`"


def test_the_gallery_shows_every_robot() -> None:
    """Pictures and table of the library's README are what the pages of the robots say."""
    assert not making.gallery_is_stale(), "run `make library`, or `python -m robot_library --stale`"


@pytest.mark.parametrize("name", ["build.py", "expected.json", "robot.robot.yaml", "robot.step", "view.py"])
def test_a_change_of_any_source_is_noticed(name: str, tmp_path: Path) -> None:
    """Each file that something is made from changes the hash of what is made from it, and no other hash."""
    for file in ("build.py", "expected.json", "robot.robot.yaml", "robot.step", "view.py"):
        (tmp_path / file).write_text("1\n", encoding="utf-8")
    hashes = (fingerprints.drawing, fingerprints.robot, fingerprints.picture)
    before = [hash_of(tmp_path) for hash_of in hashes]
    (tmp_path / name).write_text("2\n", encoding="utf-8")
    changed = {h.__name__ for h, was in zip(hashes, before, strict=True) if h(tmp_path) != was}
    assert (
        changed
        == {
            "build.py": {"drawing"},
            "expected.json": {"drawing"},
            "robot.robot.yaml": {"robot", "picture"},
            "robot.step": {"robot", "picture"},
            "view.py": {"picture"},
        }[name]
    )


def test_ends_of_lines_are_no_change(tmp_path: Path) -> None:
    """A checkout with other ends of lines is not stale."""
    (tmp_path / "build.py").write_bytes(b"a\nb\n")
    before = fingerprints.drawing(tmp_path)
    (tmp_path / "build.py").write_bytes(b"a\r\nb\r\n")
    assert fingerprints.drawing(tmp_path) == before


def test_a_page_keeps_what_is_written_by_hand() -> None:
    """Only what lies between the marks is replaced; a page without marks gets the part at its end."""
    part = f"{pages.START}\nnew\n{pages.END}\n"
    page = f"# robot\n\nBy hand.\n\n{pages.START}\nold\n{pages.END}\n\nAlso by hand.\n"
    assert pages.with_part(page, part) == page.replace("old", "new")
    assert pages.with_part("# robot\n", part) == f"# robot\n\n{part}"


def test_pictures_are_all_of_one_size() -> None:
    """One style for all: the same width and height, read from the headers of the files."""
    sizes = {path: path.read_bytes()[16:24] for path in sorted(LIBRARY.glob("*/preview.png"))}
    size = preview.WIDTH.to_bytes(4, "big") + preview.HEIGHT.to_bytes(4, "big")
    assert {path.parent.name for path, found in sizes.items() if found != size} == set()
