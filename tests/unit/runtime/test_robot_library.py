"""Robots of the library and their pages."""

from pathlib import Path

import pytest

from stepbot.runtime import robot_library as library
from stepbot.runtime.robot_library import LibraryRobot, library_robot, library_robots

PAGE = """\
# crank

![The robot](preview.png)

A [slider-crank](https://example.org), as in
every engine. It is small.

<!-- generated: do not edit below -->
<!-- drawn from 0, converted from 0 -->

2 links, 1 DoF, 3.5 kg

## Joints

| joint | axis |
| --- | --- |
| pin | 0 0 1 |

## Links

| link |
| --- |
| bed |
"""


def _robot(place: Path, folder: str = "maker_crank", page: str = PAGE) -> LibraryRobot:
    at = place / folder
    at.mkdir()
    sidecar = at / f"{folder.partition('_')[2]}.robot.yaml"
    sidecar.touch()
    (at / "README.md").write_text(page, encoding="utf-8")
    return LibraryRobot(at, sidecar)


def test_page_has_overview_facts_and_tables(tmp_path: Path) -> None:
    """A page is read without markup: paragraphs as one line, tables as rows."""
    robot = _robot(tmp_path)
    assert (robot.name, robot.short_name, robot.step) == ("maker_crank", "crank", robot.folder / "crank.step")
    assert robot.overview() == "A slider-crank, as in every engine. It is small."
    assert robot.summary() == "A slider-crank, as in every engine."
    assert robot.facts() == "2 links, 1 DoF, 3.5 kg"
    assert robot.table("Joints") == [["joint", "axis"], ["pin", "0 0 1"]]
    assert robot.table("Links") == [["link"], ["bed"]]


def test_page_without_a_generated_part_has_no_facts(tmp_path: Path) -> None:
    """A page without a generated part has no facts and no tables."""
    robot = _robot(tmp_path, page="# crank\n\nA crank.\n")
    assert (robot.summary(), robot.facts(), robot.table("Joints")) == ("A crank.", "", [])


def test_every_robot_of_the_checkout_is_found(robot_library: Path) -> None:
    """In an editable install the robots are those of the checkout; each has a summary."""
    robots = library_robots()
    assert [robot.folder for robot in robots] == sorted(path.parent for path in robot_library.glob("*/*.robot.yaml"))
    for robot in robots:
        assert robot.facts()
        assert robot.summary().endswith(".")
        assert robot.step.is_file() != robot.is_composed
        if robot.is_composed:
            continue
        assert len(robot.table("Joints")) > 1
        assert len(robot.table("Links")) > 2


def test_names_with_and_without_makers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A maker's name is optional if only one maker has a robot of that name."""
    monkeypatch.setattr(library, "_PLACES", (tmp_path / "absent", tmp_path))
    assert library_robots() == ()
    crank = _robot(tmp_path)
    assert library_robot("crank") == library_robot("maker_crank") == crank
    other = _robot(tmp_path, "other_crank")
    assert library_robot("other_crank") == other
    for name in ("crank", "maker", ""):
        with pytest.raises(KeyError):
            library_robot(name)
