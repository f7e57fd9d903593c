"""`init --from` reports what a description leaves out: ranges, and links that the STEP divides otherwise."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.command_line import stepbot

pytestmark = pytest.mark.slow

LIBRARY = Path(__file__).parents[2] / "robot_library"


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the URDF of an arm of the library and its STEP."""
    folder = tmp_path_factory.mktemp("exported")
    source = LIBRARY / "stepbot_arm2"
    run = stepbot("convert", source / "arm2.robot.yaml", "-o", "out", "--no-verify", "-f", "urdf", cwd=folder)
    assert run.code == 0, run.err
    shutil.copy(source / "arm2.step", folder / "out")
    return folder / "out"


@pytest.fixture
def drafted(exported: Path) -> Callable[[Callable[[str], str]], dict[str, Any]]:
    """Drafts from an edited URDF."""

    def draft(edit: Callable[[str], str]) -> dict[str, Any]:
        (exported / "edited.urdf").write_text(edit((exported / "arm2.urdf").read_text(encoding="utf-8")))
        run = stepbot("init", "arm2.step", "--from", "edited.urdf", "--force", "--json", cwd=exported)
        assert run.code == 0, run.out
        document: dict[str, Any] = json.loads(run.out)
        return document

    return draft


def test_limits_without_a_range_are_marked(
    drafted: Callable[[Callable[[str], str]], dict[str, Any]], exported: Path
) -> None:
    """Exporters write 0 to 0 where they know no limits: copied, no joint could move."""
    document = drafted(lambda text: re.sub(r"<limit [^/]*/>", '<limit lower="0" upper="0" effort="10"/>', text))
    moving = [joint for joint in document["joints"] if joint["type"] != "fixed"]
    assert moving
    assert all(joint["review"] for joint in moving)
    text = (exported / "arm2.robot.yaml").read_text(encoding="utf-8")
    assert text.count("    limits: todo\n") == len(moving)
    assert text.count("# REVIEW: no range: the description limits it to 0 ") == len(moving)


def test_a_link_that_moves_in_the_step_is_reported(drafted: Callable[[Callable[[str], str]], dict[str, Any]]) -> None:
    """A description that fixes the turntable to the base is told that the drawing turns it."""
    document = drafted(lambda text: text.replace('name="shoulder" type="revolute"', 'name="shoulder" type="fixed"'))
    (note,) = (one for one in document["notes"] if "do not move here, but may in the STEP" in one)
    assert "of 'base' and 'upper_arm'" in note


def test_links_of_one_body_are_reported(drafted: Callable[[Callable[[str], str]], dict[str, Any]]) -> None:
    """A link whose shape is a part of another link's body has no component, and the draft says which body it is in."""
    inertia = '<mass value="0.01"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/>'
    shape = '<visual><origin xyz="0 0 0.01"/><geometry><box size="0.01 0.01 0.005"/></geometry></visual>'
    extra = f"""<link name="sticker"><inertial>{inertia}</inertial>{shape}</link>
        <joint name="glue" type="fixed"><parent link="base"/><child link="sticker"/></joint></robot>"""
    document = drafted(lambda text: text.replace("</robot>", extra))
    (note,) = (one for one in document["notes"] if one.startswith("link 'sticker' has no component: "))
    assert "one body of link 'base'" in note
