"""Fixtures for all tests: a collector that must be read, the corpus of real assemblies, the robot library."""

import gc
import importlib.util
import os
import shutil
import signal
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from hypothesis import settings

from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.runtime.temporary import run_folder
from tests import warm
from tests.portable import PORTABLE

gc.disable()
"""Until all tests are collected: what is imported stays."""
ROOT = Path(__file__).resolve().parents[1]
os.environ.pop("COLUMNS", None)
os.environ["STEPBOT_NO_PROGRESS"] = "1"  # a slow machine must not change what a command prints
"""Tests do not depend on the size of the terminal, which readline passes to processes of pytest-xdist."""
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
"""Workers import functions of the tests, and nothing from the current folder unless it is listed here."""
CORPUS = Path(os.environ.get("STEPBOT_CORPUS", ROOT.parent / "shared" / "corpus"))
CORPUS_ABSENT = f"real STEP assemblies are absent: no folder {CORPUS} (set STEPBOT_CORPUS)"

PYBULLET_ABSENT = (
    f"PyBullet is not installed: it has no wheel for Python {sys.version_info[0]}.{sys.version_info[1]} on this system"
)
PAGE_ABSENT = "no page is tested: it needs Chromium, ChromeDriver and `pip install stepbot[browser,view]`"
FIREFOX_ABSENT = (
    "no page is tested in Firefox: it needs `apt-get install firefox-esr xvfb`, "
    "`cargo install geckodriver` and `pip install stepbot[browser,view]`"
)

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as in the background of a script; processes would inherit it
    signal.signal(signal.SIGINT, signal.default_int_handler)

# The duration of an example depends on the load of the machine.
settings.register_profile("short", deadline=None, max_examples=40)
settings.register_profile("long", deadline=None, max_examples=400)  # `make test-long`
settings.load_profile("short")


class ReadDiagnostics(Diagnostics):
    """A collector that records how many of its diagnostics a test has read."""

    def __init__(self) -> None:
        super().__init__()
        self.read = 0

    def __iter__(self) -> Iterator[Diagnostic]:
        self.read = len(self)
        return super().__iter__()

    def codes(self) -> list[str]:
        """The codes found, in order; reading them marks them as read."""
        return [diagnostic.code for diagnostic in self]


@pytest.fixture
def diagnostics() -> Iterator[ReadDiagnostics]:
    """A collector of diagnostics; the test fails if one remains unread."""
    collected = ReadDiagnostics()
    yield collected
    unread = list(collected)[collected.read :] if collected.read < len(collected) else []
    assert not unread, "nobody looked at:\n" + "\n".join(map(str, unread))


@pytest.fixture(scope="session")
def corpus() -> Path:
    """Folder of real STEP assemblies; the test is skipped if it is missing."""
    if not CORPUS.is_dir():
        pytest.skip(CORPUS_ABSENT)
    return CORPUS


@pytest.fixture(scope="session")
def robot_library() -> Path:
    """Folder of the robots that come with stepbot."""
    return ROOT / "robot_library"


def pytest_configure(config: pytest.Config) -> None:
    """Name a cache for commands of this run of the tests: what one has read and verified, no other reads again."""
    if not hasattr(config, "workerinput"):  # processes of pytest-xdist inherit it
        os.environ["STEPBOT_CACHE"] = tempfile.mkdtemp(prefix="stepbot-tests-")


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove the cache of this run."""
    if not hasattr(config, "workerinput"):
        shutil.rmtree(os.environ["STEPBOT_CACHE"])


@pytest.fixture
def without_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands have no cache: for tests whose subject is the work that it saves."""
    monkeypatch.setenv("STEPBOT_NO_CACHE", "1")


@pytest.fixture
def brief(monkeypatch: pytest.MonkeyPatch) -> None:
    """`verify` asks engines about few configurations and a short time: for tests of differences between files."""
    from stepbot.verification.files import observed

    monkeypatch.setattr("stepbot.verification.files.observed", partial(observed, count=8, seconds=0.01))


@pytest.fixture(scope="session", autouse=True)
def _warm_processes() -> Iterator[None]:
    """Workers of commands inside pytest are forked from processes that have loaded kernel and engines."""
    run_folder()  # locked before a test pretends that there are no locks: another run would remove it
    with warm.warm_processes():
        yield


@pytest.fixture
def cold_processes() -> Iterator[None]:
    """Workers are started as for every user: for tests of just that."""
    with warm.cold_processes():
        yield


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests run by `make wheels`."""
    for item in items:
        if item.path.relative_to(ROOT / "tests").as_posix().startswith(PORTABLE):
            item.add_marker("portable")


def pytest_collection_finish(session: pytest.Session) -> None:
    """Reject a pytest-xdist that does not group tests: they would share nothing, in silence.

    What has been imported until now stays: the garbage collector need not look at it again.
    """
    gc.enable()
    gc.collect()
    gc.freeze()
    if session.config.getoption("loadgroup", default=False):
        grouped = [item for item in session.items if item.get_closest_marker("xdist_group")]
        if lost := [item.nodeid for item in grouped if "@" not in item.nodeid]:
            raise pytest.UsageError(f"pytest-xdist ignores the groups of {len(lost)} tests with this version of pytest")


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip tests that require PyBullet if it is not installed."""
    if item.get_closest_marker("pybullet") and importlib.util.find_spec("pybullet") is None:
        pytest.skip(PYBULLET_ABSENT)


def pytest_report_header() -> str:
    """Report in the header whether the corpus of real assemblies is available."""
    return f"corpus: {CORPUS}" if CORPUS.is_dir() else f"corpus: ABSENT, {CORPUS_ABSENT}"


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Report in the summary what was skipped because the corpus or PyBullet is missing."""
    reported = [
        str(report.longrepr[2])
        for report in terminalreporter.getreports("skipped")
        if isinstance(report.longrepr, tuple)
    ]
    for reason in (CORPUS_ABSENT, PYBULLET_ABSENT, PAGE_ABSENT, FIREFOX_ABSENT):
        if count := sum(reason in one for one in reported):
            terminalreporter.section("not tested", yellow=True)
            terminalreporter.line(f"{count} tests skipped: {reason}", yellow=True)
