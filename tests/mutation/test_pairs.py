"""Files of robots drawn at random that differ in one number are never called equal."""

from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from tests.mutation.pairs import differences, other_numbers
from tests.random_robots import drawn_robot
from tests.simulators.conftest import write

FORMATS = ("urdf", "sdf", "mjcf")


def _missed(seed: int, folder: Path, count: int) -> list[str]:
    """The changed numbers of a robot's files that make no difference."""
    robot, missed = write(drawn_robot(Random(seed)), folder), []
    for written_in in FORMATS:
        path = robot.written[written_in].path
        for number, (what, content) in enumerate(other_numbers(path.read_bytes(), Random(seed), count)):
            other = path.with_name(f"other_{number}{path.suffix}")
            other.write_bytes(content)
            if not differences(path, other, written_in):
                missed.append(f"{written_in}: {what}")
    return missed


@pytest.mark.slow
@given(seed=st.integers(0, 2**32))
@settings(
    max_examples=1,
    deadline=None,
    phases=[Phase.generate],
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_another_number_is_another_robot(seed: int, tmp_path: Path) -> None:
    """Whichever number of a file is another one, the files differ; numbers below 1e-11 in poses aside."""
    assert not _missed(seed, tmp_path / str(seed), 3)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(16))
def test_any_other_number_is_another_robot(seed: int, tmp_path: Path) -> None:
    """The same, with forty numbers of each file."""
    assert not _missed(seed, tmp_path, 40)
