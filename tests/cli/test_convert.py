"""``stepbot convert``: files, printed output, and that an error leaves the former output unchanged."""

import json
import os
import re
import signal
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from stepbot_cli.convert import default_output

from .conftest import Stepbot

pytestmark = pytest.mark.usefixtures("without_cache")

FILES = {"arm2.urdf", "arm2.sdf", "arm2.xml", "report.json"}


def snapshot(folder: Path) -> dict[str, bytes]:
    """All files below a folder."""
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def replaced(old: str, new: str) -> list[tuple[str, str]]:
    """Replace a text in the sidecar."""
    return [(old, new)]


def damage(folder: Path, replacements: list[tuple[str, str]]) -> None:
    """Put errors into the sidecar."""
    sidecar = folder / "arm2.robot.yaml"
    text = sidecar.read_text(encoding="utf-8")
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new, 1)
    sidecar.write_text(text, encoding="utf-8")


@pytest.mark.slow
def test_three_formats_and_a_proof(arm: Path, stepbot: Stepbot) -> None:
    """All formats are written and verified; the table has a line without failures for each file and engine."""
    run = stepbot("convert", "arm2.robot.yaml")
    assert run.code == 0, run.err
    assert {file.name for file in (arm / "arm2").iterdir()} >= FILES
    verbose = stepbot("convert", "arm2.robot.yaml", "-v")
    lines = verbose.out.splitlines()
    head = next(n for n, line in enumerate(lines) if line.split()[:3] == ["format", "file", "engine"])
    lines = lines[head:]
    for file, engine in (("arm2.urdf", "mujoco"), ("arm2.xml", "mujoco"), ("arm2.urdf", "yourdfpy")):
        (line,) = [line for line in lines if f" {file} " in line and f" {engine} " in line and "passed" in line]
        assert "tolerance" in line
    assert any(line.endswith("not run") and " 0 failed" in line for line in lines)
    assert run.out.startswith("arm2: 5 links, 4 joints, ")
    files = f"{len(snapshot(arm / 'arm2')) - 1} files in arm2    see it: stepbot view arm2\n"
    assert run.out.endswith(files)
    assert verbose.out.endswith(files)


@pytest.mark.slow
def test_json_is_the_whole_story(arm: Path, stepbot: Stepbot) -> None:
    """`--json` prints the robot, files, report and findings; JUnit has the checks as test cases."""
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out", "--json", "--junit", "out.xml")
    document = json.loads(run.out)
    assert document["exit_code"] == run.code == 0
    assert document["robot"] == "arm2"
    assert document["output"] == "out"
    assert set(document["files"]) == set(snapshot(arm / "out")) - {".stepbot.json"}
    assert document["report"] == json.loads((arm / "out" / "report.json").read_text(encoding="utf-8"))
    suites = ET.parse(arm / "out.xml").getroot()
    assert [suite.get("name") for suite in suites] == ["arm2"]
    assert suites.get("tests") == str(1 + len(document["report"]["checks"]))
    assert (suites.get("failures"), suites.get("errors")) == ("0", "0")


@pytest.mark.slow
def test_one_format_without_proof(arm: Path, stepbot: Stepbot) -> None:
    """`-f` by an alias, given twice, writes one format; `--no-verify` starts no engine."""
    run = stepbot("convert", "arm2.robot.yaml", "-f", "sdformat", "-f", "sdf", "--no-verify", "-o", "out")
    assert run.code == 0, run.err
    assert [name for name in snapshot(arm / "out") if name.endswith((".urdf", ".sdf", ".xml"))] == [
        "arm2.sdf",
        "arm2.world.sdf",
    ]


