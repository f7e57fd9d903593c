"""A box in inches of 25 mm."""

from pathlib import Path

import pytest

from tests import parts
from tests.diagnostics.step_files import edited

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    added = """\
    #9004=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
    #9005=( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.) );
    #9006=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.025),#9005);
    """
    millimetre = r"\( LENGTH_UNIT\(\) NAMED_UNIT\(\*\) SI_UNIT\(\.MILLI\.,\.METRE\.\) \)"
    inch = "( CONVERSION_BASED_UNIT('INCH',#9006) LENGTH_UNIT() NAMED_UNIT(#9004) )"
    parts.write_box(STEP)
    edited(STEP, (millimetre, inch), added=added)
