"""The pre-commit hooks, run by pre-commit in a temporary repository."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from tests.cli.test_current_folder import set_traps
from tests.command_line import COMMAND, environment

ROOT = Path(__file__).resolve().parents[2]
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(importlib.util.find_spec("pre_commit") is None, reason="pre-commit is not installed"),
]


class Repository:
    """A git repository with a robot and the hooks."""

    def __init__(self, folder: Path, robot: Path) -> None:
        self.folder = folder
        self.changes = {
            "STEPBOT_NO_CACHE": "",
            "STEPBOT_CACHE": str(folder.parent / "kept"),
            "PRE_COMMIT_HOME": str(folder.parent / "pre-commit"),
            "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]),
            "GIT_CONFIG_GLOBAL": os.devnull,
        }
        (folder / "robots").mkdir(parents=True)
        for file in ("four_bar.robot.yaml", "four_bar.step"):
            shutil.copy(robot / file, folder / "robots")
        yaml = YAML(typ="safe", pure=True)
        hooks = yaml.load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
        for hook in hooks:
            hook["language"] = "system"  # the stepbot under test, not one that pre-commit would install
            hook.pop("additional_dependencies", None)
            if hook["id"] == "stepbot-uptodate":
                hook["args"] = ["-o", "{folder}/{name}"]
        with (folder / ".pre-commit-config.yaml").open("w", encoding="utf-8") as file:
            YAML().dump({"repos": [{"repo": "local", "hooks": hooks}]}, file)
        self.run("git", "init", "-q")
        self.convert()
        self.run("git", "add", "-A")

    def run(self, *command: str) -> subprocess.CompletedProcess[str]:
        """Run a command in the repository."""
        return subprocess.run(
            command,
            cwd=self.folder,
            env=environment(self.changes),
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
            timeout=600,
        )

    def convert(self) -> None:
        """Write the files to commit."""
        run = self.run(*COMMAND, "convert", "robots/four_bar.robot.yaml", "-o", "robots/four_bar", "--no-verify")
        assert run.returncode == 0, run.stderr
        (self.folder / "robots" / "four_bar" / "report.json").unlink()

    def hooks(self, *options: str) -> dict[str, str]:
        """The output of each hook."""
        run = self.run(sys.executable, "-P", "-m", "pre_commit", "run", "--color", "never", "--verbose", *options)
        lines = [line for line in run.stdout.splitlines() if line.startswith("stepbot ") and "..." in line]
        assert lines, run.stdout + run.stderr
        self.reported = run.stdout
        return {line.partition("...")[0]: line.rpartition(".")[2] for line in lines}


def test_hooks_in_a_scratch_repository(tmp_path: Path, robot_library: Path) -> None:
    """Current files pass; an edited output, an edited sidecar and a changed STEP fail."""
    repository = Repository(tmp_path / "repository", robot_library / "stepbot_four_bar")
    robots = repository.folder / "robots"
    assert repository.hooks() == {"stepbot check": "Passed", "stepbot uptodate": "Passed"}

    urdf = robots / "four_bar" / "four_bar.urdf"
    before = urdf.read_bytes()
    urdf.write_bytes(before.replace(b"0.", b"1.", 1))
    repository.run("git", "add", "-A")
    assert repository.hooks() == {"stepbot check": "Passed", "stepbot uptodate": "Failed"}
    assert "robots/four_bar/four_bar.urdf: error[SB007]" in repository.reported
    urdf.write_bytes(before)

    sidecar = robots / "four_bar.robot.yaml"
    text = sidecar.read_text(encoding="utf-8")
    sidecar.write_text(text.replace("robot: ", "robot: new_", 1), encoding="utf-8")
    repository.run("git", "add", "-A")
    assert repository.hooks() == {"stepbot check": "Passed", "stepbot uptodate": "Failed"}
    sidecar.write_text(text, encoding="utf-8")

    step = robots / "four_bar.step"
    original = step.read_bytes()
    repository.run("git", "add", "-A")
    repository.run("git", "-c", "user.name=a", "-c", "user.email=a@b", "commit", "-q", "-m", "robot")
    step.write_bytes(original[: len(original) // 2])
    repository.run("git", "add", "-A")
    assert repository.hooks() == {"stepbot check": "Failed", "stepbot uptodate": "Failed"}
    assert "SB201" in repository.reported


def test_hooks_import_nothing_of_a_repository(tmp_path: Path, robot_library: Path) -> None:
    """The hooks do not import `random.py` or `lxml.py` of the repository."""
    repository = Repository(tmp_path / "repository", robot_library / "stepbot_four_bar")
    marker = tmp_path / "marker"
    set_traps(repository.folder, marker)
    set_traps(repository.folder / "robots", marker)
    assert (repository.folder / "random.py").is_file()
    assert repository.hooks() == {"stepbot check": "Passed", "stepbot uptodate": "Passed"}
    assert not marker.exists(), marker.read_text(encoding="utf-8")


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="pre-commit clones a git repository")
def test_check_installs_no_engine(tmp_path: Path, robot_library: Path) -> None:
    """pre-commit installs `stepbot-check` without engines; a good robot passes, and a truncated STEP fails."""
    repository = Repository(tmp_path / "repository", robot_library / "stepbot_four_bar")
    revision = repository.run("git", "-C", str(ROOT), "rev-parse", "HEAD").stdout.strip()
    with (repository.folder / ".pre-commit-config.yaml").open("w", encoding="utf-8") as file:
        hook = {"id": "stepbot-check", "args": ["--no-cache"]}
        YAML().dump({"repos": [{"repo": str(ROOT), "rev": revision, "hooks": [hook]}]}, file)
    repository.run("git", "add", "-A")
    assert repository.hooks("--all-files") == {"stepbot check": "Passed"}, repository.reported
    (site,) = (tmp_path / "pre-commit").glob("repo*/py_env-*/lib/python*/site-packages")
    installed = {path.name for path in site.iterdir()}
    assert {"OCP", "pydantic", "stepbot_cli"} <= installed
    assert not installed & {"mujoco", "pybullet_data", "fcl", "scipy", "yourdfpy"}
    step = repository.folder / "robots" / "four_bar.step"
    step.write_bytes(step.read_bytes()[:10_000])
    repository.run("git", "add", "-A")
    assert repository.hooks("--all-files") == {"stepbot check": "Failed"}
    assert "SB201" in repository.reported
