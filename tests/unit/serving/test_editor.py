"""Edits of a sidecar on disk: what other programs saved stays, and so does what the file is."""

import os
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.scenes import ShownScene
from stepbot.serving import editor as editing
from stepbot.serving.editor import Editor
from stepbot.serving.local_server import Refused

TEXT = "version: 1\nrobot: arm\nstep: arm.step\ndefaults: {density: 2700 kg/m^3}\nlinks:\n  base: {rest: true}\n"
RENAME = {"action": "rename", "what": "link", "from": "base", "to": "foot"}
POSIX = pytest.mark.skipif(os.name == "nt", reason="needs links, pipes and modes")


@pytest.fixture
def sidecar(tmp_path: Path) -> Path:
    """A sidecar that its group may read."""
    path = tmp_path / "arm.robot.yaml"
    path.write_text(TEXT, encoding="utf-8")
    path.chmod(0o640)
    return path


def passed(path: Path, text: str, options: Options) -> ShownScene:
    """What a check without errors returns."""
    return ShownScene(Diagnostics())


def opened(path: Path, monkeypatch: pytest.MonkeyPatch) -> Editor:
    """An editor whose checks pass at once."""
    monkeypatch.setattr(editing, "show_text", passed)
    return Editor(path, Options(path.parent / "out"), lambda shown: None)


def test_save_during_a_check_is_kept(sidecar: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While an edit, an undo or a redo is checked, another program saves: its save stays and the step is refused."""
    editor = opened(sidecar, monkeypatch)
    saved = TEXT + "# saved by an editor\n"

    def saves_meanwhile(path: Path, text: str, options: Options) -> ShownScene:
        sidecar.write_text(saved, encoding="utf-8")
        return passed(path, text, options)

    editor.edit(RENAME)
    edited = sidecar.read_text(encoding="utf-8")
    assert "foot" in edited
    for step in (editor.edit, editor.undo):
        sidecar.write_text(edited, encoding="utf-8")
        monkeypatch.setattr(editing, "show_text", saves_meanwhile)
        with pytest.raises(Refused, match="changed elsewhere"):
            step({**RENAME, "from": "foot", "to": "stand"})
        assert sidecar.read_text(encoding="utf-8") == saved
        assert list(sidecar.parent.iterdir()) == [sidecar]
    assert editor.state() == {"undo": 1, "redo": 0}
    monkeypatch.setattr(editing, "show_text", passed)
    sidecar.write_text(edited, encoding="utf-8")
    editor.undo({})
    assert sidecar.read_text(encoding="utf-8") == TEXT


@POSIX
def test_file_stays_what_it_is(sidecar: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An edit keeps the mode, and a link to a sidecar elsewhere."""
    link = sidecar.parent / "here.robot.yaml"
    link.symlink_to(sidecar)
    opened(link, monkeypatch).edit(RENAME)
    assert link.is_symlink()
    assert "foot" in sidecar.read_text(encoding="utf-8")
    assert sidecar.stat().st_mode & 0o777 == 0o640


@POSIX
def test_pipe_in_its_place(sidecar: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pipe in place of the sidecar is refused at once, and the next question is answered."""
    editor = opened(sidecar, monkeypatch)
    sidecar.unlink()
    os.mkfifo(sidecar)
    for _ in range(2):
        with pytest.raises(Refused, match="not a regular file"):
            editor.edit(RENAME)
