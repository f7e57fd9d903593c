"""The lists of packages for smaller installs, against the dependencies of stepbot and of the packages themselves."""

import re
import tomllib
from importlib.metadata import requires, version
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[2]
HOOK, LEAN = "requirements-check.txt", "requirements-lean.txt"
ENGINES = {"mujoco-core", "pybullet", "pybullet-arm64", "python-fcl", "yourdfpy"}
"""Dependencies that `check --step` does not need."""
UNUSED = {"cython"}
"""Required by packages of the lists, and imported by none."""


def listed(file: str) -> dict[str, Requirement]:
    """The requirements in a list by name, with those of lists that it includes."""
    found: dict[str, Requirement] = {}
    for line in (ROOT / file).read_text(encoding="utf-8").splitlines():
        if line.startswith("-r "):
            found |= listed(line.removeprefix("-r "))
        elif line and not line.startswith("#"):
            found[canonicalize_name(Requirement(line).name)] = Requirement(line)
    return found


def needed_here(texts: list[str]) -> list[Requirement]:
    """Requirements that apply to this interpreter, without extras."""
    return [one for one in map(Requirement, texts) if one.marker is None or one.marker.evaluate({"extra": ""})]


@pytest.mark.parametrize(("file", "left_out"), [(HOOK, ENGINES), (LEAN, set())])
def test_ranges_are_those_of_the_project(file: str, left_out: set[str]) -> None:
    """Dependencies of stepbot have the same range and marker in the list; the hook's leaves out engines alone."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    own = {canonicalize_name(one.name): one for one in map(Requirement, project["dependencies"])}
    packages = listed(file)
    assert own.keys() - packages.keys() == left_out
    for name in own.keys() & packages.keys() - {"pydantic"}:
        assert (packages[name].specifier, packages[name].marker) == (own[name].specifier, own[name].marker), name
    assert all(own["pydantic"].specifier.contains(one.version) for one in packages["pydantic"].specifier)


def test_no_package_is_missing() -> None:
    """What the listed packages require here is listed, unless nothing imports it."""
    packages = listed(LEAN)
    for name, one in packages.items():
        if one.marker is not None and not one.marker.evaluate():
            continue
        for needed in needed_here(requires(name) or []):
            assert canonicalize_name(needed.name) in packages.keys() | UNUSED, f"{name} requires {needed}"


def test_pydantic_and_its_core_fit() -> None:
    """The core that is listed is the one that the listed pydantic requires, as locked for CI."""
    packages = listed(HOOK)
    lock = (ROOT / "requirements-ci.txt").read_text(encoding="utf-8")
    for name in ("pydantic", "pydantic-core"):
        (locked,) = re.findall(rf"^{name.replace('-', '[-_]')}==(\S+)", lock, re.MULTILINE)
        assert str(packages[name].specifier) == f"=={locked}"
    if str(packages["pydantic"].specifier) == f"=={version('pydantic')}":
        (core,) = (one for one in needed_here(requires("pydantic") or []) if "core" in one.name)
        assert core.specifier == packages["pydantic-core"].specifier
