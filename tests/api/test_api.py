"""The public functions of the package, and the examples of docs/api.md."""

import json
import re
import runpy
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import stepbot
from stepbot_cli import main
from tests.architecture.test_imports import HEAVY

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(
    r"^## (.*?)\n.*?^```python\n(.*?)^```$", PAGE.partition("## Reference\n")[0], re.MULTILINE | re.DOTALL
)
PRINTED = {
    "Convert": r"\['arm2.scene.xml', 'arm2.urdf', 'arm2.xml', 'report.json'\]\nshoulder revolute base -> upper_arm\n",
    "Draft": r"(?m)^revolute base -> \S+ 0\.\d+$",
    "Check": r"5 links, 4 joints\n",
    "Inspect": r"(?m)^forearm/\S+ \(",
    "Verify": r"^0 failed$",
    "Closed loops in PyBullet": r"^1 constraint$",
}


pytestmark = pytest.mark.xdist_group("api")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the robots that the examples use."""
    folder = tmp_path_factory.mktemp("api")
    assert main(["library", "export", "arm2", "--source", "-o", str(folder / "arm2")]) == 0
    assert main(["library", "export", "four_bar", "-o", str(folder / "four_bar"), "--no-verify"]) == 0
    assert main(["convert", str(folder / "arm2" / "arm2.robot.yaml"), "-o", str(folder / "out"), "--no-verify"]) == 0
    return folder


def test_every_section_has_an_example() -> None:
    """Each section of the page with Python code has a test."""
    assert [heading for heading, _ in EXAMPLES] == list(PRINTED)


@pytest.mark.slow
@pytest.mark.parametrize(("heading", "code"), EXAMPLES, ids=[heading for heading, _ in EXAMPLES])
def test_example_runs(
    heading: str, code: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The example runs and prints the documented output; PyBullet, which may crash, in a process of its own."""
    if "import pybullet" in code:
        pytest.importorskip("pybullet")
        run = subprocess.run(
            [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False, timeout=300
        )
        assert run.returncode == 0, run.stderr
        out = run.stdout
    else:
        (folder / "example.py").write_text(code, encoding="utf-8")
        monkeypatch.chdir(folder)
        runpy.run_path("example.py", run_name="__main__")
        out = capsys.readouterr().out
    printed = "\n".join(line for line in out.splitlines() if not line.startswith("pybullet build time"))
    assert re.search(PRINTED[heading], printed + "\n" if PRINTED[heading].endswith(r"\n") else printed), out


def test_names_are_listed_and_documented() -> None:
    """Each public name exists and has a docstring, and every function has a row in the page."""
    for name in stepbot.__all__:
        assert getattr(stepbot, name).__doc__, name
        assert name in dir(stepbot)
    for name in ("convert", "check", "inspect", "draft", "render", "drive", "verify", "close_loops"):
        assert f"| `{name}(" in PAGE
    with pytest.raises(AttributeError, match="no attribute 'konvert'"):
        _ = stepbot.konvert  # type: ignore[attr-defined, unused-ignore]


def test_import_is_light(tmp_path: Path) -> None:
    """Importing the package loads no heavy package, and not the module of its functions."""
    program = "import json, sys, stepbot; print(json.dumps(sorted(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    modules = set(json.loads(run.stdout))
    assert not {name.partition(".")[0] for name in modules} & HEAVY
    assert "stepbot.api" not in modules


def test_findings_are_results(tmp_path: Path) -> None:
    """A sidecar with errors raises no exception: they are in the result; an unknown format is a ValueError."""
    sidecar = tmp_path / "arm.robot.yaml"
    sidecar.write_text("version: 1\nrobot: arm\n", encoding="utf-8")
    result = stepbot.convert(sidecar, output=tmp_path / "out", cache=False)
    assert result.diagnostics.has_errors
    assert not (tmp_path / "out").exists()
    assert stepbot.check(sidecar, cache=False).diagnostics.exit_code == 1
    with pytest.raises(stepbot.StepbotError):
        result.diagnostics.raise_if_errors()
    for formats in (["urfd"], "urfd"):
        with pytest.raises(ValueError, match="no format 'urfd'"):
            stepbot.convert(sidecar, formats=formats)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: stepbot.convert("arm.robot.yaml", out="arm"), "no argument 'out'; did you mean 'output'"),
        (lambda: stepbot.convert("arm.robot.yaml", format="urdf"), "did you mean 'formats'"),
        (lambda: stepbot.check("arm.robot.yaml", step=True), "takes a path, not True; `open_step=True`"),
        (lambda: stepbot.drive("arm", tests="grab"), "^tests: no test 'grab'"),
        (lambda: stepbot.drive("arm", engines="mujoko"), "^engines: no engine 'mujoko'; did you mean 'mujoco'"),
        (lambda: stepbot.drive("arm", limits=3), r"^drive\(limits=...\) takes a path, not 3"),
        (lambda: stepbot.convert("a.yaml", formats="nope"), "^formats: no format 'nope'; there are urdf"),
        (lambda: stepbot.convert("a.yaml", formats=3), r"^convert\(formats=...\) takes a string or several, not 3"),
        (lambda: stepbot.convert("a.yaml", programs="nope"), "^programs: no program 'nope'"),
        (lambda: stepbot.convert("a.yaml", require="nope"), "^require: no engine 'nope'; there are .*mujoco"),
        (lambda: stepbot.convert("a.yaml", require="mujoco", verify=False), "^require and verify=False"),
        (lambda: stepbot.convert("a.yaml", ignore="SB999"), "^ignore: unknown code 'SB999'"),
        (lambda: stepbot.convert("a.yaml", ros2="n o"), "^ros2: 'n o' is not the name"),
        (lambda: stepbot.convert("a.yaml", maintainer="x"), "^maintainer: 'x' is not"),
        (lambda: stepbot.convert("a.yaml", gazebo=True, formats="urdf"), "^gazebo: the format sdf is not written"),
        (lambda: stepbot.convert("a.urdf", base="nope"), "^base: 'nope' is neither"),
        (lambda: stepbot.convert("a.urdf", xacro={"n": 3}), r"^convert\(xacro=...\) takes a mapping from a string"),
        (lambda: stepbot.convert("a.urdf", assume_inertia=-1), "^assume_inertia: -1"),
        (lambda: stepbot.convert("a.yaml", verify="no"), r"^convert\(verify=...\) takes True or False, not 'no'"),
        (lambda: stepbot.convert("a.yaml", "out"), "^convert.. takes 'sidecar' alone .* the others are output="),
        (lambda: stepbot.convert(3), r"^convert\(sidecar=...\) takes a path, not 3"),
        (lambda: stepbot.check("a.yaml", open_step="a.step"), r"^check\(open_step=...\) takes True or False"),
        (lambda: stepbot.check("a.yaml", timeout=0), r"^check\(timeout=...\) takes what is larger than 0"),
        (lambda: stepbot.inspect("a.step", encoding="nope"), "^encoding: unknown code page 'nope'"),
        (lambda: stepbot.inspect("a.step", cache=None), r"^inspect\(cache=...\) takes a path or True or False"),
        (
            lambda: stepbot.draft("a.step", answers=3),
            r"^draft\(answers=...\) takes a mapping from a string to a string",
        ),
        (stepbot.verify, "^verify.. takes one file or several"),
        (lambda: stepbot.verify(["a.urdf"]), r"^verify\(files=...\) takes a path, not \['a.urdf'\]"),
        (lambda: stepbot.verify("a.urdf", package_path=3), r"^verify\(package_path=...\) takes a path or several"),
        (lambda: stepbot.render("a.step", size=(800, 0)), r"^render\(size=...\) takes what is larger than 0"),
        (lambda: stepbot.render("a.step", size=800), r"^render\(size=...\) takes a whole number and a whole number"),
        (
            lambda: stepbot.render("a.step", joints={"elbow": "up"}),
            r"^render\(joints=...\) takes a mapping .* a number",
        ),
        (lambda: stepbot.render("arm.step", view="korner"), "^view: no view 'korner'; did you mean 'corner'"),
    ],
)
def test_wrong_arguments_name_the_right_ones(call: Callable[[], object], message: str) -> None:
    """An unknown argument, a flag for a path and an unknown name are errors before anything is read."""
    with pytest.raises((TypeError, ValueError), match=message):
        call()


