"""``stepbot docs``: the documentation at a page, a heading or a code."""

import json
import re
from pathlib import Path

import pytest

from stepbot.diagnostics.codes import CODES
from stepbot_cli import docs

from .conftest import Stepbot

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """The addresses that a browser was asked for; there is a site."""
    urls: list[str] = []
    monkeypatch.setattr(docs.webbrowser, "open", lambda url: not urls.append(url))
    monkeypatch.setattr(docs, "_SITES", (tmp_path,))
    return urls


@pytest.mark.parametrize(
    ("word", "page", "anchor"),
    [
        (None, "index", "documentation"),
        ("sidecar", "sidecar", ""),
        ("sidecar.md", "sidecar", ""),
        ("SB130:link", "diagnostics", "sb130-unknown-name"),
        ("sb131", "diagnostics", "sb130-unknown-name"),
        ("the install", "commands", "the-install"),
        ("completion", "commands", "shell-completion"),
        ("lock", "revisions", "when-the-cad-changes-lock-files"),
    ],
)
def test_opens_the_site(word: str | None, page: str, anchor: str, opened: list[str], stepbot: Stepbot) -> None:
    """A page, a code in any case, and a word of a heading open the site there; nothing opens the map."""
    run = stepbot("docs", *([word] if word else []))
    assert run.code == 0, run.err
    (url,) = opened
    assert f"/docs/{page}.html#{anchor}" in url
    assert run.out.splitlines()[0] == url


def test_prints_without_a_site(stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the site the section is printed; an unknown word lists the pages."""
    monkeypatch.setattr(docs, "_SITES", ())
    assert stepbot("docs", "SB130:link").out.startswith("### SB130: unknown name\n")
    assert json.loads(stepbot("docs", "SB130:link", "--json").out)["url"] is None
    run = stepbot("docs", "xyzzyx")
    assert run.code == 2
    assert "nothing about 'xyzzyx'" in run.err
    assert "sidecar" in run.err


def test_printed_links_lead_somewhere(stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Links to what an installed stepbot lacks, decisions and notes of the benchmarks, are printed as their text."""
    monkeypatch.setattr(docs, "_SITES", ())
    page = "# Documentation\n[0002](decisions/0002.md), [notes](../benchmarks/N.md#a), [map](README.md#b), [w](https://w.org)"
    (tmp_path / "README.md").write_text(page, encoding="utf-8")
    monkeypatch.setattr(docs, "_PAGES", (tmp_path,))
    assert stepbot("docs").out.splitlines()[1] == "0002, notes, [map](README.md#b), [w](https://w.org)"


def test_every_page_that_a_message_names_exists() -> None:
    """No message points to a file that an installed stepbot does not have; `stepbot docs PAGE` finds each page."""
    code = [code.explanation + code.fix for code in CODES.values()]
    code += [path.read_text(encoding="utf-8") for path in (ROOT / "src" / "stepbot").rglob("*.py")]
    named = set(re.findall(r"stepbot docs ([a-z-]+)", "\n".join(code)))
    assert named >= {"sidecar", "mapping"}
    assert not [name for name in named if not (ROOT / "docs" / f"{name}.md").is_file()]
    assert not [text for text in code[: len(CODES)] if re.search(r"docs/[\w-]+\.md", text)]
