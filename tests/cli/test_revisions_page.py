"""docs/revisions.md: its commands print what it shows.

``python -m tests.cli.test_revisions_page`` updates the output of the commands in the page.
"""

import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from robot_library.moments import pose
from tests.command_line import printed
from tests.revisions import Revision

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "revisions.md"
CONSOLE = re.compile(r"^```console\n\$ (stepbot [^\n]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
COLUMNS = 100


def session(page: str, folder: Path) -> Iterator[str]:
    """Run the commands of the page in a folder with both revisions; yields the output of each."""
    for name in ("arm2.step", "arm2.robot.yaml"):
        shutil.copy(ROOT / "robot_library" / "stepbot_arm2" / name, folder)
    revision = Revision(folder / "arm2.step").rename({"gripper": "Greifer", "gripper:1": "Greifer:1"})
    revision.move("elbow motor:1", pose((0, 5.0, 0))).remove("screw M6x12:2").write(folder / "next.step")
    changes = {"COLUMNS": str(COLUMNS), "STEPBOT_CACHE": str(folder / "cache"), "STEPBOT_NO_CACHE": ""}
    for command, _ in CONSOLE.findall(page):
        yield printed(command.split()[1:], folder, changes)[1]


@pytest.mark.slow
def test_session(tmp_path: Path) -> None:
    """The commands print the output shown on the page."""
    page = PAGE.read_text(encoding="utf-8")
    assert list(session(page, tmp_path)) == [output for _, output in CONSOLE.findall(page)]


def refresh() -> None:
    """Write the output of the commands into the page."""
    page = PAGE.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        outputs = session(page, Path(folder))
        page = CONSOLE.sub(lambda block: f"```console\n$ {block[1]}\n{next(outputs)}```", page)
    PAGE.write_text(page, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    refresh()
