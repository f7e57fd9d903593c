"""``convert --html`` and ``batch --html``."""

import shutil
from pathlib import Path

import pytest
from lxml import html

from tests.cli.conftest import Stepbot

FAST = ("-f", "urdf", "--no-verify")


def test_a_page_is_written_with_the_files(arm: Path, stepbot: Stepbot) -> None:
    """It is there, the folder stays up to date, and the page goes when it is no longer asked for."""
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out", "--html", *FAST)
    assert run.code == 0
    page = (arm / "out" / "report.html").read_bytes()
    assert html.fromstring(page.decode()).xpath("string(//title)") == "arm2 – stepbot report"
    assert stepbot("uptodate", "arm2.robot.yaml", "-o", "out", "-f", "urdf").code == 0
    assert stepbot("convert", "arm2.robot.yaml", "-o", "again", "--html", *FAST).code == 0
    assert (arm / "again" / "report.html").read_bytes() == page
    assert stepbot("convert", "arm2.robot.yaml", "-o", "out", *FAST).code == 0
    assert not (arm / "out" / "report.html").exists()


@pytest.mark.slow
def test_a_cached_page_has_the_same_bytes(arm: Path, stepbot: Stepbot) -> None:
    """A second conversion takes the page from the cache."""
    pages = []
    for folder in ("first", "second"):
        assert stepbot("convert", "arm2.robot.yaml", "-o", folder, "--html", "--cache", "kept", *FAST).code == 0
        pages.append((arm / folder / "report.html").read_bytes())
    assert pages[0] == pages[1]


@pytest.mark.slow
def test_a_batch_has_an_index(arm: Path, stepbot: Stepbot, robot_library: Path) -> None:
    """All robots with links to their pages; a failed one with its errors and without a page."""
    sidecar = (arm / "arm2.robot.yaml").read_text(encoding="utf-8")
    (arm / "broken <b>.robot.yaml").write_text(sidecar.replace("parent:", "parrent:", 1), encoding="utf-8")
    for file in ("four_bar.robot.yaml", "four_bar.step"):
        shutil.copy(robot_library / "stepbot_four_bar" / file, arm)
    run = stepbot("batch", ".", "-o", "out", "--html", *FAST)
    assert run.code == 1
    text = (arm / "out" / "index.html").read_text(encoding="utf-8")
    index = html.fromstring(text)
    rows = {row.get("data-robot"): row for row in index.xpath("//tr[@data-robot]")}
    assert set(rows) == {"arm2", "broken <b>", "four_bar"}
    for name in ("arm2", "four_bar"):
        (target,) = rows[name].xpath(".//a/@href")
        assert target == f"{name}/report.html"
        assert (arm / "out" / target).is_file()
    assert rows["broken <b>"].xpath(".//a") == []
    assert "parrent" in rows["broken <b>"].text_content()
    assert "<b>" not in text.replace('<b class="', "")
    assert "<script" not in text


@pytest.mark.parametrize("command", ["convert", "batch"])
def test_the_help_names_the_page(command: str, stepbot: Stepbot) -> None:
    """`--html` is an option of both commands."""
    assert "--html" in stepbot(command, "--help").out
