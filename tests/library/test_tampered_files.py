"""`stepbot verify` finds the one changed file among its siblings."""

import json
import re
import shutil
from pathlib import Path

import pytest

from tests.command_line import stepbot
from tests.library.conftest import Converted

FILES = ("arm2.urdf", "arm2.sdf", "arm2.xml")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "pattern", "replacement", "quantity", "where"),
    [
        pytest.param(
            "arm2.urdf",
            r'(<link name="forearm">\s*<inertial>\s*<origin [^>]*>\s*<mass value=")[^"]*',
            r"\g<1>0.6372",
            "mass",
            "mass of link 'forearm'",
            id="mass in URDF",
            marks=pytest.mark.long,  # tests/cli/test_verify.py changes one
        ),
        pytest.param(
            "arm2.xml",
            r'(<joint name="elbow" [^>]*range="-0\.4363323129985824 )[^"]*',
            r"\g<1>2.0072",
            "limits",
            "upper limit of joint 'elbow'",
            id="limit in MJCF",
        ),
        pytest.param(
            "arm2.sdf",
            r'(<joint name="elbow" type="revolute">.*?<xyz>)0 0 -1',
            r"\g<1>0 0 1",
            "axes",
            "axis of joint 'elbow'",
            id="axis in SDFormat",
        ),
    ],
)
def test_one_number_changed_in_one_file(
    file: str, pattern: str, replacement: str, quantity: str, where: str, converted: Converted, tmp_path: Path
) -> None:
    """A mass changed by 1e-4, a limit or a sign ends in exit code 1 and names the place."""
    folder = shutil.copytree(converted("stepbot_arm2").folder, tmp_path / "copy")
    text = (folder / file).read_text(encoding="utf-8")
    changed, count = re.subn(pattern, replacement, text, count=1, flags=re.DOTALL)
    assert count == 1
    assert changed != text
    (folder / file).write_text(changed, encoding="utf-8", newline="\n")
    run = stepbot("verify", "--json", *FILES, cwd=folder)
    assert run.code == 1, run.err
    assert "Traceback" not in run.err
    document = json.loads(run.out)
    failed = [check for check in document["report"]["checks"] if check["status"] == "failed"]
    assert any(check["quantity"] == quantity and where in check["where"] for check in failed), failed
    assert all(file in (check["file"], check["against"].split(" ")[0]) for check in failed), failed
    assert any(where in entry["message"] + "".join(entry["notes"]) for entry in document["diagnostics"])
