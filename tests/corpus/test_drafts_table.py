"""benchmarks/DRAFTS.md: the tables of published assemblies are what `init` drafts."""

import re
from pathlib import Path

import pytest

from benchmarks.drafts import labelled, score_draft

PAGE = Path(__file__).parents[2] / "benchmarks" / "DRAFTS.md"
ROW = re.compile(r"^\| \[(\w+)\]\(\S+\): [^|]+\| (.*) \|$", re.MULTILINE)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "hex",
        "str_wrist",
        *(pytest.param(name, marks=pytest.mark.long) for name in ("pimouse", "reconcycle_arm", "shrey", "fcg")),
    ],
)
def test_the_row_of_an_assembly_is_its_score(name: str, corpus: Path) -> None:
    """After a change of a rule, `python -m benchmarks drafts --write` writes the tables again."""
    rows = dict(ROW.findall(PAGE.read_text(encoding="utf-8")))
    (outcome,) = (score_draft(label, step) for _, label, step in labelled(corpus) if label.stem == name)
    assert rows[name] == outcome.row()


def test_every_labelled_assembly_has_a_row(corpus: Path) -> None:
    """The tables leave none out."""
    assert set(dict(ROW.findall(PAGE.read_text(encoding="utf-8")))) == {label.stem for _, label, _ in labelled(corpus)}
