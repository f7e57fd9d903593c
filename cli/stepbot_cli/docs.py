"""``stepbot docs``: open the documentation at a page, a heading or a diagnostic code."""

import re
import unicodedata
import webbrowser
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import click

import stepbot
from stepbot.diagnostics import did_you_mean
from stepbot.diagnostics.codes import CODES, current, full_code

from .command import Command, json_option
from .terminal import write_json, write_result

_PACKAGE = Path(stepbot.__file__).parent
_PAGES = (_PACKAGE / "docs", _PACKAGE.parents[1] / "docs")
"""The pages in a wheel, and in a checkout."""
_SITES = (_PACKAGE / "site", _PACKAGE.parents[1] / "build" / "site")
"""The site that `make docs` builds, in a wheel and in a checkout."""
_HEADING = re.compile(r"^#{1,4} (.*)$", re.MULTILINE)
_CODE_BLOCK = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\[([^\]]*)\]\(([^)#:]+)(?:#[^)]*)?\)")
_MAP = "README"


class Section(NamedTuple):
    """A heading of a page, and the text below it."""

    page: str
    heading: str
    text: str

    @property
    def anchor(self) -> str:
        """The heading's anchor in the site."""
        plain = unicodedata.normalize("NFKD", self.heading).encode("ascii", "ignore").decode()
        return re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", plain).strip().lower())


@click.command(cls=Command, epilog="Example: stepbot docs SB301")
@click.argument("word", required=False)
@click.option("--no-open", is_flag=True, help="Print the page or section and do not open a browser.")
@json_option
def command(word: str | None, no_open: bool, as_json: bool) -> int:
    """Open the documentation at WORD: a page, a diagnostic code, or a word of a heading. No network is needed.

    Without the site, as in a checkout before `make docs`, the text is printed. Without WORD, the map of all pages.
    """
    folder = next((place for place in _PAGES if (place / f"{_MAP}.md").is_file()), None)
    if folder is None:
        raise click.UsageError("this installation has no documentation")
    sections = [section for path in sorted(folder.glob("*.md")) for section in _sections(path)]
    codes = current(full_code(word or ""))
    matches = matching(sections, CODES[codes[0]].id if codes else word or _MAP)
    if not matches:
        names = dict.fromkeys(section.page for section in sections)
        near = "".join(did_you_mean(word or "", names)) or f"pages: {', '.join(names)}"
        raise click.BadParameter(f"nothing about '{word}'; {near}", param_hint="WORD")
    first, site = matches[0], next((place for place in _SITES if place.is_dir()), None)
    url = "" if site is None else f"{_file(site, first.page).as_uri()}#{first.anchor}"
    if as_json:
        rows = [{"page": one.page, "heading": one.heading, "anchor": one.anchor} for one in matches]
        write_json({"url": url or None, "matches": rows})
        return 0
    if no_open or not url or not webbrowser.open(url):
        write_result(_LINK.sub(lambda link: link[0] if (folder / link[2]).exists() else link[1], first.text))
    is_exact = first.page.casefold() == (word or _MAP).casefold() or len(matches) == 1
    others = [] if is_exact else [f"{one.page}: {one.heading}" for one in matches[1:6]]
    write_result("\n".join([*([url] if url else []), *(f"also {other}" for other in others)]) or first.page)
    return 0


def matching(sections: Sequence[Section], word: str) -> list[Section]:
    """The sections about a word, best first: a page of this name, then headings with it, texts with it; codes last."""
    key = word.removesuffix(".md").casefold()
    sections = sorted(sections, key=lambda section: section.page == "diagnostics")
    pages = [section for section in sections if section.page.casefold() == key][:1]
    begun = [section for section in sections if section.heading.casefold().startswith(key)]
    within = [section for section in sections if re.search(rf"\b{re.escape(key)}", section.heading.casefold())]
    named = list(dict.fromkeys([*pages, *begun, *within]))
    return named or [section for section in sections if key in section.text.casefold()]


def _sections(path: Path) -> Iterator[Section]:
    text = path.read_text(encoding="utf-8")
    blank = _CODE_BLOCK.sub(lambda block: re.sub(r"[^\n]", " ", block[0]), text)  # `#` in a shell is no heading
    heads = list(_HEADING.finditer(blank))
    for head, after in zip(heads, [*heads[1:], None], strict=True):
        end = after.start() if after is not None else len(text)
        yield Section(path.stem, text[head.start(1) : head.end(1)].replace("`", ""), text[head.start() : end].rstrip())


def _file(site: Path, page: str) -> Path:
    """The file of a page; README.md is the index of its folder."""
    return (site / "docs" / f"{'index' if page == _MAP else page}.html").resolve()
