"""The table for users: what a line shows, and where it goes."""

from msgspec.structs import replace

from benchmarks.users import PAGE, Line, page_with, row, table

LINE = Line("first conversion", "bare OCCT script", (2.1, 2.0, 2.4), (2.5,), (1.2, 1.1))


def test_a_line_has_the_median_and_the_spread() -> None:
    """Of several rounds; one round has no spread."""
    assert row(LINE) == "| first conversion | bare OCCT script | 2.10 (2.00–2.40) | 2.50 | 1.15 (1.10–1.20) |"
    assert row(replace(LINE, elapsed=())).endswith("| 2.50 |  |")


def test_the_table_replaces_the_one_of_the_page() -> None:
    """And nothing else, however often."""
    page = PAGE.read_text(encoding="utf-8")
    once = page_with(page, table([LINE], "two cores"))
    assert row(LINE) in once
    assert page_with(once, table([LINE], "two cores")) == once
    start = page.index("<!-- table -->")
    end = page.index("<!-- end -->", start)
    assert once.startswith(page[:start])
    assert once.endswith(page[end:])
