"""What a person does in the page, and what the page says."""

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from stepbot.viewing.page import page_html

NARROWEST = 500
CONTROL = "\ue009"
"""The key in WebDriver."""
PATIENCE = 20.0
"""Seconds that a page may take to show something; no test measures speed with it."""


class Element:
    """The first element of a CSS selector, looked up again where the page has drawn it anew meanwhile."""

    def __init__(self, driver: Any, selector: str) -> None:
        self._driver = driver
        self._selector = selector
        self._do(lambda element: element)

    def _do(self, action: Callable[[Any], Any]) -> Any:
        from selenium.common.exceptions import StaleElementReferenceException

        end = time.monotonic() + PATIENCE
        while True:
            try:
                return action(self._driver.find_element("css selector", self._selector))
            except StaleElementReferenceException:
                assert time.monotonic() < end, f"drawn again and again: {self._selector}"

    def click(self) -> None:
        """Click its centre."""
        self._do(lambda element: element.click())

    def clear(self) -> None:
        """Remove its text."""
        self._do(lambda element: element.clear())

    def send_keys(self, *keys: str) -> None:
        """Press keys with the focus on it."""
        self._do(lambda element: element.send_keys(*keys))

    def is_displayed(self) -> bool:
        """Whether a person can see it."""
        return bool(self._do(lambda element: element.is_displayed()))

    def is_enabled(self) -> bool:
        """Whether it takes input."""
        return bool(self._do(lambda element: element.is_enabled()))

    def get_attribute(self, name: str) -> Any:
        """An attribute."""
        return self._do(lambda element: element.get_attribute(name))

    def get_property(self, name: str) -> Any:
        """A property."""
        return self._do(lambda element: element.get_property(name))

    @property
    def text(self) -> str:
        """The text that a person can read."""
        return str(self._do(lambda element: element.text))

    @property
    def rect(self) -> dict[str, float]:
        """Its `x`, `y`, `width` and `height` in the page [CSS pixels]."""
        return dict(self._do(lambda element: element.rect))


class Page:
    """A tab with the page."""

    def __init__(self, driver: Any) -> None:
        self.driver = driver
        self.is_chromium = driver.name == "chrome"
        self.expected_errors: list[str] = []
        """Parts of messages on the console that the test causes."""

    def open(self, url: str) -> None:
        """Open a page and wait for its robot."""
        self.driver.get(url)
        self.wait("return globalThis.stepbot?.state.scene != null")

    def open_file(self, folder: Path, scene: Mapping[str, Any]) -> None:
        """Write a page without a server, and open it."""
        path = folder / "page.html"
        path.write_text(page_html(scene["name"], dict(scene)), encoding="utf-8")
        self.open(path.as_uri())

    def load(self, scene: Mapping[str, Any]) -> None:
        """Show another robot in an open page."""
        self.run("stepbot.state.load(arguments[0])", scene)

    def run(self, script: str, *arguments: Any) -> Any:
        """The result of a script."""
        return self.driver.execute_script(script, *arguments)

    def wait(self, script: str, *arguments: Any) -> Any:
        """The first true result of a script."""
        return self.until(lambda: self.run(script, *arguments), script)

    def until(self, condition: Callable[[], Any], what: str) -> Any:
        """The first true result of a function."""
        end = time.monotonic() + PATIENCE
        while not (found := condition()):
            assert time.monotonic() < end, f"did not become true: {what}"
            time.sleep(0.02)
        return found

    def resize(self, width: int, height: int) -> None:
        """Size of the visible page [CSS pixels]; it is drawn with a quarter of them, without a graphics card."""
        if self.is_chromium:
            metrics = {"width": width, "height": height, "deviceScaleFactor": 0.5, "mobile": False}
            self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
            return
        if width < NARROWEST:
            pytest.skip(f"a window of Firefox is at least {NARROWEST} pixels wide")
        borders = self.run("return [outerWidth - innerWidth, outerHeight - innerHeight]")
        self.driver.set_window_size(width + borders[0], height + borders[1])

    def element(self, selector: str) -> Element:
        """The first element of a CSS selector."""
        return Element(self.driver, selector)

    def text(self, selector: str) -> str:
        """Its text."""
        return self.element(selector).text

    def tab(self, name: str) -> None:
        """Open a panel."""
        self.element(f"[role=tab][aria-controls={name}]").click()

    def slide(self, name: str, value: float) -> None:
        """Drag a slider to a value, in its unit: degrees or millimetres."""
        self.run(
            "const bar = document.querySelector(`[data-slider='${arguments[0]}']`);"
            "bar.value = arguments[1]; bar.dispatchEvent(new Event('input'));",
            name,
            value,
        )

    def positions(self) -> dict[str, float]:
        """Positions of all moving joints [rad], [m]."""
        return dict(self.run("return stepbot.state.q()"))

    def poses(self) -> dict[str, list[float]]:
        """For each link twelve numbers: the rotation by rows, the position [m]."""
        script = "const {state} = stepbot; return state.scene.links.map(link => [link.name, state.pose(link.name)])"
        return dict(self.run(script))

    def pixel_of(self, link: str, component: str = "") -> tuple[float, float]:
        """A place of the window where a link, or one of its components, can be clicked."""
        place = self.run(
            """const {view} = stepbot; const box = view.canvas.getBoundingClientRect();
            for (let y = 70; y < box.height; y += 6) for (let x = 4; x < box.width; x += 6) {
              const at = [box.left + x, box.top + y];
              if (document.elementFromPoint(...at) !== view.canvas) continue;
              const hit = view.hit(...at);
              if (hit && hit.link === arguments[0] && (!arguments[1] || hit.component === arguments[1])) return at;
            } return null;""",
            link,
            component,
        )
        assert place is not None, f"{link} {component} cannot be seen"
        return place[0], place[1]

    def click(self, at: tuple[float, float], *, with_control: bool = False) -> None:
        """Press and release the mouse at a place of the window."""
        self.drag(at, at, with_control=with_control)

    def drag(self, start: tuple[float, float], end: tuple[float, float], *, with_control: bool = False) -> None:
        """Press the mouse at a place of the window, move it in steps, and release it."""
        from selenium.webdriver.common.actions.action_builder import ActionBuilder

        actions = ActionBuilder(self.driver, duration=10)
        if with_control:
            actions.key_action.key_down(CONTROL)
        steps = [[round(a + (b - a) * i / 8) for a, b in zip(start, end, strict=True)] for i in range(9)]
        actions.pointer_action.move_to_location(*steps[0]).pointer_down()
        for at in steps[1:] if start != end else ():
            actions.pointer_action.move_to_location(*at)
        actions.pointer_action.pointer_up()
        # One device after the other: the key is held until the mouse is released.
        for _ in range(len(actions.pointer_action.source.actions) - len(actions.key_action.source.actions)):
            actions.key_action.pause()
        if with_control:
            actions.key_action.key_up(CONTROL)
            actions.pointer_action.pause()
        actions.perform()
