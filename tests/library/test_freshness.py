"""Results in the library are up to date, by hashes of their inputs, without drawing anything.

The hashes do not include stepbot's own code: a fresh conversion is compared with the numbers of each page.
"""

import re
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from robot_library import fingerprints, making, pages, preview
from stepbot.pictures.picture import draw
from stepbot.runtime.robot_library import LibraryRobot
from tests.library.conftest import LIBRARY, Converted, every_converted_robot, every_robot, sidecar_of


@every_robot
def test_nothing_is_stale(robot: str) -> None:
    """STEP, tables and picture are those of the current scripts, sidecar and renderer."""
    assert making.stale(LIBRARY / robot) == [], "run `make library`"


def test_metadata_makes_nothing_stale(tmp_path: Path) -> None:
    """The metadata of a sidecar is in no table, picture or drive test; every other line is."""
    sidecar = tmp_path / "a.robot.yaml"
    hashes = []
    for text in ("base: fixed\n", "base: fixed\n\nmetadata: {license: MIT}\n", "base: floating\n"):
        sidecar.write_text(text, encoding="utf-8")
        hashes.append((fingerprints.robot(tmp_path), fingerprints.drives(tmp_path), fingerprints.picture(tmp_path)))
    assert hashes[0] == hashes[1]
    assert all(a != b for a, b in zip(hashes[0], hashes[2], strict=True))


def test_the_gallery_shows_every_robot() -> None:
    """Pictures and table of the library's README are those of the robots' pages."""
    assert not making.gallery_is_stale(), "run `make library`, or `python -m robot_library --stale`"


@pytest.mark.slow
@every_converted_robot
def test_the_page_has_the_numbers_of_a_fresh_conversion(robot: str, converted: Converted) -> None:
    """Joints, limits, masses, centres and inertias in the tables equal a fresh conversion, to the digits shown."""
    reported, page = converted(robot).report["robot"], LibraryRobot(LIBRARY / robot, sidecar_of(robot))
    for title, expected in (("Joints", joint_cells), ("Links", link_cells)):
        rows = {row[0]: row[1:] for row in page.table(title)}
        for entry in reported[title.lower()]:
            for cell, value in zip(rows[entry["name"]], expected(entry), strict=True):
                assert (cell.split(",")[0] if isinstance(value, str) else numbers(cell)) == value, entry["name"]


def joint_cells(joint: dict[str, Any]) -> list[Any]:
    """The cells of a joint's row: words, and numbers in the units of the table."""
    limits, angular = joint["limits"], joint["kind"] != "prismatic"
    axis = [] if joint["kind"] in ("fixed", "ball") else joint["axis"]
    shown = [[] if q is None else [degrees(q) if angular else 1000 * q] for q in (limits["lower"], limits["upper"])]
    rates = [[] if limits[key] is None else [limits[key]] for key in ("velocity", "effort")]
    values = [axis, *shown, *rates]
    return [joint["kind"], joint["parent"], joint["child"], *(pytest.approx(v, rel=6e-4, abs=1e-9) for v in values)]


def link_cells(link: dict[str, Any]) -> list[Any]:
    """The cells of a link's row: mass [kg], centre of mass [mm], diagonal of its inertia [kg m^2]."""
    moments = [link["inertia"][i][i] for i in range(3)]
    com = pytest.approx([1000 * value for value in link["com"]], abs=0.051)
    return [pytest.approx([link["mass"]], rel=6e-4), com, pytest.approx(moments, rel=6e-4)]


def numbers(cell: str) -> list[float]:
    """The numbers in a cell of a table."""
    return [float(text) for text in re.findall(r"-?\b\d[\d.]*(?:e[+-]?\d+)?", cell)]


@pytest.mark.parametrize("name", ["build.py", "expected.json", "robot.robot.yaml", "robot.step", "view.py"])
def test_a_change_of_any_source_is_noticed(name: str, tmp_path: Path) -> None:
    """A changed input changes the hash of the results that depend on it, and no other hash."""
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


