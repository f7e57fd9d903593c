"""axe-core finds nothing serious in any panel of the page, at work on a robot.

axe-core comes with `make install`, or as a file that AXE_CORE names.
"""

import os
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest

from stepbot.serving.session import Session

from .page import Page
from .test_settings import UNDECIDED

SERIOUS = ("serious", "critical")


def axe_script() -> str:
    """axe-core; skips loudly without it."""
    spec = find_spec("axe_playwright_python")
    places = [Path(one, "axe.min.js") for one in (spec.submodule_search_locations or () if spec else ())]
    path = next((one for one in (Path(os.environ.get("AXE_CORE", "")), *places) if one.is_file()), None)
    if path is None:
        pytest.skip("axe-core is not installed: run `make install`, or name its file in AXE_CORE")
    return path.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_serious(page: Page, edited: Callable[[str], Session], scheme: str) -> None:
    """Contrast, names, roles and order: every panel, with a joint and with a part selected, and the sheet of keys."""
    if not page.is_chromium:
        pytest.skip("colour schemes are set by a protocol of Chromium")
    script = axe_script()
    edited(UNDECIDED)
    media = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", media)
    page.wait("return stepbot.state.written")
    page.run(script + "; globalThis.axe = axe;")
    found: list[str] = []
    tabs = page.run("return [...document.querySelectorAll('[role=tab]')].map(tab => tab.getAttribute('aria-controls'))")
    try:
        for tab, selection in zip(tabs, ("{connection: 'crank_turn'}", "{link: 'crank'}", "null") * 3, strict=False):
            page.tab(tab)
            page.run(f"stepbot.state.select({selection})")
            page.run("for (const one of document.querySelectorAll('details')) one.open = true")
            result = page.driver.execute_async_script("axe.run(document).then(arguments[0])")
            assert {"color-contrast", "button-name", "aria-valid-attr"} <= {one["id"] for one in result["passes"]}
            found += [
                f"{tab}: {one['impact']} {one['id']}: {one['help']}: {node['html'][:160]}"
                for one in result["violations"]
                if one["impact"] in SERIOUS
                for node in one["nodes"]
            ]
    finally:
        page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    assert found == []
