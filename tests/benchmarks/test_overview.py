"""Tables and picture of results over several files."""

import pytest

from benchmarks.comparison import Row, quartiles
from benchmarks.overview import picture, tables

FIRST = Row("bare OCCT script", 2.0, 1.9, 1.0, 1.0, 200.0, (1.0, 1.0), (1.0, 1.0))
RESULTS = {
    "arm": [
        FIRST,
        Row("stepbot, cold", 2.2, 3.0, 1.1, 1.5, 300.0, (1.05, 1.2), (1.4, 1.6)),
        Row("peer", 1, 1, 0.5, 0.5),
    ],
    "leg": [Row("bare OCCT script", 4.0, 3.9, 1.0, 1.0), Row("stepbot, cold", 3.6, 6.0, 0.9, 1.6)],
}


def test_quartiles_of_rounds() -> None:
    """Quartiles are interpolated within the values; a single round has none."""
    assert quartiles([3.0, 1.0, 2.0, 4.0, 5.0]) == (2.0, 4.0)
    assert quartiles([1.0, 2.0]) == (1.25, 1.75)
    assert quartiles([1.0]) is None


def test_table_of_files() -> None:
    """A row per file with its ratios and their quartiles; the last row has the median of the files."""
    lines = tables(RESULTS).splitlines()
    assert lines[:3] == ["Elapsed time:", "", "| | bare OCCT script | stepbot, cold | peer |"]
    assert lines[4:7] == [
        "| `arm` | 2.00 s | 1.10 (1.05–1.20) | 0.50 |",
        "| `leg` | 4.00 s | 0.90 | - |",
        "| **median** | | **1.00** | - |",
    ]
    assert "| `arm` | 1.90 s | 1.50 | 0.50 |" in lines
    assert "| `arm` | 200 MiB | 1.50 | - |" in lines


def test_no_table_of_what_was_not_measured() -> None:
    """Without measured memory there is no table of it, and no median of a single file."""
    text = tables({"leg": RESULTS["leg"]})
    assert "Peak memory" not in text
    assert "median" not in text


def test_picture_names_files_and_contenders() -> None:
    """The picture has the name of each file and of each contender, and the same bytes each time."""
    pytest.importorskip("matplotlib", reason="NO PICTURE IS TESTED: pip install stepbot[draw]")
    drawn = picture(RESULTS)
    for name in ("arm", "leg", "stepbot, cold", "peer", "that of the bare OCCT script"):
        assert name.encode() in drawn
    assert drawn == picture(RESULTS)
