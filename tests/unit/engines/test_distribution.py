"""Which installed distribution an engine's module comes from."""

import importlib
import sys
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path

import pytest

from stepbot.engines.distribution import provider

Install = Callable[..., Path]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Writes a module, and the metadata folder of a distribution with a list of its files."""
    monkeypatch.syspath_prepend(tmp_path)

    def write(distribution: str, file: str, size: int | None = None) -> Path:
        module = tmp_path / file
        module.parent.mkdir(parents=True, exist_ok=True)
        module.write_text("x = 1\n", encoding="utf-8")
        folder = tmp_path / f"{distribution}.dist-info"
        folder.mkdir()
        lines = [f"examples/{file},sha256=a,1", f"{file},sha256=b,{module.stat().st_size if size is None else size}"]
        (folder / "RECORD").write_text("\n".join(lines) + "\n", encoding="utf-8")
        importlib.invalidate_caches()
        return folder

    yield write
    provider.cache_clear()
    sys.path_importer_cache.pop(str(tmp_path), None)


def test_fork_provides_the_module(install: Install) -> None:
    """A module whose distribution has another name is found, with that distribution's version."""
    install("engine_arm64-3.2.8", "engine_of_test.py")
    assert provider("engine_of_test") == {"distribution": "engine-arm64", "version": "3.2.8"}


def test_list_with_the_present_size_counts(install: Install) -> None:
    """Of two distributions with the same file, the one whose file is there counts; examples of that name do not."""
    install("aaa-1.0", "other/engine_of_test.py")
    install("upstream-3.2.7", "engine_of_test.py", size=99)
    install("zzz_fork-3.2.8", "engine_of_test.py")
    assert provider("engine_of_test") == {"distribution": "zzz-fork", "version": "3.2.8"}


def test_package_is_listed_from_its_parent(install: Install) -> None:
    """A package is listed with its folder."""
    install("engine_core-4.0.0", "engine_of_test/__init__.py")
    assert provider("engine_of_test") == {"distribution": "engine-core", "version": "4.0.0"}


def test_package_in_a_prefix_is_listed_above(install: Install, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Wheels that bring a tree of their own have it in a folder beside their list; Python is not asked."""
    install("engine_tree-4.1.0", "prefix/lib/engine_of_test/__init__.py")
    monkeypatch.syspath_prepend(tmp_path / "prefix" / "lib")
    monkeypatch.setattr(metadata, "packages_distributions", None)
    assert provider("engine_of_test") == {"distribution": "engine-tree", "version": "4.1.0"}


def test_without_a_list_the_metadata_answer(install: Install) -> None:
    """Metadata without a list of files, as Debian's, are asked too; a module of no distribution has no version."""
    folder = install("engine_of_debian-1.2", "engine_of_test.py")
    (folder / "RECORD").unlink()
    (folder / "METADATA").write_text("Name: engine-of-debian\nVersion: 1.2\n", encoding="utf-8")
    (folder / "top_level.txt").write_text("engine_of_test\n", encoding="utf-8")
    assert provider("engine_of_test") == {"distribution": "engine-of-debian", "version": "1.2"}
    assert provider("no_such_module_of_test") == {"distribution": "no_such_module_of_test", "version": "unknown"}


@pytest.mark.parametrize("module", ["mujoco", "yourdfpy", pytest.param("pybullet", marks=pytest.mark.pybullet)])
def test_agrees_with_python(module: str) -> None:
    """What is read from the lists is what Python's own, slow search finds."""
    found = provider(module)
    assert found["distribution"] in metadata.packages_distributions()[module]
    assert found["version"] == metadata.version(found["distribution"])
