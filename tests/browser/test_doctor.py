"""``stepbot doctor --webgl``: the page that it opens reports what the browser draws with."""

import http.client
import json
from collections.abc import Callable
from threading import Thread
from urllib.parse import urlsplit

import pytest

from stepbot.jobs.health import OK, PROBLEM
from stepbot.serving.webgl import examine_webgl

from .page import Page

pytestmark = pytest.mark.slow


def test_the_browser_reports_its_renderer(page: Page) -> None:
    """Without a graphics card the processor draws, and the report says that it is slow."""
    item = examine_webgl(lambda url: Thread(target=page.driver.get, args=(url,)).start())
    assert (item.area, item.state) == ("browser", OK)
    assert ("SwiftShader" if page.is_chromium else "llvmpipe") in item.detail
    assert item.detail.endswith("without a graphics card: slow")
    page.wait("return document.querySelector('p').textContent.includes('can be closed')")


def answering(content: dict[str, str]) -> Callable[[str], None]:
    """A browser that posts a report."""

    def opened(url: str) -> None:
        place = urlsplit(url)
        connection = http.client.HTTPConnection(place.netloc)
        connection.request("POST", f"{place.path}ask/webgl", json.dumps(content), {"Content-Type": "application/json"})
        assert connection.getresponse().status == 200
        connection.close()

    return opened


@pytest.mark.parametrize(
    ("browser", "detail"),
    [
        (answering({"renderer": "", "browser": "Firefox/128.0"}), "Firefox/128.0: no WebGL 2"),
        (lambda url: False, "no browser was found"),
        (lambda url: True, "no answer from a browser within 0.1 s"),
    ],
)
def test_a_browser_that_cannot_draw_is_a_problem(browser: Callable[[str], object], detail: str) -> None:
    """Each failure says what is wrong, and what to do."""
    item = examine_webgl(browser, seconds=0.1)
    assert (item.state, item.detail) == (PROBLEM, detail)
    assert item.fix