@pytest.mark.slow
def test_strict_ends_at_a_loss(arm: Path, stepbot: Stepbot) -> None:
    """A feature that a format lacks is a warning, and with `--strict` an error without output."""
    damage(arm, replaced("friction: 0.02}", "friction: 0.02, armature: 0.01}"))
    run = stepbot("convert", "arm2.robot.yaml", "--no-verify", "--strict", "-f", "sdf")
    assert run.code == 1
    assert "arm2.sdf: error[SB760:armature]" in run.err
    assert not (arm / "arm2").exists()
    run = stepbot("convert", "arm2.robot.yaml", "--no-verify", "-f", "sdf")
    assert run.code == 0
    assert "arm2.sdf: warning[SB760:armature]" in run.err
    assert stepbot("convert", "arm2.robot.yaml", "--no-verify", "--strict", "-f", "mjcf").code == 0


@pytest.mark.slow
def test_other_step(arm: Path, stepbot: Stepbot) -> None:
    """`--step` replaces the file named in the sidecar."""
    (arm / "arm2.step").rename(arm / "revision_b.step")
    assert stepbot("convert", "arm2.robot.yaml", "--no-verify").code == 2
    assert stepbot("convert", "arm2.robot.yaml", "--no-verify", "--step", "revision_b.step").code == 0


def test_unknown_format(stepbot: Stepbot) -> None:
    """An unknown format is a usage error that suggests a similar name."""
    run = stepbot("convert", "arm2.robot.yaml", "-f", "udrf")
    assert run.code == 2
    assert "unknown format 'udrf'; did you mean 'urdf'?" in run.err


@pytest.mark.parametrize(
    ("name", "folder"),
    [("arm.robot.yaml", "arm"), ("a/b/arm.robot.yml", "arm"), ("robot.yaml", "robot"), ("arm.v2.robot.yaml", "arm.v2")],
)
def test_default_output(name: str, folder: str) -> None:
    """The default output folder has the sidecar's name and is in the current folder."""
    assert default_output(Path(name)) == Path(folder)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("replacements", "message"),
    [
        (replaced("[forearm]", "[forarm]"), "did you mean 'forearm'"),
        (replaced("lower: -170 deg, upper: 170 deg", "lower: 170 deg, upper: -170 deg"), "lower"),
        (replaced("base: fixed", "bases: fixed"), "did you mean 'base'"),
        (replaced("base: fixed", "base: fixed\nbase: fixed"), "base"),
        (replaced("parent: base", "parent: forearm"), "cycle"),
        (replaced("step: arm2.step", "step: absent.step"), "absent.step"),
    ],
    ids=["part", "limits", "unknown key", "duplicate key", "cycle", "absent step"],
)
def test_error_leaves_the_former_output(
    arm: Path, stepbot: Stepbot, replacements: list[tuple[str, str]], message: str
) -> None:
    """An error in the sidecar is reported with place and remedy; the former files are unchanged."""
    out = arm / "out"
    out.mkdir()
    (out / "arm2.urdf").write_text("former", encoding="utf-8")
    damage(arm, replacements)
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out")
    assert run.code in (1, 2)
    assert "arm2.robot.yaml:" in run.err
    assert ": error[SB" in run.err
    assert "= help:" in run.err
    assert message in run.err
    assert "Traceback" not in run.err
    assert snapshot(out) == {"arm2.urdf": b"former"}
    assert re.fullmatch(r"arm2: not converted, \d errors?( of \d causes?)?; out is unchanged\n", run.out)


