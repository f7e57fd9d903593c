"""Files of robots drawn at random that differ in one number are never called equal."""

from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from tests.mutation.extras import with_extras
from tests.mutation.pairs import differences, in_other_words, other_numbers
from tests.random_robots import drawn_robot, widened
from tests.simulators.conftest import write

FORMATS = ("urdf", "sdf", "mjcf")


def _missed(seed: int, folder: Path, count: int, *, field: bool = False) -> list[str]:
    """The changed numbers of a robot's files that make no difference.

    With ``field``, the files also have what stepbot never writes; each other file has longer axes, too, and without a
    changed number it is no other robot.
    """
    drawn = drawn_robot(Random(seed))
    robot, missed = write(widened(Random(f"{seed} wide"), drawn) if field else drawn, folder), []
    for written_in in FORMATS:
        path = robot.written[written_in].path
        random, content = Random(f"{seed} {written_in}"), path.read_bytes()
        if field:
            content = with_extras(written_in, content, random)
            path.write_bytes(content)
            twin = path.with_name(f"twin{path.suffix}")
            twin.write_bytes(in_other_words(content))
            missed += [f"{written_in}: not the same: {one}" for one in [differences(path, twin, written_in)] if one]
        for number, (what, other) in enumerate(other_numbers(content, random, count)):
            beside = path.with_name(f"other_{number}{path.suffix}")
            beside.write_bytes(in_other_words(other) if field and number % 2 else other)
            if not differences(path, beside, written_in, by_diff=bool(number % 3)):
                missed.append(f"{written_in}: {what}")
    return missed


@pytest.mark.slow
@given(seed=st.integers(0, 2**32))
@settings(
    max_examples=1, deadline=None, phases=[Phase.generate], suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_another_number_is_another_robot(seed: int, tmp_path: Path) -> None:
    """Whichever number of a file is another one, the files differ; numbers below 1e-11 in poses aside."""
    assert not _missed(seed, tmp_path / str(seed), 3)


@pytest.mark.slow
def test_another_number_of_the_field_is_another_robot(tmp_path: Path) -> None:
    """So in files with contacts, solvers, plugins and drives that stepbot never writes, and with longer axes."""
    assert not _missed(7, tmp_path, 4, field=True)


@pytest.mark.long
@pytest.mark.parametrize("field", [False, True])
@pytest.mark.parametrize("seed", range(16))
def test_any_other_number_is_another_robot(seed: int, *, field: bool, tmp_path: Path) -> None:
    """The same, with forty numbers of each file."""
    assert not _missed(seed, tmp_path, 40, field=field)
