"""The list of packages that the hook installs, against the dependencies of stepbot and of the packages themselves."""

import re
import tomllib
from importlib.metadata import requires, version
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[2]
ENGINES = {"mujoco-core", "pybullet", "python-fcl", "yourdfpy"}
"""Dependencies that `check --step` does not need."""


def listed() -> dict[str, Requirement]:
    """The requirements in requirements-check.txt by name."""
    lines = (ROOT / "requirements-check.txt").read_text(encoding="utf-8").splitlines()
    found = [Requirement(line) for line in lines if line and not line.startswith("#")]
    return {canonicalize_name(one.name): one for one in found}


def applicable(texts: list[str]) -> list[Requirement]:
    """Requirements for this interpreter, without extras."""
    return [one for one in map(Requirement, texts) if one.marker is None or one.marker.evaluate({"extra": ""})]


def test_ranges_are_those_of_the_project() -> None:
    """Dependencies of stepbot have the same range in both files, and only engines are left out."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    hook = listed()
    own = {canonicalize_name(one.name): one for one in map(Requirement, project["dependencies"])}
    assert own.keys() - hook.keys() == ENGINES
    for name in own.keys() & hook.keys() - {"pydantic"}:
        assert hook[name].specifier == own[name].specifier, name
    assert all(own["pydantic"].specifier.contains(one.version) for one in hook["pydantic"].specifier)


def test_no_package_is_missing() -> None:
    """What the listed packages require here is listed, and admits the installed versions."""
    hook = listed()
    for name, one in hook.items():
        if one.marker is not None and not one.marker.evaluate():
            continue
        for needed in applicable(requires(name) or []):
            assert canonicalize_name(needed.name) in hook, f"{name} requires {needed}"


def test_pydantic_and_its_core_fit() -> None:
    """The core that is listed is the one that the listed pydantic requires, as locked for CI."""
    lock = (ROOT / "requirements-ci.txt").read_text(encoding="utf-8")
    for name in ("pydantic", "pydantic-core"):
        (locked,) = re.findall(rf"^{name.replace('-', '[-_]')}==(\S+)", lock, re.MULTILINE)
        assert str(listed()[name].specifier) == f"=={locked}"
    if str(listed()["pydantic"].specifier) == f"=={version('pydantic')}":
        (core,) = (one for one in applicable(requires("pydantic") or []) if "core" in one.name)
        assert core.specifier == listed()["pydantic-core"].specifier
