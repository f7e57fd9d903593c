"""Cache keys contain everything that a result depends on, and nothing else."""

import os
from pathlib import Path

import pytest

from stepbot.runtime.cache import Digest, content_digest, environment, file_digest, own_code
from stepbot.runtime.programs import find_program


def test_parts_do_not_run_together() -> None:
    """Keys depend on the boundaries of parts and on the purpose."""
    keys = [
        Digest("a").add("ab", "c").key,
        Digest("a").add("a", "bc").key,
        Digest("a").add("abc").key,
        Digest("b").add("abc").key,
        Digest("a").add("abc", "").key,
    ]
    assert len(set(keys)) == len(keys)
    assert Digest("a").add("é").key == Digest("a").add("é".encode()).key


def test_file_by_its_content(tmp_path: Path) -> None:
    """The digest of a file depends on its content only; an unreadable file has none."""
    for name in ("a", "b"):
        (tmp_path / name).write_bytes(b"x" * 5_000_000)
    assert file_digest(tmp_path / "a") == file_digest(tmp_path / "b")
    (tmp_path / "b").write_bytes(b"x" * 4_999_999 + b"y")
    assert file_digest(tmp_path / "a") != file_digest(tmp_path / "b")
    assert file_digest(tmp_path / "c") is None
    assert file_digest(tmp_path) is None


def test_files_by_names_and_content() -> None:
    """The key of several files depends on their names, not on the order of creation."""
    assert content_digest({"a": b"1", "b": b"2"}) == content_digest({"b": b"2", "a": b"1"})
    assert content_digest({"a": b"1", "b": b"2"}) != content_digest({"a": b"2", "b": b"1"})


def test_environment_holds_code_and_packages() -> None:
    """The environment includes more than stepbot's code, and is constant within a process."""
    assert environment() == environment()
    assert environment() != own_code()


def test_a_package_more_is_another_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Any installed package changes the environment, since dependencies may use it."""
    before = environment()
    monkeypatch.syspath_prepend(tmp_path)
    keys = []
    for name in ("some_solver-1.0.dist-info", "some_solver-1.1.dist-info"):
        (tmp_path / name).mkdir()
        environment.cache_clear()
        keys.append(environment())
        (tmp_path / name).rmdir()
    environment.cache_clear()
    assert len({before, *keys}) == 3
    assert environment() == before


@pytest.mark.skipif(os.name == "nt", reason="the programs are scripts of a Unix shell here")
def test_an_external_program_is_part_of_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An upgraded library of an external program changes the environment, even with the same launcher."""
    folder, library = tmp_path / "bin", tmp_path / "share" / "gz" / "sdformat14.yaml"
    folder.mkdir()
    library.parent.mkdir(parents=True)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")

    def key() -> str:
        environment.cache_clear()
        return environment()

    keys = [key()]
    (folder / "gz").write_text("#!/bin/sh\n")
    (folder / "gz").chmod(0o755)
    keys.append(key())
    library.write_text("library_version: 14.0.0\n")
    keys.append(key())
    library.write_text("library_version: 14.0.10\n")
    keys.append(key())
    os.utime(library, ns=(1, 1))
    keys.append(key())
    (folder / "gz").write_text("#!/bin/bash\n")
    keys.append(key())
    assert len(set(keys)) == len(keys)
    assert key() == keys[-1]
    environment.cache_clear()


def test_a_program_in_the_current_folder_is_not_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Empty and relative entries of PATH are not searched for programs."""
    program = tmp_path / "gz"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", os.pathsep.join(["", ".", "./"]))
    assert find_program("gz") is None
    monkeypatch.setenv("PATH", os.pathsep.join([".", str(tmp_path)]))
    assert os.name == "nt" or find_program("gz") == str(program)
