"""Policy search: it finds a known policy and improves a reach; scores have correct intervals; the command works."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.unit.gym.models import ARM, written

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install stepbot[learn]")

import stepbot.gym  # noqa: E402
from stepbot.gym.__main__ import main  # noqa: E402
from stepbot.gym.search import Episode, Search, Settings  # noqa: E402
from stepbot.gym.training import PLANS, Score, draw, rise  # noqa: E402

BEST = np.array([[0.5, -0.3], [0.1, 0.4]])
"""Weights of the best policy of :class:`Known`."""


class Known:
    """An environment whose best policy is linear: the reward is the squared distance of an action from it, less 1."""

    observation_names = ("a", "b", "c")
    action_names = ("x", "y")

    def __init__(self) -> None:
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (2,))
        self.unwrapped = self

    def reset(self, *, seed: int) -> tuple[Any, dict[str, Any]]:
        """Begin an episode."""
        self.random, self.steps = np.random.default_rng(seed), 0
        self.seen = self.random.uniform(-1.0, 1.0, 3)
        return self.seen, {"is_success": False}

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Judge an action."""
        error = float(np.sum((action - BEST @ self.seen[[0, 2]]) ** 2))
        self.steps, self.seen = self.steps + 1, self.random.uniform(-1.0, 1.0, 3)
        return self.seen, -error, False, self.steps == 20, {"is_success": error < 0.01}

    def close(self) -> None:
        """Do nothing."""


def test_search_finds_the_best_policy() -> None:
    """The weights, freed from the scale of the observations, become those of the best policy."""
    with Search(Known, Settings(60, directions=8, step=0.02, noise=0.02), inputs=("a", "c")) as search:
        values = list(search.run())
        last = search.evaluate(search.policy, range(50))
    assert np.allclose(search.policy.weights / search.policy.scale, BEST, atol=0.05)
    assert np.allclose(search.policy.scale, 1 / np.sqrt(3), atol=0.02)
    assert sum(episode.success for episode in last) > 45
    assert values[-1] > 0.2 * values[0]  # they are negative


def test_seed_decides_the_search() -> None:
    """The same seed finds the same weights, another seed other ones."""
    found = []
    for seed in (0, 0, 1):
        with Search(Known, Settings(2, directions=4, seed=seed)) as search:
            list(search.run())
        found.append(search.policy.weights)
    assert np.array_equal(found[0], found[1])
    assert not np.array_equal(found[0], found[2])


def arm(path: Path) -> Any:
    """A short reach of the planar arm."""
    return stepbot.gym.make(path, observe="state", max_episode_steps=25, reset_noise=0.0, disable_env_checker=True)


def test_reach_rises(tmp_path: Path) -> None:
    """A few iterations raise the return of the planar arm by more than both confidence intervals."""
    make = partial(arm, written(tmp_path, ARM))
    with Search(make, Settings(8, directions=8, step=0.2, noise=0.2), inputs=("error/*",)) as search:
        before = Score(0, tuple(search.evaluate(search.policy, range(500, 520))))
        list(search.run())
        after = Score(8, tuple(search.evaluate(search.policy, range(500, 520))))
    assert after.value - after.margin > before.value + before.margin


@pytest.mark.long
def test_processes_do_not_change_the_result(tmp_path: Path) -> None:
    """Two processes find the weights that one finds."""
    make, found = partial(arm, written(tmp_path, ARM)), []
    for processes in (1, 2):
        with Search(make, Settings(2, directions=4), processes=processes) as search:
            list(search.run())
            found.append(search.policy.weights)
    assert np.array_equal(*found)


def test_scores_have_confidence_intervals() -> None:
    """The mean has 1.96 standard errors; a share has Wilson's interval, whose values are known."""
    score = Score(3, tuple(Episode(value, False) for value in (1.0, 2.0, 3.0, 6.0)))
    assert score.value == 3.0
    assert score.margin == pytest.approx(1.96 * np.sqrt(14 / 3) / 2)
    assert rise(score, Score(4, tuple(Episode(value, True) for value in (2.0, 4.0, 4.0, 8.0)))) == pytest.approx(
        (1.5, 1.96 * np.sqrt(1 / 3) / 2)
    )
    none = Score(0, (Episode(0.0, False),) * 10).success_range
    assert none == pytest.approx((0.0, 0.2775), abs=1e-4)
    some = Score(0, (Episode(0.0, True),) * 8 + (Episode(0.0, False),) * 2)
    assert some.success == 0.8
    assert some.success_range == pytest.approx((0.4902, 0.9433), abs=1e-4)
    assert str(some) == "iteration    0: return    0.0 +- 0.0, success  80% (49% to 94%)"


def test_curve_is_drawn_with_the_same_bytes(tmp_path: Path) -> None:
    """The same scores give the same SVG, with both axes named."""
    pytest.importorskip("matplotlib", reason="NO CURVE IS TESTED: pip install stepbot[learn]")
    scores = [Score(n, tuple(Episode(float(n + i), i % 3 < n) for i in range(9))) for n in range(3)]
    for name in ("a.svg", "b.svg"):
        draw(scores, "reach: arm", tmp_path / name)
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert text == (tmp_path / "b.svg").read_text(encoding="utf-8")
    assert "return of an episode" in text
    assert "episodes with success" in text


def test_command_trains_and_reports_errors(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`python -m stepbot.gym` prints the score before and after; a robot that cannot do the task is exit code 2."""
    path = str(written(tmp_path, ARM))
    short = ["--iterations", "1", "--processes", "1", "--option", "max_episode_steps=2"]
    assert main([path, *short]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "tip: site 'tool'"
    assert [line.partition(":")[0] for line in lines[1:]] == [
        "iteration    0",
        "iteration    1",
        "return of the same episodes",
    ]
    assert main([path, "--task", "stand", *short]) == 2
    assert "floating base" in capsys.readouterr().err
    assert main([path, *short, "--option", "colour=red"]) == 2
    assert "colour" in capsys.readouterr().err
    assert set(PLANS) == set(stepbot.gym.TASKS)


def test_missing_matplotlib_is_reported_before_training(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A curve that cannot be drawn is an error at once, not after minutes of training."""
    monkeypatch.setattr("stepbot.gym.__main__.find_spec", lambda _name: None)
    assert main([str(written(tmp_path, ARM)), "--plot", str(tmp_path / "curve.svg")]) == 2
    seen = capsys.readouterr()
    assert seen.out == ""
    assert "--plot needs matplotlib" in seen.err
