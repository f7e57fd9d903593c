"""A mouse robot of the corpus, made from its STEP in the page by clicks and one typed density."""

import re
import shutil
from pathlib import Path

import pytest

from stepbot.api import check
from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.drafting import draft_step, write_draft
from stepbot.runtime.cache import Cache
from stepbot.serving.session import Session

from .page import Page
from .test_edit_panel import ENTER, settled

pytestmark = [pytest.mark.long]

CLICKS = 11
"""Presses of the mouse that the robot takes; docs/view.md gives the number."""
LINES = 6
"""Lines of the sidecar that are not those of the draft, without those that are gone."""
RIM, TYRE = "Whreel5_ネジ穴位置改良", "タイヤφ44用7.5mm幅_RT-T75-44-R"

LISTED = "return stepbot.state.writtenOf === stepbot.state.scene"
"""The list of decisions is that of the robot that is shown."""


def test_the_robot_of_its_truth_without_touching_yaml(page: Page, corpus: Path, tmp_path: Path) -> None:
    """Rims join their tyres, the wheels are confirmed, the plastic gets its density, and the robot is proven."""
    step = tmp_path / "pimouse.step"
    shutil.copy(corpus / "assemblies" / "pimouse.step", step)
    sidecar, found = tmp_path / "pimouse.robot.yaml", Diagnostics()
    options = Options(output=tmp_path / "pimouse", cache=Cache(tmp_path / "cache"))
    draft = draft_step(step, options).draft
    assert draft is not None
    write_draft(draft, sidecar, step, "", found)
    before = sidecar.read_text(encoding="utf-8").split("\n")
    session = Session(sidecar, options, edits=True)
    try:
        session.load()
        session.server.start()
        page.open(session.server.url)
        page.wait("return document.querySelectorAll('#todo .decision').length > 2")
        page.run(
            "globalThis.clicks = 0; addEventListener('pointerdown', event => { clicks += event.isTrusted; }, true)"
        )
        page.tab("parts")
        page.element("#search").send_keys("Whreel5")
        for place, link in (("1", "wheel"), ("2", "wheel_2")):
            page.wait(LISTED)
            page.element(f'#parts [data-component="{RIM}:{place}"]').click()
            page.element("#card [data-edit=link]").send_keys(link)
            page.element("#card [data-edit=assign]").click()
            page.wait("return stepbot.state.selection.link === arguments[0]", link)
            settled(page)
        page.tab("todo")
        page.wait(LISTED)
        for decision in ("[data-kind=axis] [data-decide=right]", "[data-kind=review] [data-decide=right]"):
            page.element(f"#todo {decision}").click()
            settled(page)
            page.wait(LISTED)
        page.wait("return document.querySelector(\"#todo [data-set='defaults.density']\")")
        page.element("#todo [data-set='defaults.density']").send_keys("1040 kg/m^3" + ENTER)
        page.wait("return !document.querySelector(\"#todo [data-set='defaults.density']\")")
        while page.driver.find_elements("css selector", "#todo [data-decide=ignore]"):
            left = page.run("return document.querySelectorAll('#todo .decision').length")
            page.element("#todo [data-decide=ignore]").click()
            page.wait("return document.querySelectorAll('#todo .decision').length < arguments[0]", left)
        assert "Nothing is left to decide." in page.text("#todo")
        page.tab("proof")
        page.element("#convert").click()
        page.wait("return document.querySelector('#converted').textContent.includes('the files are in')")
        clicks = page.run("return clicks")
        page.driver.get("about:blank")
    finally:
        session.close()
    assert clicks == CLICKS
    assert (tmp_path / "pimouse" / "pimouse.urdf").is_file()
    text = sidecar.read_text(encoding="utf-8")
    for link, place in (("wheel", "1"), ("wheel_2", "2")):
        parts = re.search(rf"\n  {link}:\n    parts: (.*)", text)
        assert parts is not None
        assert parts[1] == f'["{TYRE}:{place}", "{RIM}:{place}"]'
    assert "REVIEW" not in text.split("version: 1")[1]
    result = check(sidecar, open_step=True, cache=False)
    assert not result.diagnostics.has_errors
    for row in result.checked.joint_table:
        assert row.axis is not None
        assert row.origin is not None
        assert [round(abs(x)) for x in row.axis] == [0, 1, 0]
        assert [round(1e3 * row.origin[i]) for i in (0, 2)] == [0, 24]
    changed = [line for line in text.split("\n") if line not in before]
    assert len(changed) == LINES, changed
