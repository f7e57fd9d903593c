"""The gate: bounds of a median, when rounds decide, and that it tells slower code from equal code."""

import os
import random
import subprocess
import sys
from pathlib import Path
from statistics import median

import pytest

from benchmarks import gate
from benchmarks.contenders import ROOT, STEPBOT, Case
from benchmarks.gate import LIMIT, ROUNDS, Job, Source, Verdict, alarm_rates, bounds, decided, verdict


@pytest.mark.parametrize(("count", "rank"), [(5, 1), (7, 1), (8, 2), (14, 4), (21, 7)])
def test_ranks_of_the_sign_test(count: int, rank: int) -> None:
    """The bounds of the median are the order statistics in tables of the one-sided sign test at 5 %."""
    values = [float(value) for value in range(1, count + 1)]
    assert bounds(values[::-1]) == (rank, count + 1 - rank)


def test_few_values_bound_nothing() -> None:
    """Four values cannot bound a median with 95 %: all four are above it once in sixteen times."""
    assert bounds([1.0, 1.0, 1.0, 1.0]) == (-float("inf"), float("inf"))


def test_bounds_hold_as_often_as_stated() -> None:
    """The lower bound is above the true median in at most 5 % of samples, of a skewed distribution, too."""
    draw = random.Random(1)
    for count in ROUNDS:
        missed = sum(bounds([draw.expovariate(1.0) for _ in range(count)])[0] > 0.6931471805599453 for _ in range(4000))
        assert missed / 4000 <= 0.06


def test_verdicts() -> None:
    """Bounds on one side of the limit decide, else the median does after the last round."""
    assert verdict([LIMIT + 0.01] * 7) is Verdict.FAILED
    assert verdict([LIMIT] * 7) is Verdict.PASSED
    assert verdict([LIMIT - 0.05] * 6 + [2.0]) is Verdict.OPEN
    assert verdict([LIMIT + 0.05] * 6 + [0.5]) is Verdict.OPEN
    many = [LIMIT + 0.05, LIMIT - 0.05] * 10 + [LIMIT + 0.05]
    assert verdict(many[:14]) is Verdict.OPEN
    assert verdict(many) is Verdict.FAILED
    assert verdict([2 * LIMIT - value for value in many]) is Verdict.PASSED


def test_one_disturbed_round_raises_no_alarm() -> None:
    """A round during which another program ran changes the number of rounds, not the result."""
    result, values = decided(lambda number: 3.0 if number == 2 else 1.0)
    assert (result, len(values), median(values)) == (Verdict.PASSED, 14, 1.0)


def test_rates_of_alarms() -> None:
    """With 5 % of noise, equal code hardly fails, 10 % more nearly always does, and 5 % about every second time."""
    draw = random.Random(2)
    rates = alarm_rates([draw.gauss(1.0, 0.05) for _ in range(200)], (1.0, 1.05, 1.1), trials=400)
    assert rates[1.0] < 0.01
    assert 0.2 < rates[1.05] < 0.8
    assert rates[1.1] > 0.95


@pytest.mark.slow
@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="there is no earlier revision without git")
def test_earlier_source_reports_diagnostics(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An earlier revision has what its own diagnostics need: robots with findings are compared, too."""
    monkeypatch.setattr(gate.compileall, "compile_dir", lambda *_, **__: True)  # of 90,000 lines
    source = gate.source_of("HEAD", tmp_path)
    environment = source.environment(Case("case", tmp_path, tmp_path, tmp_path))
    (tmp_path / "robot.yaml").write_text("version: 1", encoding="utf-8")
    command = [*STEPBOT, "check", "robot.yaml"]
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 1, run.stderr
    assert "error[SB121]" in run.stdout, run.stderr


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "wait4"), reason="times of process trees are taken where there is wait4")
@pytest.mark.parametrize(("seconds", "expected"), [(0.05, Verdict.PASSED), (0.1, Verdict.FAILED)])
def test_slower_source_fails(
    seconds: float, expected: Verdict, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A source that needs more processor time fails; the same one passes."""
    sources = []
    for name, needed in (("ours", seconds), ("theirs", 0.05)):
        (tmp_path / name / "src").mkdir(parents=True)
        work = f"import time\nwhile time.process_time() < {needed}: pass\n"
        (tmp_path / name / "src" / "work_of_gate.py").write_text(work, encoding="utf-8")
        sources.append(Source(name, tmp_path / name))
    monkeypatch.setattr(gate, "STEPBOT", (sys.executable, "-m"))
    monkeypatch.setattr(gate, "LIMIT", 1.3)  # of a tenth of a second, on a busy machine
    case = Case("case", tmp_path, tmp_path, tmp_path)
    run = gate.ratios(Job("work", ("work_of_gate",)), sources[0], sources[1], (case, case))
    assert decided(run)[0] is expected
