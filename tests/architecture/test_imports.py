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
    "rich",
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


def loaded_by(arguments: list[str], folder: Path) -> tuple[int, set[str]]:
    """Exit code and top-level modules of one run of ``stepbot``."""
    program = (
        "import sys, json; from stepbot_cli import main; code = main(sys.argv[1:]);"
        "sys.stderr.write(json.dumps([code, sorted({m.partition('.')[0] for m in sys.modules})]))"
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
    return code, set(modules)


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["convert", "--help"], ["explain", "SB001"]])
def test_help_loads_nothing_heavy(arguments: list[str], tmp_path: Path) -> None:
    """`--help` imports no kernel, no engine and no numpy."""
    code, modules = loaded_by(arguments, tmp_path)
    assert code == 0
    assert not modules & HEAVY


def test_check_loads_neither_kernel_nor_engine(tmp_path: Path) -> None:
    """`check` of a sidecar imports the YAML reader and the schema only."""
    (tmp_path / "arm.robot.yaml").write_text(SIDECAR, encoding="utf-8")
    code, modules = loaded_by(["check", "arm.robot.yaml"], tmp_path)
    assert code == 0
    assert not modules & (HEAVY - {"numpy", "pydantic", "ruamel", "lxml"})
