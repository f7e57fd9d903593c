"""Modules imported by a command before it does any work."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = {
    "OCP",
    "fcl",
    "gymnasium",
    "lxml",
    "manifold3d",
    "mujoco",
    "networkx",
    "pinocchio",
    "numpy",
    "pybullet",
    "pydantic",
    "pydrake",
    "ruamel",
    "scipy",
    "trimesh",
    "yourdfpy",
}

SIDECAR = """\
version: 1
robot: arm
step: absent.step
links:
  base: {rest: true}
"""


COMPOSED = """\
version: 1
robot: two
modules:
  first: {file: arm2.robot.yaml}
  second: {file: arm2.robot.yaml, at: first/tool0}
"""

UNCHANGED = (
    ["convert", "arm2.robot.yaml", "--no-verify", "-o", "out"],
    ["convert", "two.robot.yaml", "--no-verify", "-o", "two"],
    ["check", "arm2.robot.yaml"],
)

SLOW = {"bz2", "hashlib", "multiprocessing", "random", "shutil", "socket", "subprocess", "tempfile", "traceback"}
"""Modules of the standard library that take milliseconds, as long as all of stepbot's own for `--version`."""


def loaded_by(arguments: list[str], folder: Path) -> tuple[int, set[str]]:
    """Exit code and modules of one run of ``stepbot``; packages by their names, stepbot's own modules in full."""
    program = (
        "import sys; from stepbot_cli import main; code = main(sys.argv[1:]); loaded = list(sys.modules);"
        "import json; sys.stderr.write(json.dumps([code, loaded]))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=True,
    )
    code, modules = json.loads(run.stderr.splitlines()[-1])
    return code, {name if name.startswith("stepbot") else name.partition(".")[0] for name in modules}


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["convert", "--help"], ["explain", "SB001"]])
def test_help_loads_nothing_heavy(arguments: list[str], tmp_path: Path) -> None:
    """`--help` imports no kernel, no engine and no numpy."""
    code, modules = loaded_by(arguments, tmp_path)
    assert code == 0
    assert not modules & HEAVY


@pytest.mark.slow
def test_check_loads_neither_kernel_nor_engine(tmp_path: Path) -> None:
    """`check` of a sidecar imports the YAML reader and the schema only."""
    (tmp_path / "arm.robot.yaml").write_text(SIDECAR, encoding="utf-8")
    code, modules = loaded_by(["check", "arm.robot.yaml"], tmp_path)
    assert code == 0
    assert not modules & (HEAVY - {"numpy", "pydantic", "ruamel", "lxml"})


@pytest.fixture(scope="module")
def converted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a robot that has been converted and checked, and a cache."""
    folder = tmp_path_factory.mktemp("converted")
    robot = Path(__file__).parents[2] / "robot_library" / "stepbot_arm2"
    for file in (robot / "arm2.step", robot / "arm2.robot.yaml"):
        (folder / file.name).write_bytes(file.read_bytes())
    (folder / "two.robot.yaml").write_text(COMPOSED, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STEPBOT_CACHE", str(folder / "cache"))
        for arguments in UNCHANGED:
            assert loaded_by(arguments, folder)[0] == 0
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("arguments", UNCHANGED)
def test_unchanged_input_loads_little(arguments: list[str], converted: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`convert` and `check` of unchanged files import no numpy, no parser, and nothing that starts processes."""
    monkeypatch.setenv("STEPBOT_CACHE", str(converted / "cache"))
    code, modules = loaded_by(arguments, converted)
    assert code == 0
    known = set() if arguments[0] == "check" else {"hashlib"}  # `convert` compares files with hashes in its report
    assert not modules & (HEAVY | SLOW - known)
    few = ("stepbot.diagnostics", "stepbot.formats", "stepbot.runtime", "stepbot_cli")
    assert {name for name in modules if name.startswith("stepbot") and not name.startswith(few)} == {
        "stepbot",
        "stepbot.jobs",
        "stepbot.jobs.incremental",
        "stepbot.pipeline",
        "stepbot.pipeline.conversion",
        "stepbot.report",
        "stepbot.revisions",
        "stepbot.step",
        "stepbot.step.exchange",
        "stepbot.step.exchange.input_files",
        "stepbot.version",
        *({"stepbot.jobs.discovery"} if arguments[0] == "check" else ()),
    }
    assert not any(name.endswith(".writer") for name in modules)
    assert not {"dataclasses", "msgspec"} & modules  # named tuples define the few records of an unchanged check


@pytest.mark.slow
def test_a_conversion_loads_what_it_writes(converted: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that is not verified imports no engine, no data sheet, and nothing for ROS 2 or programs for learning."""
    monkeypatch.setenv("STEPBOT_CACHE", str(converted / "cache"))
    code, modules = loaded_by(["convert", "arm2.robot.yaml", "--no-verify", "-o", "other", "-f", "urdf"], converted)
    assert code == 0
    assert "stepbot.formats.urdf.writer" in modules
    assert not modules & (HEAVY - {"manifold3d", "numpy", "pydantic", "ruamel"})
    assert not modules & {"stepbot.formats.learning", "stepbot.robot.datasheet", "stepbot.verification"}
    assert not any(name.startswith("stepbot.formats.urdf.ros2.") for name in modules)


def test_version_loads_only_click(tmp_path: Path) -> None:
    """`--version` imports click, and of stepbot the command group and what keeps its streams open."""
    code, modules = loaded_by(["--version"], tmp_path)
    assert code == 0
    assert {name for name in modules if name.startswith("stepbot")} == {
        "stepbot",
        "stepbot.runtime",
        "stepbot.runtime.import_path",
        "stepbot.version",
        "stepbot_cli",
        "stepbot_cli.application",
        "stepbot_cli.streams",
    }
    assert not modules & (SLOW | HEAVY)


def test_help_loads_no_command(tmp_path: Path) -> None:
    """`--help` lists the commands without importing them; of the formats it reads the declarations."""
    code, modules = loaded_by(["--help"], tmp_path)
    assert code == 0
    commands = {name for name in modules if name.startswith("stepbot_cli.")}
    assert commands == {"stepbot_cli.application", "stepbot_cli.streams"}
    assert not modules & HEAVY
