"""Rates of right joints by kind of evidence."""

import pytest

from benchmarks.calibration import Rates, kind_of, print_calibration
from benchmarks.drafts import Outcome


def test_kinds_are_the_words_without_names_and_numbers() -> None:
    """Evidence about other parts and sizes is of one kind."""
    one = kind_of("shaft of r 4 mm in a bore of r 4.05 mm, 12 mm engaged")
    assert one == kind_of("shaft of r 25 mm in a bore of r 25.1 mm, 3 mm engaged")
    assert kind_of("output of the motor 'a b'") == kind_of("output of the motor 'c/d:2'")


def test_rare_kinds_are_drawn_towards_the_mean() -> None:
    """Two joints of the mean rate are assumed: one wrong joint does not make a kind impossible."""
    rates = Rates([("often", True, True)] * 18 + [("once", False, True)])
    assert rates.of("often") == pytest.approx((18 + 2 * 19 / 21) / 20)
    assert rates.of("once") == pytest.approx((2 * 19 / 21) / 3)
    assert rates.of("never seen") == pytest.approx(19 / 21)


def test_what_is_predicted_was_fitted_without_it(capsys: pytest.CaptureFixture[str]) -> None:
    """An assembly whose evidence is wrong, and right everywhere else, is predicted to be right."""
    good, bad = Outcome(judged=[("line", True, True)] * 19), Outcome(judged=[("line", False, False)])
    print_calibration({"good": good, "bad": bad})
    shown = capsys.readouterr().out
    assert "predicted at 0.9 or more: 0 of 1 are right" in shown
    assert "wrong and without a mark: 1" in shown


def test_fused_parts_are_freed_by_what_the_other_assemblies_have(capsys: pytest.CaptureFixture[str]) -> None:
    """A kind that one assembly alone has is freed in none, nor is one that is a joint in half of the others."""
    one, two = Outcome(fused=[("a spigot", True), ("'x' alone", True)]), Outcome(fused=[("a spigot", True)])
    print_calibration({"one": one, "two": two, "three": Outcome(fused=[("a spigot", False)])})
    shown = capsys.readouterr().out
    assert "| a spigot | 2 of 3 | 3 |" in shown
    assert "| '...' alone | 1 of 1 | 1 |" in shown
    assert "joints where most of a kind are in the other assemblies: 0 right, 1 wrong" in shown
