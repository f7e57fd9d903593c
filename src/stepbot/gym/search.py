"""Augmented random search: a linear policy, trained with numpy alone.

Mania, Guy, Recht, "Simple random search of static linear policies is competitive for reinforcement learning" (2018),
version V2: each iteration tries random changes of the weights in both directions, and moves them towards the better.
Other than there, both directions of a change have the same episode, so that their difference is that of the policies;
steps are scaled by these differences, and all of them count: the best returns are those of the easiest episodes.
Observations are not shifted by their mean: an error of 0 stays 0.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from multiprocessing import get_context
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array

_LEAST_GAIN = 1e-9
"""Difference of returns that is numeric residue."""
_LEAST_SIZE = 1e-6
"""Root mean square of an observation that is always 0."""


@dataclass(frozen=True, eq=False)
class Policy:
    """Actions linear in some of the observed numbers, which are scaled to a mean square of 1."""

    inputs: NDArray[np.intp]
    """Indices (n,) of the numbers in the observation."""
    outputs: NDArray[np.bool_]
    """Which actions it decides (actions,); the others are 0."""
    weights: Array
    """(m, n), for its m actions."""
    scale: Array
    """(n,), root mean squares of the numbers."""

    def act(self, observation: Array) -> Array:
        """The action, between -1 and 1."""
        action: Array = np.zeros(self.outputs.size)
        action[self.outputs] = np.clip(self.weights @ (observation[self.inputs] / self.scale), -1.0, 1.0)
        return action


_Job = tuple[Policy, int]
"""A policy, and the seed of an episode."""


@dataclass(frozen=True)
class Settings:
    """How to search."""

    iterations: int = 100
    directions: int = 12
    """Changes tried in each iteration, each in both directions."""
    step: float = 0.05
    noise: float = 0.05
    """Standard deviation of a change of a weight."""
    seed: int = 0


@dataclass(frozen=True)
class Episode:
    """What came of an episode."""

    value: float
    """Sum of its rewards."""
    success: bool
    """``is_success`` of its last step."""


@dataclass(frozen=True, eq=False)
class _Seen:
    """Number of observations, and the sum of their squares."""

    count: int
    squares: Array

    def __add__(self, other: "_Seen") -> "_Seen":
        return _Seen(self.count + other.count, self.squares + other.squares)


_env: Any = None
"""The environment of a worker."""


def _open(make: Callable[[], Any]) -> None:
    """In a worker: make its environment."""
    global _env  # noqa: PLW0603
    _env = make()


def _episode_in_worker(job: _Job) -> tuple[Episode, _Seen]:
    return _episode(_env, job)


def _episode(env: Any, job: _Job) -> tuple[Episode, _Seen]:
    """Run an episode."""
    policy, seed = job
    observation, info = env.reset(seed=seed)
    seen, value, over = [observation[policy.inputs]], 0.0, False
    while not over:
        observation, reward, terminated, truncated, info = env.step(policy.act(observation))
        seen.append(observation[policy.inputs])
        value += reward
        over = terminated or truncated
    return Episode(value, bool(info["is_success"])), _Seen(len(seen), np.sum(np.square(seen), axis=0))


class Search:
    """Searches for a policy; use it in a ``with`` statement, which ends its processes."""

    def __init__(
        self,
        make: Callable[[], Any],
        settings: Settings,
        *,
        inputs: Sequence[str] = ("*",),
        outputs: Sequence[str] = ("*",),
        processes: int = 1,
    ) -> None:
        """Make the environment, and start processes if there are several.

        Args:
            make: Makes the environment; a picklable function.
            settings: How to search.
            inputs: The policy sees observations whose names match one of these patterns, such as ``tip/?``.
            outputs: It decides the actions whose names match one of these; the others are 0.
            processes: Number of processes; the results do not depend on it.

        Raises:
            ValueError: No name matches.
        """
        self._env = make()
        seen = _matching(self._env.unwrapped.observation_names, inputs)
        decided = _matching(self._env.unwrapped.action_names, outputs)
        self.settings = settings
        weights = np.zeros((int(decided.sum()), int(seen.sum())))
        self.policy = Policy(np.flatnonzero(seen), decided, weights, np.ones(weights.shape[1]))
        self._random = np.random.default_rng(settings.seed)
        self._seen = _Seen(0, np.zeros(weights.shape[1]))
        self._pool = get_context("spawn").Pool(processes, _open, (make,)) if processes > 1 else None

    def __enter__(self) -> "Search":
        return self

    def __exit__(self, *_: object) -> None:
        self._env.close()
        if self._pool is not None:
            self._pool.terminate()
            self._pool.join()

    def run(self) -> Iterator[float]:
        """Improve the policy; yields the mean sum of rewards of each iteration's changed policies."""
        for _ in range(self.settings.iterations):
            yield self._improve()

    def evaluate(self, policy: Policy, seeds: Sequence[int]) -> list[Episode]:
        """One episode of a policy with each seed."""
        return [episode for episode, _ in self._episodes([(policy, seed) for seed in seeds])]

    def _episodes(self, jobs: list[_Job]) -> list[tuple[Episode, _Seen]]:
        if self._pool is not None:
            return self._pool.map(_episode_in_worker, jobs)
        return [_episode(self._env, job) for job in jobs]

    def _improve(self) -> float:
        settings, weights = self.settings, self.policy.weights
        changes = self._random.standard_normal((settings.directions, *weights.shape))
        seeds = self._random.integers(2**31, size=settings.directions).tolist()
        jobs = [
            (replace(self.policy, weights=weights + sign * settings.noise * change), seed)
            for change, seed in zip(changes, seeds, strict=True)
            for sign in (1.0, -1.0)
        ]
        found = self._episodes(jobs)
        values = np.array([episode.value for episode, _ in found]).reshape(-1, 2)
        gains = values[:, 0] - values[:, 1]
        scale = max(float(np.sqrt(np.mean(gains**2))), _LEAST_GAIN)
        slope = np.tensordot(gains, changes, axes=1)
        for _, seen in found:
            self._seen = self._seen + seen
        size = np.sqrt(self._seen.squares / self._seen.count)
        self.policy = replace(
            self.policy,
            weights=weights + settings.step / (settings.directions * scale) * slope,
            scale=np.where(size > _LEAST_SIZE, size, np.inf),
        )
        return float(values.mean())


def _matching(names: Sequence[str], patterns: Sequence[str]) -> NDArray[np.bool_]:
    found = np.array([any(fnmatchcase(name, one) for one in patterns) for name in names])
    if not found.any():
        raise ValueError(f"nothing matches {' or '.join(patterns)}; there are {', '.join(names)}")
    return found
