"""Output bytes do not depend on hash seed, locale, folder, number of cores or previous output."""

import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from stepbot.runtime.processes import NO_FORK
from tests.command_line import COMMAND, Conversion, convert, convert_once, environment, snapshot, stepbot_process

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("without_cache")]


def first_run(temporary: pytest.TempPathFactory, library: Path, robot: str) -> Conversion:
    """The reference conversion: the sidecar by an absolute path, the output by a relative one."""
    return convert_once(temporary, robot, next((library / robot).glob("*.robot.yaml")))


def assert_same_bytes(one: Path, other: Path) -> None:
    """Assert that two folders have the same files."""
    expected, found = snapshot(one), snapshot(other)
    assert "report.json" in expected
    assert list(found) == list(expected)
    assert [name for name in expected if found[name] != expected[name]] == []


def old_processor() -> dict[str, str]:
    """Environment in which OpenBLAS and numpy use the instructions of the oldest supported processors (x86-64)."""
    found = np.show_config("dicts")["SIMD Extensions"].get("found", [])
    return {"OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": " ".join(found)}


def test_the_processor_changes_rounding() -> None:
    """The environment of an old processor has an effect: sums of products by BLAS have other last digits."""
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("OpenBLAS has such kernels for x86-64 alone")
    script = "import numpy as np; a = np.random.default_rng(1).random((50, 3)); print(np.dot(a, a.T).tobytes().hex())"
    printed = [
        subprocess.run([sys.executable, "-c", script], env=environment(changes), capture_output=True, check=True).stdout
        for changes in (old_processor(), {"OPENBLAS_CORETYPE": "Haswell"})
    ]
    assert printed[0] != printed[1]


