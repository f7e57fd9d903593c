"""Differences of two assemblies, or of two robots, as rows of a table."""

import re
from collections.abc import Iterable, Iterator, Sequence
from math import isfinite, isnan, nan, pi

from msgspec import Struct

from stepbot.engines.observation import Quantity
from stepbot.verification.compare import QuantityComparison
from stepbot.verification.deviation import Deviation

from .comparison import renamed_node
from .matching import Certainty, Match, Pair, match, pair_words
from .shapes import Motion, change, common_words, moved_words, shape_words, stuff_words
from .snapshot import Snapshot

_RENAMED = re.compile(r"(?:link|joint) '(.*)' is named '(.*)', paired by structure")
_SHOWN = {"rad": (180.0 / pi, "deg"), "rad/s": (180.0 / pi, "deg/s"), "m": (1e3, "mm"), "m/s": (1e3, "mm/s")}
_FOLLOWING = frozenset({Quantity.MASS_MATRIX, Quantity.GRAVITY, Quantity.INVERSE_DYNAMICS})
"""Quantities that differ as a consequence of others."""
_NO_DIFFERENCE = frozenset({Quantity.LOAD, Quantity.SIMULATION, Quantity.WARNINGS, Quantity.SELF_COLLISION})
"""Quantities of a single file or robot."""


class Difference(Struct, frozen=True):
    """One difference."""

    kind: str
    """``added``, ``removed``, ``renamed``, ``probably renamed``, ``moved``, ``reshaped``, ``material``; of robots the
    quantity."""
    name: str
    """The element that differs."""
    detail: str = ""
    """The difference."""
    new_name: str = ""
    """Its current name; empty if unchanged."""
    amount: float | None = None
    """Distance [m] of a motion, or deviation of a quantity in ``unit``; None without a finite number."""
    unit: str = ""
    angle: float | None = None
    """Rotation [rad]; None if there is none, or unknown."""
    old: float | None = None
    """The old value of a quantity in ``unit``; None if it is not one finite number."""
    new: float | None = None


def step_differences(old: Snapshot, new: Snapshot) -> tuple[Difference, ...]:
    """Differences of two assemblies, component by component, in the order of the files."""
    matched = match(old, new)
    rows = list(_common(matched))
    rows += _names(old, new, matched)
    for pair in matched.pairs:
        rows += _changes(old, new, pair)
    rows += [Difference("removed", old.parts[index].path) for index in matched.removed]
    rows += [Difference("added", new.parts[index].path) for index in matched.added]
    return tuple(rows)


def robot_differences(results: Sequence[QuantityComparison]) -> tuple[Difference, ...]:
    """Differences of two robots, quantity by quantity; consequences of other differences are left out."""
    compared = [result for result in results if not result.not_run and result.quantity not in _NO_DIFFERENCE]
    failed = [one for one in compared if one.deviations.failures]
    direct = [one for one in failed if one.quantity not in _FOLLOWING]
    return tuple(row for one in direct or failed for row in _of_robots(one.quantity, one.deviations.failures))


def not_compared(results: Sequence[QuantityComparison]) -> str:
    """The quantities of two robots that were not compared, by reason; empty if all were."""
    by_reason: dict[str, list[str]] = {}
    for result in results:
        if result.not_run and result.quantity not in _NO_DIFFERENCE:
            by_reason.setdefault(result.not_run, []).append(result.quantity.value)
    return "; ".join(f"{', '.join(quantities)} ({reason})" for reason, quantities in by_reason.items())


