"""Numbers as text, against Python's own exact decimals."""

from decimal import Decimal

import numpy as np
import pytest

from stepbot.geometry.fixed_point import fixed_point_lines


def written(number: int, decimals: int) -> str:
    """An exact decimal without trailing zeros, by Python."""
    return f"{Decimal(number).scaleb(-decimals).normalize() + 0:f}"


@pytest.mark.parametrize("decimals", [0, 1, 9])
@pytest.mark.parametrize("largest", [1, 9, 10, 1_000, 10**9, 10**15, 2**62])
def test_as_exact_decimals(largest: int, decimals: int) -> None:
    """All signs, numbers of digits, and leading and trailing zeros are written exactly."""
    random = np.random.default_rng(largest)
    rows = random.integers(-largest, largest, (200, 3), endpoint=True)
    rows[:50] //= 10 ** random.integers(0, 19, (50, 3))
    rows[50:100] -= rows[50:100] % 1_000
    rows[0] = 0, largest, -largest
    lines = fixed_point_lines("v", rows, decimals).decode().splitlines()
    assert lines == ["v " + " ".join(written(number, decimals) for number in row) for row in rows.tolist()]


def test_every_power_of_ten() -> None:
    """Each power of ten is written exactly, alone in its array."""
    for power in range(19):
        for sign in (1, -1):
            line = fixed_point_lines("f", np.array([[sign * 10**power]]), 9)
            assert line == f"f {written(sign * 10**power, 9)}\n".encode()


def test_no_rows() -> None:
    """No rows give no lines."""
    assert fixed_point_lines("v", np.empty((0, 3), np.int64), 9) == b""