@pytest.mark.slow
def test_other_seed_core_processor_folder_and_paths(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, robot_library: Path
) -> None:
    """One core of an old processor, ASCII, another hash seed, time zone, home and folder do not change the bytes."""
    first = first_run(tmp_path_factory, robot_library, "stepbot_arm2")
    sidecar = robot_library / "stepbot_arm2" / "arm2.robot.yaml"
    one_core = "import os, runpy, sys\n" + (
        "os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n" if hasattr(os, "sched_setaffinity") else ""
    )
    command = [sys.executable, "-c", f"{one_core}runpy.run_module('stepbot_cli', run_name='__main__', alter_sys=True)"]
    changes = {
        "PYTHONHASHSEED": "4711",
        "LC_ALL": "C",
        "TZ": "Asia/Tokyo",
        "PYTHONIOENCODING": "ascii",
        "COLUMNS": "60",
        "PYTHONDONTWRITEBYTECODE": "1",
        **old_processor(),
        "HOME": str(tmp_path / "some where"),
    }
    elsewhere = tmp_path / "some where"
    elsewhere.mkdir()
    run = subprocess.run(
        [*command, "convert", str(sidecar), "-o", str(tmp_path / "out")],
        cwd=elsewhere,
        env=environment(changes),
        capture_output=True,
        check=False,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr.decode()
    assert_same_bytes(first.folder, tmp_path / "out")


@pytest.fixture(scope="session")
def german(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Environment of a locale with a decimal comma; the test is skipped without such a locale."""
    folder = tmp_path_factory.mktemp("locales")
    changes = {"LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"}
    if shutil.which("localedef"):
        made = subprocess.run(
            ["localedef", "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")], capture_output=True, check=False
        )
        if made.returncode == 0:
            changes["LOCPATH"] = str(folder)
    ask = "import locale; locale.setlocale(locale.LC_ALL, ''); print(locale.str(0.5))"
    reported = subprocess.run([sys.executable, "-c", ask], env=environment(changes), capture_output=True, check=False)
    if reported.stdout.strip() != b"0,5":
        pytest.skip("no locale with a decimal comma on this system, and none could be made")
    return changes


@pytest.mark.long
def test_other_locale_and_relative_paths(
    german: dict[str, str], tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, robot_library: Path
) -> None:
    """A locale with decimal commas and relative paths do not change the bytes."""
    first = first_run(tmp_path_factory, robot_library, "stepbot_four_bar")
    (tmp_path / "a" / "b").mkdir(parents=True)
    for file in ("four_bar.robot.yaml", "four_bar.step"):
        shutil.copy(robot_library / "stepbot_four_bar" / file, tmp_path / "a" / file)
    run = subprocess.run(
        [*COMMAND, "convert", "../four_bar.robot.yaml", "-o", "../../out/here"],
        cwd=tmp_path / "a" / "b",
        env=environment({**german, "PYTHONHASHSEED": "random"}),
        capture_output=True,
        check=False,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr.decode()
    assert_same_bytes(first.folder, tmp_path / "out" / "here")


@pytest.mark.long  # tests/unit/step/test_without_fork.py compares the assemblies
def test_without_fork(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, robot_library: Path) -> None:
    """Processes started as new interpreters, as on macOS and Windows, do not change the bytes or the proof."""
    first = first_run(tmp_path_factory, robot_library, "stepbot_four_bar")
    sidecar = robot_library / "stepbot_four_bar" / "four_bar.robot.yaml"
    run = stepbot_process("convert", sidecar, "-o", "out", cwd=tmp_path, changes={NO_FORK: "1"})
    assert run.code == 0, run.err
    assert_same_bytes(first.folder, tmp_path / "out")


@pytest.mark.long
@pytest.mark.parametrize("robot", ["stepbot_stewart", "stepbot_upper_body", "robotiq_2f85", "universal_robots_ur5e"])
def test_old_processor(tmp_path: Path, robot_library: Path, robot: str) -> None:
    """Loops, hulls, and pieces of convex decomposition have the same bytes on an old processor."""
    (sidecar,) = (robot_library / robot).glob("*.robot.yaml")
    formats = [word for name in ("urdf", "sdf", "mjcf", "usd", "webots") for word in ("-f", name)]
    command = ("convert", sidecar, "--no-verify", *formats, "-o")
    assert stepbot_process(*command, "here", cwd=tmp_path).code == 0
    assert stepbot_process(*command, "there", cwd=tmp_path, changes=old_processor()).code == 0
    assert_same_bytes(tmp_path / "here", tmp_path / "there")


@pytest.mark.long  # `make wheels` compares robots with such hulls between Pythons
@pytest.mark.parametrize(("robot", "times"), [("stepbot_diff_drive", 6), ("stepbot_upper_body", 6)])
def test_repeated_conversions(tmp_path: Path, robot_library: Path, robot: str, times: int) -> None:
    """Repeated conversions in new processes without a cache have the same bytes, including large hulls."""
    (sidecar,) = (robot_library / robot).glob("*.robot.yaml")
    runs = [convert(sidecar, tmp_path / str(i), "--no-verify", run=stepbot_process) for i in range(times)]
    assert any(name.endswith("_hull.obj") for name in snapshot(runs[0].folder))
    for run in runs[1:]:
        assert_same_bytes(runs[0].folder, run.folder)


@pytest.mark.slow
def test_one_format_alone_has_the_same_bytes(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, robot_library: Path
) -> None:
    """The bytes of a format do not depend on other formats or on verification."""
    first = first_run(tmp_path_factory, robot_library, "stepbot_arm2")
    sidecar = robot_library / "stepbot_arm2" / "arm2.robot.yaml"
    alone = convert(sidecar, tmp_path / "alone", "-f", "mjcf", "--no-verify")
    expected, found = snapshot(first.folder), snapshot(alone.folder)
    files = set(found) - {"report.json", ".stepbot.json"}
    assert files == {name for name in expected if name.endswith(".xml") or name.startswith("meshes/")}
    assert [name for name in files if found[name] != expected[name]] == []


@pytest.mark.slow
def test_again_into_the_same_folder(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, robot_library: Path
) -> None:
    """A second run into the same folder writes no file but its stamp."""
    sidecar = robot_library / "stepbot_four_bar" / "four_bar.robot.yaml"
    convert(sidecar, tmp_path / "out", "-f", "urdf", "--no-verify")
    before = {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in (tmp_path / "out").rglob("*.*")}
    assert len(before) > 10
    convert(sidecar, tmp_path / "out", "-f", "urdf", "--no-verify")
    after = {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in (tmp_path / "out").rglob("*.*")}
    stamp = tmp_path / "out" / ".stepbot.json"
    assert [path for path in before if after[path] != before[path]] == [stamp]
    assert after[stamp][0] == before[stamp][0]
