"""Runs contenders alternately, round by round, on the same case: ratios of runs under the same conditions."""

from collections.abc import Sequence
from statistics import median, quantiles

from msgspec import Struct

from .contenders import Case, Contender
from .timing import Cost, peak_memory, timed

Quartiles = tuple[float, float]
"""The first and the third."""


class Row(Struct, frozen=True):
    """The result of one contender, relative to the first of its comparison."""

    contender: str
    wall: float
    """Median [s]."""
    cpu: float
    """Median [s]."""
    wall_ratio: float
    """Median of the ratios to the first one in the same round."""
    cpu_ratio: float
    memory: float | None = None
    """Peak [MiB]; None if not measured."""
    wall_quartiles: Quartiles | None = None
    """Of the ratios; None from a single round."""
    cpu_quartiles: Quartiles | None = None


def compare(
    case: Case, contenders: Sequence[Contender], rounds: int, *, warm_up: bool = True, memory: bool = False
) -> list[Row]:
    """Time contenders against the first of them.

    Args:
        case: The input.
        contenders: The contenders; each runs once per round, in this order.
        rounds: Number of rounds.
        warm_up: Whether to run an uncounted round first.
        memory: Whether to run each once more to measure its memory, which takes additional time.
    """
    costs = alternate(case, contenders, rounds, warm_up=warm_up)
    first = costs[contenders[0].name]
    rows = []
    for contender in contenders:
        own = costs[contender.name]
        walls = [cost.wall / other.wall for cost, other in zip(own, first, strict=True)]
        cpus = [cost.cpu / other.cpu for cost, other in zip(own, first, strict=True)]
        rows.append(
            Row(
                contender.name,
                median(cost.wall for cost in own),
                median(cost.cpu for cost in own),
                median(walls),
                median(cpus),
                _memory(contender, case) if memory else None,
                quartiles(walls),
                quartiles(cpus),
            )
        )
    return rows


def alternate(
    case: Case, contenders: Sequence[Contender], rounds: int, *, warm_up: bool = True
) -> dict[str, list[Cost]]:
    """The cost of each run of contenders in turn, by their names.

    Args:
        case: The input.
        contenders: The contenders; each runs once per round, in this order.
        rounds: Number of rounds.
        warm_up: Whether to run an uncounted round first.
    """
    for contender in contenders:
        contender.before_all(case)
    costs: dict[str, list[Cost]] = {contender.name: [] for contender in contenders}
    for number in range(-1 if warm_up else 0, rounds):
        for contender in contenders:
            cost = _run(contender, case)
            if number >= 0:
                costs[contender.name].append(cost)
    return costs


def quartiles(values: Sequence[float]) -> Quartiles | None:
    """First and third quartile, interpolated between values; None for fewer than two."""
    if len(values) < 2:
        return None
    first, _, third = quantiles(values, n=4, method="inclusive")
    return first, third


def _run(contender: Contender, case: Case) -> Cost:
    contender.before_each(case)
    return timed(contender.command(case), case.folder, {**case.environment, **contender.environment})


def _memory(contender: Contender, case: Case) -> float:
    contender.before_each(case)
    return peak_memory(contender.command(case), case.folder, {**case.environment, **contender.environment})
