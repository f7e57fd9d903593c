"""The wheel has what it must, and nothing else."""

import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    """The wheel, built from the checkout."""
    hatchling = pytest.importorskip("hatchling.builders.wheel")
    (path,) = hatchling.WheelBuilder(str(ROOT)).build(
        directory=str(tmp_path_factory.mktemp("dist")), versions=["standard"]
    )
    return zipfile.ZipFile(path)


def test_wheel_holds_both_packages_and_no_more(wheel: zipfile.ZipFile) -> None:
    """Every module of both source roots, the type markers, the metadata; no tests, no robots, no caches."""
    packages = [ROOT / "src" / "stepbot", ROOT / "cli" / "stepbot_cli"]
    modules = {
        file.relative_to(package.parent).as_posix()
        for package in packages
        for file in package.rglob("*")
        if file.suffix == ".py" or file.name == "py.typed"
    }
    content = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert content == modules
    assert {"stepbot/py.typed", "stepbot_cli/py.typed"} <= content


def test_wheel_names_the_command_and_the_licence(wheel: zipfile.ZipFile) -> None:
    """Installing the wheel gives ``stepbot``; the licence travels along."""
    metadata = {name.partition(".dist-info/")[2]: name for name in wheel.namelist() if ".dist-info/" in name}
    assert b"stepbot = stepbot_cli:main" in wheel.read(metadata["entry_points.txt"])
    assert b"Apache License" in wheel.read(metadata["licenses/LICENSE"])


def test_pybullet_is_required_only_where_it_has_wheels(wheel: zipfile.ZipFile) -> None:
    """PyBullet is core on Linux x86-64 up to Python 3.11, and an extra everywhere else."""
    requirement = pytest.importorskip("packaging.requirements").Requirement
    (name,) = (name for name in wheel.namelist() if name.endswith("METADATA"))
    lines = wheel.read(name).decode().splitlines()
    required = [requirement(line.partition(": ")[2]) for line in lines if line.startswith("Requires-Dist: pybullet")]

    def needed(extra: str = "", **environment: str) -> bool:
        here = {"sys_platform": "linux", "platform_machine": "x86_64", "python_version": "3.11", "extra": extra}
        return any(r.marker is not None and r.marker.evaluate({**here, **environment}) for r in required)

    assert needed()
    assert not needed(python_version="3.12")
    assert not needed(sys_platform="darwin")
    assert not needed(platform_machine="aarch64")
    assert needed("pybullet", python_version="3.13")
