"""The box of a part against that of the motor that it is said to be."""

import numpy as np
import pytest

from stepbot.assemble.motor_parts import is_like

MOTOR = np.array([0.0248, 0.0396, 0.0454])


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ((0.0, 0.0, 0.0), True),
        ((0.0, 0.0, 0.0045), True),  # 4.5 mm, a horn, is less than a fifth
        ((0.0039, 0.0, 0.0), True),
        ((0.006, 0.0, 0.0), False),  # more than 4 mm, and more than a fifth
        ((0.0, -0.009, 0.0), False),
        ((0.0, 0.0, 0.01), False),
    ],
)
def test_a_box_is_like_that_of_a_motor_within_a_fifth_or_four_millimetres(
    more: tuple[float, float, float], expected: bool
) -> None:
    """Every edge counts, in both directions."""
    assert is_like(MOTOR + np.array(more), MOTOR) is expected
