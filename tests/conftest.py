"""What every test may ask for: a collector that is read, the real assemblies, the robots of the library."""

import importlib.util
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from stepbot.diagnostics import Diagnostic, Diagnostics

ROOT = Path(__file__).resolve().parents[1]
os.environ["STEPBOT_NO_CACHE"] = "1"
"""No test finds what another one left; those of the cache name one of their own."""
os.environ.pop("COLUMNS", None)
"""No test is as wide as the terminal that it was started from, which readline hands to processes of pytest-xdist."""
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
"""Workers import functions of the tests, and nothing from the current folder unless it is named here."""
CORPUS = Path(os.environ.get("STEPBOT_CORPUS", ROOT.parent / "shared" / "corpus"))
CORPUS_ABSENT = f"real STEP assemblies are absent: no folder {CORPUS} (set STEPBOT_CORPUS)"

PYBULLET_ABSENT = (
    f"PyBullet is not installed: it has no wheel for Python {sys.version_info[0]}.{sys.version_info[1]} on this system "
    "(`pip install stepbot[pybullet]` compiles it)"
)
PORTABLE = (
    "unit/assemble/test_enclosing_shapes.py",
    "unit/assemble/test_joints.py",
    "unit/assemble/test_mass.py",
    "unit/geometry/",
    "unit/robot/test_dynamics.py",
    "unit/robot/test_kinematics.py",
    "unit/runtime/cache/",
    "unit/runtime/test_fork_server.py",
    "unit/runtime/test_worker.py",
    "unit/runtime/test_parallel.py",
    "unit/verification/test_comparison.py",
    "conformance/",
    "cli/test_application.py",
)
"""What `make wheels` runs in each Python: processes, types at run time, numbers, bytes, engines."""

# How long an example takes depends on what else the machine does.
settings.register_profile("unhurried", settings(), deadline=None)
settings.load_profile("unhurried")


class ReadDiagnostics(Diagnostics):
    """A collector that records how many of its diagnostics a test has inspected."""

    def __init__(self) -> None:
        super().__init__()
        self.read = 0

    def __iter__(self) -> Iterator[Diagnostic]:
        self.read = len(self)
        return super().__iter__()

    def codes(self) -> list[str]:
        """The codes found, in order; looking at them counts as reading."""
        return [diagnostic.code for diagnostic in self]


@pytest.fixture
def found() -> Iterator[ReadDiagnostics]:
    """A collector of diagnostics; the test fails if it leaves one unread."""
    diagnostics = ReadDiagnostics()
    yield diagnostics
    unread = list(diagnostics)[diagnostics.read :] if diagnostics.read < len(diagnostics) else []
    assert not unread, "nobody looked at:\n" + "\n".join(map(str, unread))


@pytest.fixture(scope="session")
def corpus() -> Path:
    """Folder of real STEP assemblies; the test is skipped where it is absent."""
    if not CORPUS.is_dir():
        pytest.skip(CORPUS_ABSENT)
    return CORPUS


@pytest.fixture(scope="session")
def robot_library() -> Path:
    """Folder of the robots that come with stepbot."""
    return ROOT / "robot_library"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests that `make wheels` runs."""
    for item in items:
        if item.path.relative_to(ROOT / "tests").as_posix().startswith(PORTABLE):
            item.add_marker("portable")


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip what needs PyBullet where it is not installed."""
    if item.get_closest_marker("pybullet") and importlib.util.find_spec("pybullet") is None:
        pytest.skip(PYBULLET_ABSENT)


def pytest_report_header() -> str:
    """Say at the top whether the real assemblies are there."""
    return f"corpus: {CORPUS}" if CORPUS.is_dir() else f"corpus: ABSENT, {CORPUS_ABSENT}"


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say once more at the end what was not tested for want of the corpus or of PyBullet."""
    told = [
        str(report.longrepr[2])
        for report in terminalreporter.getreports("skipped")
        if isinstance(report.longrepr, tuple)
    ]
    for reason in (CORPUS_ABSENT, PYBULLET_ABSENT):
        if count := sum(reason in one for one in told):
            terminalreporter.section("not tested", yellow=True)
            terminalreporter.line(f"{count} tests skipped: {reason}", yellow=True)
