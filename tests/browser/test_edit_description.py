"""``view --edit arm.urdf`` in the page: what a description can change has a field, what it cannot has no button."""

from pathlib import Path

import pytest

from stepbot.pipeline.conversion import Options
from stepbot.serving.session import Session
from stepbot.sidecar.starter import description_starter
from tests.composition.described import box, joint, link, urdf

from .page import Page
from .test_edit_panel import ENTER, settled
from .test_settings import typed

ARM = urdf(
    "arm",
    link("base", 2.0, box(0.2, 0.2, 0.1)),
    link("upper arm", 1.0, box(0.1, 0.1, 0.4)),
    joint("lift", "base", "upper arm", axis="0 1 0"),
)


def replaced(page: Page, text: str, keys: str) -> None:
    """Type a value into a field that has that of the file."""
    page.wait("return document.querySelector(`#card [data-set='${arguments[0]}']`)?.value", keys)
    page.run("document.querySelector(`#card [data-set='${arguments[0]}']`).value = ''", keys)
    typed(page, "#card", text, keys)


@pytest.mark.slow
def test_a_description_is_edited(page: Page, tmp_path: Path) -> None:
    """A link gets a name, a mass and a frame, a joint its limit and an actuator; the URDF keeps its bytes."""
    source, sidecar = tmp_path / "arm.urdf", tmp_path / "arm.robot.yaml"
    source.write_text(ARM, encoding="utf-8")
    sidecar.write_text(description_starter(source), encoding="utf-8")
    session = Session(sidecar, Options(output=tmp_path / "out"), edits=True)
    try:
        session.load()
        session.server.start()
        page.open(session.server.url)
        page.wait("return stepbot.state.written?.described === 'arm.urdf'")
        assert "changes of arm.urdf" in page.text("#hint")
        page.wait("return document.querySelector('#todo [data-decide=floating]')")
        page.element("#todo [data-decide=floating]").click()
        page.wait("return !document.querySelector('#todo [data-decide=floating]')")
        page.run("stepbot.state.select({link: 'upper arm'})")
        assert not page.driver.find_elements("css selector", "#card [data-edit=merge]")
        page.run("document.querySelector('#card [data-edit=link-name]').value = ''")
        page.element("#card [data-edit=link-name]").send_keys("upper_arm" + ENTER)
        settled(page)
        page.wait("return stepbot.state.selection.link === 'upper_arm'")
        replaced(page, "1.5 kg", "links.upper_arm.inertial.mass")
        page.wait("return stepbot.state.scene.total.mass === 3.5")
        page.run("document.querySelector('#card [data-group=\"new frames\"]').open = true")
        page.element("#card [data-add=frames]").click()
        settled(page)
        place = page.run(
            "const {state, view} = stepbot; const box = view.canvas.getBoundingClientRect();"
            "for (let y = 70; y < box.height; y += 4) for (let x = 4; x < box.width; x += 4) {"
            "  const hit = view.hit(box.left + x, box.top + y);"
            "  if (hit?.link === 'upper_arm') { state.select(hit); return hit.point; } }"
        )
        X = page.run("return stepbot.state.pose('upper_arm')")
        origin = page.run("return document.querySelector(\"#card [data-set='sensors..origin']\").value")
        xyz = [float(one) for one in origin.split("xyz: [")[1].split("]")[0].replace("mm", "").split(",")]
        assert X[:9] == [1, 0, 0, 0, 1, 0, 0, 0, 1]
        assert xyz == pytest.approx([1e3 * (place[i] - X[9 + i]) for i in range(3)], abs=1e-3)
        assert origin.endswith("relative_to: upper_arm}")
        page.run("stepbot.state.select({connection: 'lift'})")
        assert not page.element("#card [data-edit=remove]").is_displayed()
        replaced(page, "4 N*m", "joints.lift.limits.effort")
        typed(page, "#card", "auto", "actuators..gains")
        page.run("document.querySelector(\"#card [data-set='actuators..kind']\").value = 'position'")
        page.element("#card [data-add=actuators]").click()
        settled(page)
        assert page.text("#notice").startswith("saved")
        page.driver.get("about:blank")
    finally:
        session.close()
    assert source.read_text(encoding="utf-8") == ARM
    text = sidecar.read_text(encoding="utf-8")
    assert "rename: {links: {upper arm: upper_arm}}" in text.replace('"', "")
    assert "\nbase: floating\n" in text
    assert "inertial: {mass: 1.5 kg}" in text
    assert "limits: {effort: 4 N*m}" in text
    assert "actuators: {lift: {joint: lift" in text
    assert "frames: {frame" in text
