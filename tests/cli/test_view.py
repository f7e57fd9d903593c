"""``stepbot view --edit``: which file is edited."""

from pathlib import Path

import click
import pytest

from stepbot.api import check
from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot_cli.view import _editable
from tests.parts import write_hinge


def test_a_step_file_is_drafted_once(tmp_path: Path) -> None:
    """Without a sidecar one is drafted that passes its check; an existing one is taken as it is."""
    step = tmp_path / "hinge.step"
    write_hinge(step)
    found = Diagnostics()
    sidecar, said = _editable(step, Options(output=Path()), found)
    assert not found.has_errors
    assert sidecar == tmp_path / "hinge.robot.yaml"
    assert "wrote" in said
    assert not check(sidecar, open_step=True, cache=False).diagnostics.has_errors
    sidecar.write_text("version: 1\n", encoding="utf-8")
    assert _editable(step, Options(output=Path()), found) == (sidecar, "")
    assert _editable(sidecar, Options(output=Path()), found) == (sidecar, "")
    assert sidecar.read_text(encoding="utf-8") == "version: 1\n"


def test_other_files_cannot_be_edited(tmp_path: Path) -> None:
    """A URDF has no sidecar."""
    with pytest.raises(click.UsageError, match="needs a sidecar or a STEP file"):
        _editable(tmp_path / "arm.urdf", Options(output=Path()), Diagnostics())
