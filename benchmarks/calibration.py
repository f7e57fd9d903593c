"""How often joints of each kind of evidence are right, in labelled assemblies, and what that says about others.

Evidence is counted by kind, with rare kinds drawn towards the mean of all (two assumed joints each). Leave-one-out fits
all assemblies but one and predicts that one: the predicted number of right joints should be the true one, and what is
predicted to be right nine times in ten should be.

Parts that look movable and were fused are counted by what holds them: which of them are joints in the labels, and what
would come of drafting those as joints that more often are than not in the other assemblies.
"""

import re
from collections import Counter
from collections.abc import Iterable, Mapping

from .drafts import Outcome

_ASSUMED = 2.0
"""Number of joints of the mean rate that each kind is assumed to have had."""
_SURE = 0.9
"""Fitted rate from which joints of a kind are expected to be right nine times in ten."""


def kind_of(evidence: str) -> str:
    """The words of evidence without names and numbers."""
    return re.sub(r"-?\d+(?:\.\d+)?", "#", re.sub(r"'.*?'", "'...'", evidence))


class Rates:
    """Fitted rates of right joints, by kind of evidence."""

    def __init__(self, judged: Iterable[tuple[str, bool, bool]]) -> None:
        self.drafted: Counter[str] = Counter()
        self.right: Counter[str] = Counter()
        for evidence, is_right, _ in judged:
            self.drafted[kind_of(evidence)] += 1
            self.right[kind_of(evidence)] += is_right
        self._mean = (self.right.total() + 1.0) / (self.drafted.total() + 2.0)

    def of(self, evidence: str) -> float:
        """The rate of a kind of evidence; the mean of all for one that was not seen."""
        kind = kind_of(evidence)
        return (self.right[kind] + _ASSUMED * self._mean) / (self.drafted[kind] + _ASSUMED)


def print_calibration(outcomes: Mapping[str, Outcome]) -> None:
    """Print the rate of each kind of evidence, then what leave-one-out predicts, from drafts of assemblies by name."""
    every = [row for outcome in outcomes.values() for row in outcome.judged]
    rates = Rates(every)
    print("\n| evidence | right | fitted |\n| --- | --- | --- |")
    for kind, drafted in sorted(rates.drafted.items(), key=lambda item: (-item[1], item[0])):
        print(f"| {kind} | {rates.right[kind]} of {drafted} | {rates.of(kind):.2f} |")
    expected, sure = 0.0, Counter[bool]()
    unmarked = 0
    for name in outcomes:
        others = Rates(row for other, outcome in outcomes.items() if other != name for row in outcome.judged)
        for evidence, is_right, is_marked in outcomes[name].judged:
            rate = others.of(evidence)
            expected += rate
            if rate >= _SURE:
                sure[is_right] += 1
            unmarked += not is_right and not is_marked
    right = sum(is_right for _, is_right, _ in every)
    print(f"\nleave one assembly out: {expected:.1f} of {len(every)} joints predicted to be right, {right} are")
    print(f"predicted at {_SURE} or more: {sure[True]} of {sure.total()} are right")
    print(f"wrong and without a mark: {unmarked}")
    _print_fused(outcomes)


def _print_fused(outcomes: Mapping[str, Outcome]) -> None:
    """Print how many fused parts are joints in the labels, by what holds them, and what drafting them would give."""
    fused = {name: [(kind_of(held), is_joint) for held, is_joint in o.fused] for name, o in outcomes.items()}
    every = [row for rows in fused.values() for row in rows]
    print("\n| fused, held by | joints in the labels | assemblies |\n| --- | --- | --- |")
    for kind, count in sorted(Counter(kind for kind, _ in every).items(), key=lambda item: (-item[1], item[0])):
        within = sum(any(kind == other for other, _ in rows) for rows in fused.values())
        print(f"| {kind} | {every.count((kind, True))} of {count} | {within} |")
    freed = Counter[bool]()
    for name, rows in fused.items():
        others = [row for other, some in fused.items() if other != name for row in some]
        rates = {kind: (others.count((kind, True)), others.count((kind, False))) for kind, _ in rows}
        freed.update(is_joint for kind, is_joint in rows if rates[kind][0] > rates[kind][1])
    print(f"\njoints where most of a kind are in the other assemblies: {freed[True]} right, {freed[False]} wrong")
