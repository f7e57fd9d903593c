"""The robots of a batch on one page, each with a link to its report."""

from collections.abc import Sequence
from dataclasses import dataclass
from urllib.parse import quote

from ..page import plain_page
from .markup import Markup, element, mass_text
from .robot_tables import table


@dataclass(frozen=True)
class Entry:
    """One robot."""

    name: str
    status: str
    """``converted``, ``unchanged`` or ``failed``."""
    page: str = ""
    """Path of its report, relative to the index, with slashes; empty without one."""
    passed: int = 0
    failed: int = 0
    not_run: int = 0
    links: int | None = None
    joints: int | None = None
    mass: float | None = None
    """[kg]."""
    errors: tuple[str, ...] = ()
    """Messages."""
    warnings: int = 0


def index_page(entries: Sequence[Entry]) -> bytes:
    """The page."""
    failed = sum(one.status == "failed" for one in entries)
    words = (
        f"{len(entries)} {'robot' if len(entries) == 1 else 'robots'}, {failed} failed"
        if failed
        else f"{len(entries)} robots"
    )
    headings = ("robot", "result", "checks", "mass", "links", "joints", "warnings", "errors")
    body = element(
        "div",
        element("section", element("h2", words), table(headings, map(_row, entries))),
        id="report",
    )
    return plain_page("Robots – stepbot report", body).encode("utf-8", "backslashreplace")


def _row(one: Entry) -> Markup:
    name = element("a", one.name, href=quote(one.page)) if one.page else one.name
    failed = element("b.bad", f", {one.failed} failed") if one.failed else None
    checks = (f"{one.passed} passed", failed) if one.passed or one.failed else "–"
    return element(
        "tr",
        element("th", name),
        element("td.bad" if one.status == "failed" else "td.good", one.status),
        element("td", checks),
        element("td.number", "–" if one.mass is None else mass_text(one.mass)),
        element("td.number", "–" if one.links is None else one.links),
        element("td.number", "–" if one.joints is None else one.joints),
        element("td.number", one.warnings),
        element("td", (element("div", message) for message in one.errors)),
        data_robot=one.name,
    )