def _of_robots(quantity: Quantity, failures: Iterable[Deviation]) -> Iterator[Difference]:
    """Differences of one quantity; a distance and an angle at the same place are one difference."""
    by_place: dict[str, list[Deviation]] = {}
    for failure in failures:
        new = failure.where.replace(" is not in the robot", " is new")
        name = f"{failure.where}, formerly {failure.expected}" if failure.expected else new
        by_place.setdefault(name.removesuffix(" at configuration 1"), []).append(failure)
    for name, diagnostics in by_place.items():
        by_unit = {diagnostic.unit: diagnostic for diagnostic in diagnostics}
        renamed = _RENAMED.fullmatch(name)
        if renamed is not None:
            yield Difference("renamed", renamed[1], "paired by structure", new_name=renamed[2])
        elif (
            set(by_unit) == {"m", "rad"} and len(diagnostics) == 2 and all(isfinite(one.amount) for one in diagnostics)
        ):
            distance, angle = by_unit["m"].amount, by_unit["rad"].amount
            words = moved_words(Motion(distance, angle))
            yield Difference(quantity.value, name, words, amount=distance, unit="m", angle=angle)
        else:
            yield from (_of_robot(quantity, name, diagnostic) for diagnostic in diagnostics)


def _of_robot(quantity: Quantity, name: str, deviation: Deviation) -> Difference:
    if not deviation.unit:
        return Difference(quantity.value, name)
    unit = "" if deviation.unit == "SI" else deviation.unit
    amount = deviation.amount if isfinite(deviation.amount) else None
    old, new = deviation.values or (nan, nan)
    if isnan(old) or isnan(new):
        detail = "only one has it" if amount is None else f"differs by {_value(amount, unit)}"
        return Difference(quantity.value, name, detail, amount=amount, unit=unit)
    if amount is None:
        detail = f"{_value(old, unit)} -> {_value(new, unit)}"
        finite = (value if isfinite(value) else None for value in (old, new))
        return Difference(quantity.value, name, detail, "", None, unit, None, *finite)
    factor, shown = _SHOWN.get(unit, (1.0, unit))
    detail = change(old * factor, new * factor, shown)
    return Difference(quantity.value, name, detail, "", amount, unit, None, old, new)


def _value(number: float, unit: str) -> str:
    """A number in units that are usual to read."""
    factor, shown = _SHOWN.get(unit, (1.0, unit))
    return f"{number * factor:.4g} {shown}".rstrip() if isfinite(number) else "unlimited"


def _common(matched: Match) -> Iterator[Difference]:
    if matched.is_moved:
        distance, angle = matched.common.distance_to(type(matched.common)())
        yield Difference("moved", ".", common_words(matched.common), amount=distance, unit="m", angle=angle)


def _names(old: Snapshot, new: Snapshot, matched: Match) -> Iterator[Difference]:
    """Renamed components; a renamed subassembly is one of them."""
    groups: dict[tuple[str, str], list[Pair]] = {}
    for pair in matched.pairs:
        before, after = old.parts[pair.old].path, new.parts[pair.new].path
        if before != after:
            groups.setdefault(renamed_node(before, after), []).append(pair)
    for (before, after), pairs in groups.items():
        sure = all(pair.certainty is Certainty.CERTAIN for pair in pairs)
        parts = f", {len(pairs)} parts" if len(pairs) > 1 else ""
        likeness = (pair_words(old, new, pair) for pair in pairs if pair.certainty is Certainty.PROBABLE)
        detail = "same shape and pose" if sure else next(likeness)
        yield Difference("renamed" if sure else "probably renamed", before, detail + parts, new_name=after)


def _changes(old: Snapshot, new: Snapshot, pair: Pair) -> Iterator[Difference]:
    """The change of a component that is in both."""
    before, after = old.parts[pair.old], new.parts[pair.new]
    if pair.certainty is Certainty.PATH:
        moved = pair.motion
        if not moved.is_none:
            words = moved_words(moved)
            yield Difference("moved", after.path, words, amount=moved.distance, unit="m", angle=moved.angle)
        if not pair.is_same_shape:
            words = shape_words(old.shape_of(pair.old), new.shape_of(pair.new))
            yield Difference("reshaped", after.path, words)
    if stuff := stuff_words(before, after):
        yield Difference("material", after.path, stuff)