def test_line_ends_do_not_change_the_hash(tmp_path: Path) -> None:
    """A checkout with other line ends is up to date."""
    (tmp_path / "build.py").write_bytes(b"a\nb\n")
    (tmp_path / "robot.step").write_bytes(b"a\nb\n")
    before = fingerprints.drawing(tmp_path), fingerprints.robot(tmp_path)
    (tmp_path / "build.py").write_bytes(b"a\r\nb\r\n")
    (tmp_path / "robot.step").write_bytes(b"a\r\nb\r\n")
    assert (fingerprints.drawing(tmp_path), fingerprints.robot(tmp_path)) == before


SCRIPT = '''"""A docstring."""

WIDTH = 3.0
"""Of the plate [mm]."""


def plate(depth=2.0):
    """A plate."""
    return f"{WIDTH:g} x {depth!r}"  # a comment
'''


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("A docstring.", "Another docstring."),
        ('"""Of the plate [mm]."""\n', ""),
        ('    """A plate."""\n', ""),
        ("  # a comment", ""),
        ('return f"{WIDTH:g} x {depth!r}"', 'return (\n        f"{WIDTH:g} x {depth!r}"\n    )'),
    ],
)
def test_text_and_layout_of_a_script_do_not_change_the_hash(old: str, new: str, tmp_path: Path) -> None:
    """A script with other comments, docstrings or line breaks draws the same robot."""
    assert old in SCRIPT
    (tmp_path / "build.py").write_text(SCRIPT, encoding="utf-8")
    before = fingerprints.drawing(tmp_path)
    (tmp_path / "build.py").write_text(SCRIPT.replace(old, new), encoding="utf-8")
    assert fingerprints.drawing(tmp_path) == before


@pytest.mark.parametrize(
    ("old", "new"), [("3.0", "3.5"), ("depth=2.0", "depth=-2.0"), ("plate(", "slab("), (":g", ":e"), ("!r", "!s")]
)
def test_code_of_a_script_changes_the_hash(old: str, new: str, tmp_path: Path) -> None:
    """A script with another number, default, name or format specification may draw another robot."""
    assert old in SCRIPT
    (tmp_path / "build.py").write_text(SCRIPT, encoding="utf-8")
    before = fingerprints.drawing(tmp_path)
    (tmp_path / "build.py").write_text(SCRIPT.replace(old, new), encoding="utf-8")
    assert fingerprints.drawing(tmp_path) != before


def test_a_page_keeps_what_is_written_by_hand() -> None:
    """Only the generated part is replaced; a page without one gets it at its end."""
    part = f"{pages.START}\nnew\n{pages.END}\n"
    page = f"# robot\n\nBy hand.\n\n{pages.START}\nold\n{pages.END}\n\nAlso by hand.\n"
    assert pages.with_part(page, part) == page.replace("old", "new")
    assert pages.with_part("# robot\n", part) == f"# robot\n\n{part}"


def test_pictures_are_all_of_one_size() -> None:
    """All pictures have the same width and height in their headers."""
    sizes = {path: path.read_bytes()[16:24] for path in sorted(LIBRARY.glob("*/preview.png"))}
    size = preview.WIDTH.to_bytes(4, "big") + preview.HEIGHT.to_bytes(4, "big")
    assert {path.parent.name for path, found in sizes.items() if found != size} == set()


@pytest.mark.slow
def test_pictures_look_as_the_renderer_draws_them() -> None:
    """A small picture of the four-bar linkage is its preview, reduced; otherwise raise ``fingerprints._LOOK``."""
    folder = LIBRARY / "stepbot_four_bar"
    drawn = draw(preview.robot_subject_of(folder), preview.sheet_of(folder, 200, 150)).pixels
    with Image.open(folder / "preview.png") as kept:
        reduced = blurred(np.asarray(kept.convert("RGB")))
    difference = np.abs(blurred(drawn) - reduced)
    assert difference.mean() < 1.0
    assert difference.max() < 25.0


def blurred(picture: NDArray[np.uint8]) -> NDArray[np.float64]:
    """A picture at 40 by 30 pixels, where noise and edges are averaged."""
    return np.asarray(Image.fromarray(picture).resize((40, 30), Image.Resampling.BOX)).astype(float)