@pytest.mark.slow
def test_draft_and_render_write_files(folder: Path) -> None:
    """A draft is a sidecar that `check` accepts; a picture is a PNG of the size asked for."""
    pytest.importorskip("embreex")
    sidecar, picture = folder / "arm2" / "draft.robot.yaml", folder / "arm2.png"
    drafted = stepbot.draft(folder / "arm2" / "arm2.step", output=sidecar)
    assert sidecar.read_text(encoding="utf-8") == drafted.text
    assert drafted.draft is not None
    assert drafted.draft.robot == "draft"
    assert stepbot.check(sidecar, open_step=True).checked.joints == len(drafted.draft.joints) == 4
    arm = folder / "arm2" / "arm2.robot.yaml"
    png = stepbot.render(arm, output=picture, joints={"elbow": 0.5}, size=(80, 60), samples=1).png
    assert picture.read_bytes() == png
    assert (png[:4], int.from_bytes(png[16:20]), int.from_bytes(png[20:24])) == (b"\x89PNG", 80, 60)
    with pytest.raises(ValueError, match=r"^joints: no moving joint 'ellbow'"):
        stepbot.render(arm, joints={"ellbow": 0.5})


def test_one_string_is_one_name(tmp_path: Path) -> None:
    """Where several names, codes or folders are possible, one does without a list; it is not its letters."""
    sidecar = tmp_path / "arm.robot.yaml"
    sidecar.write_text("version: 1\nrobot: arm\n", encoding="utf-8")
    one, several = (
        stepbot.convert(sidecar, output=tmp_path / "out", cache=False, **options)  # type: ignore[arg-type]
        for options in (
            {"formats": "mjcf", "ignore": "SB505", "require": "mujoco", "package_path": tmp_path},
            {"formats": ["mjcf"], "ignore": ["SB505"], "require": ["mujoco"], "package_path": [tmp_path]},
        )
    )
    assert list(map(str, one.diagnostics)) == list(map(str, several.diagnostics))
    with pytest.raises(ValueError, match="no engine 'mujoko'; did you mean 'mujoco'"):
        stepbot.verify(tmp_path / "none.urdf", require="mujoko")


def test_python_minus_m(tmp_path: Path) -> None:
    """``python -m stepbot`` is the command line, and imports nothing from the current folder."""
    (tmp_path / "click.py").write_text("raise SystemExit('imported from the current folder')\n", encoding="utf-8")
    command = [sys.executable, "-m", "stepbot", "--version"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert stepbot.__version__ in run.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"package": "Arm-2"}, "not the name of a ROS package"),
        ({"ros2": "arm 2"}, "not the name of a ROS package"),
        ({"package": "arm2", "ros2": "arm2"}, "cannot be combined"),
        ({"ros2": "arm2", "formats": ["mjcf"]}, "ros2 needs the format urdf"),
    ],
)
def test_package_names_are_checked(arguments: dict[str, str], message: str, tmp_path: Path) -> None:
    """A name that is not one of a ROS package is an error before anything is read or written."""
    with pytest.raises(ValueError, match=message):
        stepbot.convert(tmp_path / "missing.yaml", output=tmp_path / "out", **arguments)  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()
