"""``stepbot uptodate``: byte by byte what would be written now."""

import shutil
from pathlib import Path

import pytest

from .conftest import Stepbot

CONVERT = ("convert", "arm2.robot.yaml", "-o", "out/arm2")
UPTODATE = ("uptodate", "-o", "out/{name}", "--concise")


@pytest.fixture
def written(arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Output of a robot, without its report, as one would commit it; results are kept from now on."""
    monkeypatch.setenv("STEPBOT_NO_CACHE", "")
    monkeypatch.setenv("STEPBOT_CACHE", str(arm / ".kept"))
    assert stepbot(*CONVERT, "--no-verify").code == 0
    (arm / "out" / "arm2" / "report.json").unlink()
    return arm / "out" / "arm2"


def test_what_changed_is_told(written: Path, stepbot: Stepbot) -> None:
    """Nothing to say of fresh files; then each file that was edited, removed or is not written any more."""
    run = stepbot(*UPTODATE)
    assert (run.code, run.out, run.err) == (0, "", "")
    urdf = written / "arm2.urdf"
    urdf.write_bytes(urdf.read_bytes().replace(b"\n", b"\r\n", 1))
    (written / "arm2.sdf").unlink()
    run = stepbot(*UPTODATE, "arm2.robot.yaml")
    assert run.code == 1
    assert [line.partition(": error[SB007]: ")[::2] for line in run.out.splitlines()] == [
        ("out/arm2/arm2.urdf", "is not what stepbot writes now"),
        ("out/arm2/arm2.sdf", "is missing"),
    ]
    assert stepbot(*UPTODATE, "--ignore", "*.urdf", "--ignore", "*.sdf").code == 0
    assert not (written / "arm2.sdf").exists(), "it writes nothing"


def test_edited_sidecar_and_left_over_mesh(written: Path, stepbot: Stepbot) -> None:
    """What the sidecar says now is compared, and what an earlier run wrote is found."""
    sidecar = Path("arm2.robot.yaml")
    text = sidecar.read_text(encoding="utf-8")
    sidecar.write_text(text.replace("robot: arm2", "robot: arm3"), encoding="utf-8")
    run = stepbot(*UPTODATE)
    assert run.code == 1
    assert "out/arm2/arm3.urdf: error[SB007]: is missing" in run.out
    assert "out/arm2/arm2.urdf: error[SB007]: is not written any more" in run.out


def test_faulty_sidecar_is_told_as_such(written: Path, stepbot: Stepbot) -> None:
    """Where nothing could be written, the reason is what counts."""
    Path("arm2.robot.yaml").write_text("version: 1\n", encoding="utf-8")
    run = stepbot(*UPTODATE)
    assert run.code == 1
    assert "SB121" in run.out
    assert "SB007" not in run.out


def test_nothing_to_compare(tmp_path: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder without sidecars is no success."""
    monkeypatch.chdir(tmp_path)
    assert stepbot("uptodate").code == 2
    assert stepbot("uptodate", "-o", "{robot}", "x.robot.yaml").code == 2


@pytest.mark.slow
def test_report_is_compared_where_there_is_one(written: Path, stepbot: Stepbot) -> None:
    """A committed report is part of the promise, so the engines are asked."""
    assert stepbot(*CONVERT).code == 0
    assert stepbot(*UPTODATE).code == 0
    shutil.rmtree(".kept")
    report = written / "report.json"
    report.write_bytes(report.read_bytes().replace(b'"passed": ', b'"passed": 1', 1))
    run = stepbot(*UPTODATE)
    assert run.code == 1
    assert "out/arm2/report.json: error[SB007]" in run.out