@pytest.mark.parametrize(
    "content", [b"", b"solid x\n", b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"]
)
def test_bad_step_leaves_the_former_output(arm: Path, stepbot: Stepbot, content: bytes) -> None:
    """An empty or invalid STEP, or one without a product, is reported; the former files are unchanged."""
    out = arm / "out"
    out.mkdir()
    (out / "arm2.urdf").write_text("former", encoding="utf-8")
    (arm / "arm2.step").write_bytes(content)
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out")
    assert run.code in (1, 2)
    assert "arm2.step" in run.err
    assert ": error[SB2" in run.err
    assert "Traceback" not in run.err
    assert snapshot(out) == {"arm2.urdf": b"former"}


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_kernel_that_dies(arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """A killed kernel is reported with the signal; nothing is written."""
    from stepbot.runtime.worker import Worker

    submit = Worker.submit

    def submit_and_kill(self: Worker, *arguments: object) -> Worker:
        os.kill(self.pid, signal.SIGKILL)
        return submit(self, *arguments)

    monkeypatch.setattr(Worker, "submit", submit_and_kill)
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out")
    assert run.code == 2
    assert "error[SB902]" in run.err
    assert "SIGKILL" in run.err
    assert not (arm / "out").exists()


def test_external_references_only(arm: Path, stepbot: Stepbot, corpus: Path) -> None:
    """A STEP whose parts are in missing files is reported."""
    run = stepbot("convert", "arm2.robot.yaml", "--step", str(corpus / "external_references.step"), "-o", "out")
    assert run.code in (1, 2)
    assert "external_references.step" in run.err
    assert "error[SB2" in run.err
    assert not (arm / "out").exists()


def test_output_that_cannot_be_written(arm: Path, stepbot: Stepbot) -> None:
    """A file at the path of the output folder is reported and left unchanged."""
    (arm / "out").write_text("a file", encoding="utf-8")
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out", "--no-verify")
    assert run.code == 2
    assert "error[SB004]" in run.err
    assert (arm / "out").read_text(encoding="utf-8") == "a file"
    assert run.out == "arm2: not converted, 1 error; out is unchanged\n"


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="no permissions of POSIX on this system")
@pytest.mark.parametrize("output", ["out", "out/deeper/arm"])
@pytest.mark.parametrize("how", ["file", "right"])
def test_unwritable_output_is_found_before_the_work(
    arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch, how: str, output: str
) -> None:
    """A file in the way or missing permission is reported before any input is read."""
    if how == "file":
        (arm / "out").write_text("a file", encoding="utf-8")
    else:
        (arm / "out").mkdir()
        monkeypatch.setattr(os, "access", lambda path, mode: not (mode & os.W_OK and Path(path).name == "out"))
    before = snapshot(arm)
    verdicts = {("convert", "no.robot.yaml"): "no: not converted", ("batch", "."): "nothing converted"}
    for command, verdict in verdicts.items():
        run = stepbot(*command, "-o", output)
        assert run.code == 2
        assert run.out.startswith(f"{verdict}, 1 error")
        assert run.err.count("error[SB004]") == run.err.count("error[") == 1
        assert "'out'" in run.err.replace(str(arm) + os.sep, "")
    assert snapshot(arm) == before


@pytest.mark.long  # test_determinism.py compares one such run with another
def test_same_bytes_wherever_and_however(arm: Path, stepbot: Stepbot) -> None:
    """Hash seed, locale, time zone and working directory do not change the bytes, report included."""
    import subprocess
    import sys

    runs = {
        "here": (arm, "arm2.robot.yaml", {"PYTHONHASHSEED": "1", "LC_ALL": "C.UTF-8"}),
        "there": (arm.parent, str(arm / "arm2.robot.yaml"), {"PYTHONHASHSEED": "2", "LC_ALL": "C", "TZ": "Asia/Tokyo"}),
    }
    for name, (folder, sidecar, environment) in runs.items():
        command = [sys.executable, "-m", "stepbot_cli", "convert", sidecar, "-o", str(arm / name)]
        run = subprocess.run(command, cwd=folder, env={**os.environ, **environment}, capture_output=True, check=False)
        assert run.returncode == 0, run.stderr.decode()
    assert snapshot(arm / "here") == snapshot(arm / "there")


@pytest.mark.slow
def test_verbose_lists_the_mass_of_each_link(stepbot: Stepbot, arm: Path) -> None:
    """With -v each link has its mass, as in the report."""
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out", "--no-verify", "-v")
    links = json.loads((arm / "out" / "report.json").read_bytes())["robot"]["links"]
    masses = {one["name"]: one["mass"] for one in links}
    listed = dict(re.findall(r"^  (\w+): ([\d.]+ k?g)$", run.out, re.MULTILINE))
    grams = {name: float(text.split()[0]) * (1e3 if text.endswith("kg") else 1.0) for name, text in listed.items()}
    assert grams == {name: pytest.approx(1e3 * mass, rel=5e-3) for name, mass in masses.items()}
