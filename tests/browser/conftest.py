"""The page in headless Chromium; or in Firefox, whose WebGL needs a display, on a virtual one.

Sessions run in both (`test_sessions.py`); with PAGE_BROWSER=firefox all tests of the page do. `cargo install
geckodriver` gives its driver.
"""

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from stepbot.pipeline.conversion import Options
from stepbot.runtime.cache import Cache
from stepbot.serving.session import Session
from tests.conftest import FIREFOX_ABSENT, PAGE_ABSENT

from .page import Page

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
DRIVER = shutil.which("chromedriver")
FIREFOX = next(filter(None, map(shutil.which, ("firefox-esr", "firefox"))), None)
GECKODRIVER = shutil.which("geckodriver") or shutil.which("geckodriver", path=Path.home() / ".cargo" / "bin")
BROWSER = os.environ.get("PAGE_BROWSER", "chromium")
_FLAGS = (
    "--headless",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--webgl-antialias-mode=none",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reads the groups
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """One process has the browser."""
    for item in items:
        if item.path.parent == Path(__file__).parent:
            item.add_marker(pytest.mark.xdist_group("browser"))
            item.add_marker("browser")


@pytest.fixture(scope="session")
def driver(request: pytest.FixtureRequest) -> Iterator[Any]:
    """The browser, for all tests; its name is the parameter, if there is one."""
    try:
        from selenium import webdriver
    except ImportError:
        pytest.skip(PAGE_ABSENT)
    started = _firefox if getattr(request, "param", BROWSER) == "firefox" else _chromium
    with started(webdriver) as browser:
        browser.set_script_timeout(60)
        yield browser
        browser.quit()


@contextmanager
def _chromium(webdriver: Any) -> Iterator[Any]:
    if CHROMIUM is None or DRIVER is None:
        pytest.skip(PAGE_ABSENT)
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in _FLAGS:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    yield webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))


@contextmanager
def _firefox(webdriver: Any) -> Iterator[Any]:
    if FIREFOX is None or GECKODRIVER is None or shutil.which("Xvfb") is None:
        pytest.skip(FIREFOX_ABSENT)
    options = webdriver.FirefoxOptions()
    options.binary_location = FIREFOX
    options.set_preference("webgl.force-enabled", True)
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "1600x1200x24"]
    with subprocess.Popen(command, pass_fds=[writing], stderr=subprocess.DEVNULL) as screen:
        os.close(writing)
        try:
            with os.fdopen(reading) as number:
                display = {**os.environ, "DISPLAY": f":{number.readline().strip()}"}
            yield webdriver.Firefox(options=options, service=webdriver.FirefoxService(GECKODRIVER, env=display))
        finally:
            screen.terminate()


@pytest.fixture
def page(driver: Any) -> Iterator[Page]:
    """An empty tab of 1280 by 800 pixels; a test fails if the page reports an error to the console."""
    page = Page(driver)
    page.resize(1280, 800)
    driver.get("about:blank")
    if not page.is_chromium:  # it has no log of its console
        yield page
        return
    driver.get_log("browser")
    yield page
    errors = [entry["message"] for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]
    unexpected = [message for message in errors if not any(part in message for part in page.expected_errors)]
    assert not unexpected


@pytest.fixture
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[Path], Session]]:
    """Serves targets until the end of the test."""
    running: list[Session] = []
    cache = Cache(tmp_path_factory.getbasetemp() / "browser_cache")

    def serve(target: Path) -> Session:
        session = Session(target, Options(output=Path(), cache=cache))
        running.append(session)
        session.load()
        session.server.start()
        return session

    yield serve
    for session in running:
        session.close()


@pytest.fixture
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Geometry that is read once for all tests; what an edit gives is computed each time."""
    return tmp_path_factory.getbasetemp() / "browser_cache"


@pytest.fixture
def edited(robot_library: Path, tmp_path: Path, cache: Path, page: Page) -> Iterator[Callable[[str], Session]]:
    """Serves the four-bar linkage with another sidecar, for editing; errors of refused edits are expected."""
    running: list[Session] = []
    page.expected_errors = ["400 (Bad Request)"]

    def serve(text: str) -> Session:
        shutil.copy(robot_library / "stepbot_four_bar" / "four_bar.step", tmp_path)
        sidecar = tmp_path / "four_bar.robot.yaml"
        sidecar.write_text(text, encoding="utf-8", newline="")
        session = Session(sidecar, Options(output=Path(), cache=Cache(cache)), edits=True)
        running.append(session)
        session.load()
        session.server.start()
        page.open(session.server.url)
        # The card of what is selected is drawn anew when the sidecar's text arrives.
        page.wait("return document.querySelector('#live').textContent === 'live' && stepbot.state.written != null")
        return session

    yield serve
    page.driver.get("about:blank")  # it would report a connection that closes while it asks
    for session in running:
        session.close()
