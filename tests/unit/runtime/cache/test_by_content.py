"""Results of computations that are requested together."""

from pathlib import Path

import pytest

from stepbot.runtime.cache import Cache
from stepbot.runtime.cache.by_content import ResultsByContent


def results(cache: Cache | None, **wanted: tuple[int, ...]) -> ResultsByContent[str, tuple[int, ...], float]:
    """Tuples to be turned into numbers."""
    return ResultsByContent(cache, "a test", wanted, (tuple[int, ...], float))


def test_equal_inputs_are_one_computation() -> None:
    """Equal inputs are computed once, without a cache too, and each name gets its result."""
    legs = results(None, left=(1, 2), body=(3,), right=(1, 2))
    assert legs.missing == ((1, 2), (3,))
    assert legs.get("left") is None
    legs.add([0.5, 7.0])
    assert (legs["left"], legs["body"], legs["right"]) == (0.5, 7.0, 0.5)
    assert legs.missing == ()
    assert legs.get("tail") is None


def test_known_results_come_from_the_cache(tmp_path: Path) -> None:
    """Of a second request only new inputs are missing; another computation has none of the results."""
    cache = Cache(tmp_path)
    results(cache, left=(1, 2)).add([0.5])
    again = results(cache, other=(1, 2), body=(3,))
    assert again.missing == ((3,),)
    assert again["other"] == 0.5
    assert ResultsByContent(cache, "another test", {"left": (1, 2)}, (tuple[int, ...], float)).missing == ((1, 2),)


def test_results_belong_to_the_missing_inputs() -> None:
    """A list of results of another length is rejected."""
    with pytest.raises(ValueError, match="shorter"):
        results(None, left=(1, 2), body=(3,)).add([0.5])
