"""The follower arm of the corpus: from a plain STEP to a moving robot without writing YAML."""

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

pytestmark = [pytest.mark.long]


def test_follower_arm_by_clicks_alone(page: Page, corpus: Path, tmp_path: Path) -> None:
    """The draft moves at once; dragging the limits of its six joints leaves a sidecar without a placeholder."""
    step = tmp_path / "follower.step"
    shutil.copy(corpus / "low_cost_robot_follower.step", step)
    sidecar, found = tmp_path / "follower.robot.yaml", Diagnostics()
    options = Options(output=Path(), cache=Cache(tmp_path / "cache"))
    draft = draft_step(step, options).draft
    assert draft is not None
    write_draft(draft, sidecar, step, "", found)
    assert not found.has_errors
    comments = re.findall(r"#.*", sidecar.read_text(encoding="utf-8"))

    session = Session(sidecar, options, edits=True)
    try:
        session.load()
        session.server.start()
        page.open(session.server.url)
        page.wait("return document.querySelector('#live').textContent === 'live'")
        names = page.run("return stepbot.state.scene.connections.map(one => one.name)")
        assert len(names) == 6
        for name in names:
            page.run("stepbot.state.select({connection: arguments[0]})", name)
            for end, value in (("lower", -60), ("upper", 75)):
                page.run(
                    "const bar = document.querySelector(`#card [data-limit=${arguments[0]}]`);"
                    "bar.value = arguments[1];"
                    "bar.dispatchEvent(new Event('input')); bar.dispatchEvent(new Event('change'));",
                    end,
                    value,
                )
            page.until(lambda name=name: _is_limited(sidecar, name), f"limits of {name}")
            page.wait(
                "return stepbot.state.scene.connections.find(one => one.name === arguments[0]).limits.upper !== null",
                name,
            )
        for name in names:
            page.slide(name, 30.0)
            assert page.positions()[name] == pytest.approx(0.5235987755982988)
        page.driver.get("about:blank")  # a comparison of links under way would be refused by an ended server
    finally:
        session.close()
    result = check(sidecar, open_step=True, cache=False)
    assert not result.diagnostics.has_errors
    assert "SB463" not in {one.code for one in result.diagnostics}
    assert re.findall(r"#.*", sidecar.read_text(encoding="utf-8")) == comments


def _is_limited(sidecar: Path, name: str) -> bool:
    text = sidecar.read_text(encoding="utf-8")
    return "limits: {lower: -60 deg, upper: 75 deg}" in text.split(f"\n  {name}:")[1].split("\n  #")[0]
