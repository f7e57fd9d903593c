"""Training runs: their settings, what they measure before and after, and the picture of their curve."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from math import sqrt
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from . import make as make_environment
from .search import Episode, Search, Settings

TEST_SEEDS = range(2_000_000, 2_000_100)
"""Seeds of the episodes with which policies are compared; neither training nor the choice of the settings saw them."""
_SIGMAS = 1.96
"""Standard deviations on either side of the mean in a confidence interval of 95 %."""
_STYLE = {"svg.hashsalt": "stepbot", "svg.fonttype": "none", "font.size": 8, "axes.spines.top": False}
_SIZE = (6.4, 2.8)


@dataclass(frozen=True)
class Plan:
    """How a task is trained."""

    task: str
    inputs: tuple[str, ...]
    """Patterns of the names of observations that the policy sees."""
    settings: Settings
    outputs: tuple[str, ...] = ("*",)
    """Patterns of the names of actions that it decides; the others are 0."""
    options: Mapping[str, Any] = field(default_factory=dict)
    """Arguments of the environment."""
    evaluate_every: int = 10
    """Iterations between evaluations."""


PLANS = {
    "reach": Plan(
        "reach",
        ("error/*",),
        Settings(20, step=0.1, noise=0.1),
        options={"observe": "state", "max_episode_steps": 50},
        evaluate_every=2,
    ),
    "stand": Plan(
        "stand",
        ("*/qw", "*/[vw][xy]"),
        Settings(20, directions=24, step=0.1, noise=0.1),
        options={"observe": "state", "max_episode_steps": 75, "push": 2.0, "push_interval": 10.0},
        evaluate_every=5,
    ),
}
"""What ``python -m stepbot.gym`` does for each task."""


@dataclass(frozen=True)
class Score:
    """Results of the test episodes after some iterations."""

    iteration: int
    episodes: tuple[Episode, ...]

    @property
    def value(self) -> float:
        """Mean sum of rewards."""
        return float(np.mean([episode.value for episode in self.episodes]))

    @property
    def margin(self) -> float:
        """Half width of the confidence interval of 95 % of the mean."""
        values = [episode.value for episode in self.episodes]
        return _SIGMAS * float(np.std(values, ddof=1)) / sqrt(len(values))

    @property
    def success(self) -> float:
        """Share of episodes that end with success."""
        return float(np.mean([episode.success for episode in self.episodes]))

    @property
    def success_range(self) -> tuple[float, float]:
        """Confidence interval of 95 % of the share: Wilson's, which is valid near 0 and 1."""
        n, share, z = len(self.episodes), self.success, _SIGMAS
        middle = (share + z * z / (2 * n)) / (1 + z * z / n)
        half = z / (1 + z * z / n) * sqrt(share * (1 - share) / n + z * z / (4 * n * n))
        return middle - half, middle + half

    def __str__(self) -> str:
        low, high = self.success_range
        return (
            f"iteration {self.iteration:4d}: return {self.value:6.1f} +- {self.margin:.1f}, "
            f"success {self.success:4.0%} ({low:.0%} to {high:.0%})"
        )


def rise(before: Score, after: Score) -> tuple[float, float]:
    """Mean rise of the return over the same episodes, and half width of its confidence interval of 95 %."""
    values = [one.value - other.value for one, other in zip(after.episodes, before.episodes, strict=True)]
    return float(np.mean(values)), _SIGMAS * float(np.std(values, ddof=1)) / sqrt(len(values))


def train(model: str | PathLike[str], plan: Plan, *, processes: int = 1, test: range = TEST_SEEDS) -> Iterator[Score]:
    """Train a policy; yields its score before, after every ``plan.evaluate_every`` iterations, and at the end.

    The scores do not depend on the number of processes.

    Raises:
        ValueError: The robot cannot do the task.
    """
    make = partial(make_environment, str(model), plan.task, disable_env_checker=True, **plan.options)
    with Search(make, plan.settings, inputs=plan.inputs, outputs=plan.outputs, processes=processes) as search:
        yield Score(0, tuple(search.evaluate(search.policy, test)))
        for done, _ in enumerate(search.run(), start=1):
            if done % plan.evaluate_every == 0 or done == plan.settings.iterations:
                yield Score(done, tuple(search.evaluate(search.policy, test)))


def draw(scores: list[Score], title: str, path: Path) -> None:
    """Draw the curve: the same bytes from the same scores; the suffix of the path decides the kind of picture.

    Raises:
        OSError: The file cannot be written.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=_SIZE, layout="constrained")
        returns, shares = figure.subplots(1, 2)
        x = [score.iteration for score in scores]
        values, margins = np.array([(score.value, score.margin) for score in scores]).T
        returns.plot(x, values, color="#1f6feb", marker="o", markersize=3)
        returns.fill_between(x, values - margins, values + margins, color="#1f6feb", alpha=0.2, linewidth=0)
        returns.set_ylabel("return of an episode")
        low, high = np.array([score.success_range for score in scores]).T * 100
        shares.plot(x, [100 * score.success for score in scores], color="#2c8c4b", marker="o", markersize=3)
        shares.fill_between(x, low, high, color="#2c8c4b", alpha=0.2, linewidth=0)
        shares.set_ylabel("episodes with success [%]")
        shares.set_ylim(0, 100)
        for axes in (returns, shares):
            axes.set_xlabel("iteration")
            axes.grid(True, linewidth=0.4, color="#dde3ea")
        figure.suptitle(title, fontsize=9)
        path.parent.mkdir(parents=True, exist_ok=True)
        metadata = {"Date": None, "Creator": None} if path.suffix == ".svg" else None
        figure.savefig(path, metadata=metadata)


def shortened(plan: Plan, iterations: int | None, seed: int) -> Plan:
    """A plan with another number of iterations, if one is given, and a seed."""
    settings = replace(plan.settings, seed=seed)
    return replace(plan, settings=settings if iterations is None else replace(settings, iterations=iterations))
