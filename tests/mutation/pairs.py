"""Two files of one format that differ in one number, as ``stepbot diff`` and ``stepbot verify`` see them."""

from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from random import Random

from lxml import etree
from msgspec.structs import replace

from stepbot.engines import Engine, engines_for
from stepbot.engines.description.statements import statements
from stepbot.engines.observation import EngineCannotRead, Observation, Request
from stepbot.engines.workers import Fate, Outcome
from stepbot.verification.files import ask
from stepbot.verification.judging import _compared_across, ranked
from stepbot.verification.merged_observation import Gathered, gather
from stepbot.verification.probe import Probe

from .changes import slots_of

_FAR = 0.02
"""Change of a number, relative to it; absolute for 0."""
_LEAST = 1e-11
"""Smallest change: files round lengths and angles to 1e-12."""
_DIRECTIONS = ("axis@xyz", "axis/xyz", "@axis", "@quat")
"""Numbers of which only the direction has a meaning: one that is alone may be any."""


def other_numbers(content: bytes, random: Random, count: int) -> Iterator[tuple[str, bytes]]:
    """Copies of a file with one number changed, and which; what only lengthens an axis is the same robot."""
    every = [(slot, index) for slot in slots_of(content) for index in range(len(slot.words))]
    for slot, index in random.sample(every, min(count, len(every))):
        old = float(slot.words[index])
        new = repr(old * (1.0 + _FAR)) if old else repr(_FAR)
        if slot.is_whole:
            new = str(int(old) + 1)
        words = (*slot.words[:index], new, *slot.words[index + 1 :])
        longer = slot.path.endswith(_DIRECTIONS) and old and all(float(one) == 0.0 for one in {*words} - {new})
        if abs(float(new) - old) < _LEAST or longer:
            continue
        top = etree.fromstring(content)
        element = [one for one in top.iter() if isinstance(one.tag, str)][slot.element]
        if slot.attribute:
            element.set(slot.attribute, " ".join(words))
        else:
            element.text = " ".join(words)
        yield f"{slot.path}[{index}]: {slot.words[index]} -> {new}", etree.tostring(top)


def in_other_words(content: bytes) -> bytes:
    """The same robot with longer axes and quaternions, of which the direction alone has a meaning."""
    top = etree.fromstring(content)
    for element in top.iter("axis", "joint", "body", "geom"):
        for name, factor in (("xyz", 2.5), ("axis", 2.5), ("quat", -2.0)):
            if text := element.get(name):
                element.set(name, _scaled(text, factor))
    for element in top.iter("xyz"):
        element.text = _scaled(element.text, 2.5)
    return bytes(etree.tostring(top))


def _scaled(text: str, factor: float) -> str:
    return " ".join(repr(factor * float(word)) for word in text.split())


def differences(first: Path, other: Path, written_in: str, *, by_diff: bool = True) -> str:
    """What differs between two files; empty if they are called equal, ``refused`` if an engine rejects the first.

    Args:
        first: The first file.
        other: The other file.
        written_in: The format of both.
        by_diff: Whether ``diff`` compares them; else ``verify``, which takes no words for another robot.
    """

    def observe(engine: Engine, request: Request) -> Observation | None:
        try:
            with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                return engine.observer.observe(request)
        except Exception:  # noqa: BLE001 - in verify, too, an engine that fails is tried again later
            return None

    formats = {first: written_in, other: written_in}
    places, probe = {path: path for path in formats}, Probe(observe)
    asked = ask(formats, places, probe, probe.files(formats, places), count=1, seconds=0.0)
    said = {path.as_posix(): statements(path, written_in) for path in formats}
    asked = replace(asked, texts=said)
    ours, theirs = (_seen(path, written_in, asked.requests[path.as_posix()]) for path in formats)
    if ours is None:
        return "refused"
    if theirs is None:
        return "an engine rejects the other file"
    results = _compared_across(ours, theirs, asked, first=True, whole=by_diff)
    failed = [one for one in results if one.deviations.failures and not one.not_run]
    return "; ".join(f"{one.quantity.value}: {one.deviations.failures[0]}" for one in failed)


def _seen(path: Path, written_in: str, request: Request) -> Gathered | None:
    """The file as all engines see it; None if one rejects it."""
    outcomes = []
    for engine in (one for one in engines_for(written_in) if one.available() is None):
        try:
            with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                seen = engine.observer.observe(request)
        except EngineCannotRead:
            continue
        except Exception:  # noqa: BLE001 - in verify and diff, too, an engine that fails is a finding
            return None
        outcomes.append(Outcome(path.as_posix(), written_in, engine.name, Fate.OBSERVED, seen))
    return gather(ranked(outcomes))
