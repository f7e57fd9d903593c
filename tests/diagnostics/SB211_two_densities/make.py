"""A part with two densities."""

import re
from pathlib import Path

import pytest

from tests import parts
from tests.diagnostics.step_files import edited

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_box(STEP, density=7850.0)
    text = re.sub(r"\n\s*", "", STEP.read_text(encoding="utf-8"))
    definition = re.search(r"PROPERTY_DEFINITION\('material property','density',#(\d+)\)", text)
    unit = re.search(r"MEASURE_REPRESENTATION_ITEM\('density measure',POSITIVE_RATIO_MEASURE\(7.85\),(#\d+)\)", text)
    context = re.search(r"REPRESENTATION\('density',\(#\d+\),(#\d+)\)", text)
    assert definition
    assert unit
    assert context
    added = f"""\
    #9101=MEASURE_REPRESENTATION_ITEM('density measure',POSITIVE_RATIO_MEASURE(1.2),{unit[1]});
    #9102=REPRESENTATION('density',(#9101),{context[1]});
    #9103=PROPERTY_DEFINITION('material property','density',#{definition[1]});
    #9104=PROPERTY_DEFINITION_REPRESENTATION(#9103,#9102);
    """
    edited(STEP, added=added)
