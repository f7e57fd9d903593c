"""Indented JSON, against the json module."""

import json
from fractions import Fraction
from math import inf
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.report.document import indented

LEAVES = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()
DOCUMENTS: st.SearchStrategy[Any] = st.recursive(
    LEAVES, lambda below: st.lists(below) | st.lists(below).map(tuple) | st.dictionaries(st.text(), below)
)


@pytest.mark.slow
@given(DOCUMENTS)
def test_text_is_that_of_json(document: Any) -> None:
    """Any document is written as json.dumps writes it."""
    assert indented(document) == json.dumps(document, indent=2, ensure_ascii=False)


def test_other_objects() -> None:
    """Other objects are written as the JSON data that replaces them; without a replacement they are an error."""
    document = {"a": [Fraction(1, 2)]}
    assert indented(document, lambda value: {"of": str(value)}) == json.dumps({"a": [{"of": "1/2"}]}, indent=2)
    with pytest.raises(TypeError, match="Fraction cannot be written as JSON"):
        indented(document)


def test_infinite_numbers() -> None:
    """JSON has no infinity."""
    with pytest.raises(ValueError, match="not JSON compliant"):
        indented([inf])
