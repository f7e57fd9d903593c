"""``stepbot view --edit``: which file is edited."""

import os
from pathlib import Path

import click
import pytest

from stepbot.api import check
from stepbot.diagnostics import Diagnostics, Span
from stepbot.pipeline.conversion import Options
from stepbot_cli.terminal import Display
from stepbot_cli.view import _announce, _check_writable, _editable
from tests.parts import write_hinge


@pytest.mark.slow
def test_a_step_file_is_drafted_once(tmp_path: Path) -> None:
    """Without a sidecar one is drafted that passes its check; an existing one is taken as it is."""
    step = tmp_path / "hinge.step"
    write_hinge(step)
    diagnostics = Diagnostics()
    sidecar, said = _editable(step, Options(output=Path()), diagnostics)
    assert not diagnostics.has_errors
    assert sidecar == tmp_path / "hinge.robot.yaml"
    assert "wrote" in said
    assert not check(sidecar, open_step=True, cache=False).diagnostics.has_errors
    sidecar.write_text("version: 1\n", encoding="utf-8")
    assert _editable(step, Options(output=Path()), diagnostics) == (sidecar, "")
    assert _editable(sidecar, Options(output=Path()), diagnostics) == (sidecar, "")
    assert sidecar.read_text(encoding="utf-8") == "version: 1\n"


def test_other_files_cannot_be_edited(tmp_path: Path) -> None:
    """A mesh is no robot."""
    with pytest.raises(click.UsageError, match="needs a sidecar, a STEP file, a URDF"):
        _editable(tmp_path / "arm.stl", Options(output=Path()), Diagnostics())


def test_a_description_gets_a_sidecar_of_its_own(tmp_path: Path) -> None:
    """It is written once, beside that of a STEP file of the same name, and not for a file that does not exist."""
    urdf = tmp_path / "arm.urdf"
    assert _editable(urdf, Options(output=Path()), missing := Diagnostics())[1] == ""
    assert [one.code for one in missing] == ["SB001"]
    assert list(tmp_path.iterdir()) == []
    link = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    urdf.write_text(f'<robot name="arm"><link name="base">{link}</link></robot>', encoding="utf-8")
    sidecar, said = _editable(urdf, Options(output=Path()), Diagnostics())
    assert (sidecar, said.startswith("wrote ")) == (tmp_path / "arm.robot.yaml", True)
    assert not check(sidecar, open_step=True, cache=False).diagnostics.has_errors
    assert _editable(urdf, Options(output=Path()), Diagnostics()) == (sidecar, "")
    sidecar.write_text("version: 1\nrobot: arm\nstep: arm.step\n", encoding="utf-8")
    assert _editable(urdf, Options(output=Path()), Diagnostics())[0] == tmp_path / "arm.urdf.robot.yaml"


def test_a_folder_without_write_permission_is_reported_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page does not open for edits that could not be written."""
    sidecar = tmp_path / "arm.robot.yaml"
    sidecar.write_text("version: 1\n", encoding="utf-8")
    monkeypatch.setattr(os, "access", lambda path, mode: not mode & os.W_OK)
    diagnostics = Diagnostics()
    _check_writable(sidecar, diagnostics)
    ((code, message, help),) = [(one.code, one.message, one.help) for one in diagnostics]
    assert code == "SB004"
    assert "no write permission" in message
    assert help == ("copy the files to a folder that you can write to",)


def test_warnings_are_counted_where_the_page_lists_them(capsys: pytest.CaptureFixture[str]) -> None:
    """A page that opens lists warnings; the terminal shows errors, the number of warnings, and the address last."""
    diagnostics = Diagnostics()
    for name in ("a", "b"):
        diagnostics.add("SB305", f"part '{name}'", Span("arm.step"))
    diagnostics.add("SB001", "file not found", Span("arm.robot.yaml"))
    _announce(diagnostics, "http://127.0.0.1:1/x/", display=Display())
    out, err = capsys.readouterr()
    assert "SB001" in err
    assert "SB305" not in err
    assert out.splitlines() == ["2 warnings in the page, under Findings", "http://127.0.0.1:1/x/"]
    _announce(diagnostics, "", display=Display())
    assert "SB305" in capsys.readouterr().err
