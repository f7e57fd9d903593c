"""Robots whose numbers are a maker's name the licence of their source, in the checkout and in the wheel."""

import json
import re
import tomllib

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.load import load_sidecar
from tests.library.conftest import LIBRARY, ROBOTS, sidecar_of

NOTICES = LIBRARY / "NOTICES.md"
ROW = re.compile(
    r"^\| (?P<robots>`[^|]+`) \| \[(?P<repo>[^]]+)\]\([^)]*\) at `(?P<commit>[0-9a-f]{40})` \| (?P<licence>[^|]+?) \|",
    re.MULTILINE,
)


def _sources() -> dict[str, dict[str, str]]:
    found = {}
    for robot in ROBOTS:
        content = json.loads((LIBRARY / robot / "expected.json").read_text(encoding="utf-8"))
        if "source" in content:
            found[robot] = content["source"]
    return found


SOURCES = _sources()


def _notices() -> dict[str, tuple[str, str, str]]:
    rows = ROW.finditer(NOTICES.read_text(encoding="utf-8"))
    return {
        robot: (row["repo"], row["commit"], row["licence"])
        for row in rows
        for robot in re.findall(r"`([a-z0-9_]+)`", row["robots"])
    }


@pytest.mark.slow
def test_every_sidecar_states_what_packages_need() -> None:
    """Maintainer and licence, without which packages are reported (SB640), version and one sentence."""
    for robot in ROBOTS:
        sidecar = load_sidecar(sidecar_of(robot), Diagnostics())
        assert sidecar is not None, robot
        metadata = sidecar.document.metadata
        assert metadata.license == "Apache-2.0", robot
        assert all((metadata.maintainer, metadata.version, metadata.description)), robot
    assert "placeholder" in NOTICES.read_text(encoding="utf-8")


def test_there_is_a_notice_for_each_source_and_no_other() -> None:
    """Every robot with a source has a notice, and every notice a robot."""
    assert SOURCES
    assert set(_notices()) == set(SOURCES)


@pytest.mark.parametrize("robot", SOURCES)
def test_a_notice_names_repository_commit_and_licence(robot: str) -> None:
    """Repository, commit and licence are those of expected.json."""
    repo, commit, licence = _notices()[robot]
    source = SOURCES[robot]
    assert (repo, commit) == (source["repo"], source["commit"])
    assert re.match(rf"{re.escape(licence)}\b", source["licence"])


def test_the_wheel_has_the_notices() -> None:
    """The build includes NOTICES.md beside the robots."""
    project = tomllib.loads((LIBRARY.parent / "pyproject.toml").read_text(encoding="utf-8"))
    wheel = project["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert "!/robot_library/NOTICES.md" in wheel["exclude"]
    assert "robot_library/NOTICES.md" in project["project"]["license-files"]
