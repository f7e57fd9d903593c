"""Parameters of statements of a STEP file's text."""

import pytest

from stepbot.step.exchange.part21_values import DERIVED, Record, Reference, SyntaxFault, Word, records


def test_all_kinds_of_parameters() -> None:
    """Texts, numbers, references, words, lists, typed parameters, omitted and derived values are parsed."""
    body = b"A_1('it''s; #9 (',-1.5E-3,2.,7,#12,.T.,.UNSPECIFIED.,$,*,(1.,(#2)),LENGTH_MEASURE(3.),()) /* c */"
    (record,) = records(body)
    assert record.keyword == "A_1"
    assert record.parameters == (
        b"it''s; #9 (", -1.5e-3, 2.0, 7.0, Reference(12), Word("T"), Word("UNSPECIFIED"), None, DERIVED,
        (1.0, (Reference(2),)), Record("LENGTH_MEASURE", (3.0,)), (),
    )  # fmt: skip


def test_complex_instances_have_several_records() -> None:
    """The parts of a complex instance are in file order."""
    assert records(b" ( A(1.) B() C(#3)\n) ") == (
        Record("A", (1.0,)), Record("B", ()), Record("C", (Reference(3),))
    )  # fmt: skip


@pytest.mark.parametrize(
    "body",
    [b"", b"A", b"A(", b"A(1.", b"A(1. 2.)", b"A(1.,)", b"(A(1.)", b"A(1.)B(2.)", b"A(?)", b"A(B)", b"1.", b"A('x)",
     b"A(" + 100 * b"(" + 100 * b")" + b")"],
)  # fmt: skip
def test_what_breaks_the_grammar_is_a_fault(body: bytes) -> None:
    """Truncated or deeply nested text raises one kind of error."""
    with pytest.raises(SyntaxFault):
        records(body)
