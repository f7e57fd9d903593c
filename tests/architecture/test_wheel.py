"""Content of the wheel."""

import os
import posixpath
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTATION = ("stepbot/docs/", "stepbot/site/")
CODE = (".py", ".js", ".css", ".html")
LARGEST_ROBOTS = 2_400_000
LARGEST_CODE = 1_644_000
LARGEST_DOCUMENTATION = 10_000_000
"""Maximum compressed sizes [bytes] in the wheel; the geometry kernel's is twenty times the sum of both."""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from the checkout."""
    hatchling = pytest.importorskip("hatchling.builders.wheel")
    (path,) = hatchling.WheelBuilder(str(ROOT)).build(
        directory=str(tmp_path_factory.mktemp("dist")), versions=["standard"]
    )
    return Path(path)


@pytest.fixture(scope="module")
def wheel(built: Path) -> zipfile.ZipFile:
    """The files in the wheel."""
    return zipfile.ZipFile(built)


@pytest.mark.slow
def test_wheel_holds_both_packages_and_no_more(wheel: zipfile.ZipFile) -> None:
    """The wheel has every module of both source roots, page, type markers, robots, metadata; no tests, no caches."""
    packages = [ROOT / "src" / "stepbot", ROOT / "cli" / "stepbot_cli"]
    modules = {
        file.relative_to(package.parent).as_posix()
        for package in packages
        for file in package.rglob("*")
        if file.suffix in (".py", ".toml", ".json", ".html", ".css", ".js", ".txt") or file.name == "py.typed"
    }
    content = {name for name in wheel.namelist() if ".dist-info/" not in name}
    data = ("stepbot/robots/", "stepbot/schemas/", *DOCUMENTATION)
    assert {name for name in content if not name.startswith(data)} == modules
    assert {"stepbot/py.typed", "stepbot_cli/py.typed"} <= content


@pytest.mark.slow
def test_wheel_holds_of_every_robot_what_it_is_made_from(wheel: zipfile.ZipFile) -> None:
    """The wheel has drawing, sidecar and page of each robot, and the notices; no scripts, no pictures; and is small."""
    library = ROOT / "robot_library"
    kinds = ("*.step", "*.robot.yaml", "README.md", "cell_*.urdf", "cell_*.xml")
    kept = [file for kind in kinds for file in library.glob(f"*/{kind}")]
    kept.append(library / "NOTICES.md")
    content = {name for name in wheel.namelist() if name.startswith("stepbot/robots/")}
    assert content == {f"stepbot/robots/{file.relative_to(library).as_posix()}" for file in kept}
    robots = sum(file.compress_size for file in wheel.infolist() if file.filename in content)
    pages = sum(file.compress_size for file in wheel.infolist() if file.filename.startswith(DOCUMENTATION))
    assert robots < LARGEST_ROBOTS
    assert pages < LARGEST_DOCUMENTATION
    code = [file for file in wheel.infolist() if file.filename.endswith(CODE) and file.filename not in content]
    assert sum(file.compress_size for file in code if not file.filename.startswith(DOCUMENTATION)) < LARGEST_CODE


def test_wheel_holds_the_documentation(wheel: zipfile.ZipFile) -> None:
    """The wheel has every page, which `stepbot docs` prints where there is no site; and no script."""
    content = {name for name in wheel.namelist() if name.startswith("stepbot/docs/")}
    assert content == {f"stepbot/docs/{page.name}" for page in (ROOT / "docs").glob("*.md")}


def test_sidecars_in_the_wheel_point_to_their_schema(wheel: zipfile.ZipFile) -> None:
    """The first line of each sidecar refers to the schema in the wheel, as in a checkout."""
    names = set(wheel.namelist())
    sidecars = [name for name in names if name.endswith(".robot.yaml")]
    assert sidecars
    for name in sidecars:
        first = wheel.read(name).decode().partition("\n")[0]
        target = first.removeprefix("# yaml-language-server: $schema=")
        assert posixpath.normpath(posixpath.join(posixpath.dirname(name), target)) in names, (name, first)
    schema = (ROOT / "schemas" / "robot-1.schema.json").read_bytes()
    assert wheel.read("stepbot/schemas/robot-1.schema.json") == schema


@pytest.mark.long
def test_installed_wheel_exports_a_robot(built: Path, tmp_path: Path) -> None:
    """Installed by pip in an empty environment, `stepbot` lists, shows, exports and converts the robots."""
    venv.create(tmp_path / "venv", with_pip=True)
    programs = tmp_path / "venv" / ("Scripts" if sys.platform == "win32" else "bin")
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV"))}

    def run(program: str, *arguments: str) -> str:
        command = [str(programs / program), *arguments]
        done = subprocess.run(
            command, cwd=tmp_path, env=clean, capture_output=True, text=True, encoding="utf-8", check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    run("python", "-m", "pip", "install", "--quiet", str(built))
    names = {path.parent.name for path in (ROOT / "robot_library").glob("*/build.py")}
    names |= {path.name.partition(".")[0] for path in (ROOT / "robot_library" / "composed").glob("*.robot.yaml")}
    assert {line.split()[0] for line in run("stepbot", "library", "list").splitlines()} == names
    shown = run("stepbot", "library", "show", "ur5e")
    assert str(tmp_path / "venv") in shown
    assert "shoulder_pan_joint" in shown
    run("stepbot", "library", "export", "arm2", "--source", "-o", ".")
    run("stepbot", "convert", "arm2.robot.yaml", "--no-verify", "--no-cache")
    assert (tmp_path / "arm2" / "arm2.urdf").is_file()
    assert "robots/robot-1" not in run("stepbot", "schema", "--vscode")
    reported = run("stepbot", "library", "export", "four_bar", "-f", "mjcf", "-o", "four_bar", "--no-cache")
    assert "files in four_bar" in reported
    assert (tmp_path / "four_bar" / "four_bar.xml").is_file()
    load = "import mujoco; print(mujoco.MjModel.from_xml_path('four_bar/four_bar.xml').nbody)"
    assert run("python", "-c", load).strip() == "5"  # the world and four links


@pytest.mark.slow
def test_wheel_names_the_command_and_the_licence(wheel: zipfile.ZipFile) -> None:
    """The wheel declares the command ``stepbot`` and contains the licence."""
    metadata = {name.partition(".dist-info/")[2]: name for name in wheel.namelist() if ".dist-info/" in name}
    assert b"stepbot = stepbot_cli:command" in wheel.read(metadata["entry_points.txt"])
    assert b"Apache License" in wheel.read(metadata["licenses/LICENSE"])


def test_pybullet_is_required_only_where_it_has_wheels(wheel: zipfile.ZipFile) -> None:
    """Upstream PyBullet is required where it has a wheel, the fork where only that has one, and nowhere both."""
    requirement = pytest.importorskip("packaging.requirements").Requirement
    (name,) = (name for name in wheel.namelist() if name.endswith("METADATA"))
    lines = wheel.read(name).decode().splitlines()
    required = [requirement(line.partition(": ")[2]) for line in lines if line.startswith("Requires-Dist: pybullet")]

    def needed(system: str, machine: str, python: str) -> list[str]:
        here = {"sys_platform": system, "platform_machine": machine, "python_version": python, "extra": ""}
        return [r.name for r in required if r.marker is not None and r.marker.evaluate(here)]

    assert needed("linux", "x86_64", "3.11") == ["pybullet"]
    for system, machine in (("linux", "x86_64"), ("darwin", "arm64"), ("win32", "AMD64")):
        for python in ("3.12", "3.13"):
            assert needed(system, machine, python) == ["pybullet-arm64"]
        assert needed(system, machine, "3.14") == []
    assert needed("darwin", "x86_64", "3.12") == ["pybullet-arm64"]
    assert needed("darwin", "x86_64", "3.13") == []
    assert needed("linux", "aarch64", "3.12") == []
