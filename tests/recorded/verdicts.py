"""What `verify` and `diff` say of robots one of whose values was changed, in memory and in files."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import fields, replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines.description.statements import statements
from stepbot.engines.observation import Observation, Request
from stepbot.engines.reference import observe_robot
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import render
from stepbot.robot.closures import loop_ways
from stepbot.robot.kinematics import configurations, initial_configuration
from stepbot.robot.model import Robot
from stepbot.verification.compare import compare
from stepbot.verification.normalized import normalized
from stepbot.verification.text import compare_text
from tests.random_robots import drawn_robot, widened
from tests.robots import ROBOTS

from .files import disturbed

_REFERENCES = ("parent", "child", "link")
"""What no engine reports without the link."""
_MOST = 50
"""Changes of one robot in one pair of formats."""
_DRAWN = 12
_LARGE = ("delta", "stewart")
_PAIRS = ("urdf", "mjcf"), ("mjcf", "sdf"), ("sdf", "urdf"), ("mjcf", "mjcf")


def changed(value: Any) -> Iterator[tuple[str, Any]]:
    """Where something in a value is changed, and the value with that change alone."""
    if isinstance(value, bool):
        yield "", not value
    elif isinstance(value, float):
        yield "", value * 1.01 + 1e-3 if abs(value) < 1e9 else 1.0
    elif isinstance(value, str):
        yield "", f"{value}x"
    elif isinstance(value, np.ndarray):
        other = value.copy()
        if other.size:
            other.flat[other.size // 2] += 1e-3
            yield "", other
    elif isinstance(value, tuple | list):
        for n, one in enumerate(value):
            for at, other in changed(one):
                yield f"[{n}]{at}", type(value)((*value[:n], other, *value[n + 1 :]))
        if value and isinstance(value[-1], Struct) and len(set(map(type, value))) == 1:
            yield "[last]", value[:-1]
    elif isinstance(value, dict):
        for key, one in value.items():
            for at, other in changed(one):
                yield f"[{key}]{at}", {**value, key: other}
    elif isinstance(value, Struct):
        for field in fields(value):
            for at, other in changed(getattr(value, field.name)) if field.name not in _REFERENCES else ():
                yield f".{field.name}{at}", replace(value, **{field.name: other})
            if "None" in str(field.type) and getattr(value, field.name) is not None:
                yield f".{field.name} gone", replace(value, **{field.name: None})


def _seen(robot: Robot, written_in: str = "mjcf") -> Observation:
    """What an engine would report of a robot, or of what a format makes of it."""
    robot = robot if not written_in else lower(robot, FORMATS[written_in], Diagnostics())
    q, at = configurations(robot, n=2), initial_configuration(robot)
    seen = observe_robot(robot, Request("file", written_in, q, at, ways=loop_ways(robot, n=3)))
    return replace(seen, format=written_in, simulation_finite=True)


def _differences(a: Observation, b: Observation) -> list[str]:
    """By quantity what differs, without what deviates by rounding alone."""
    return [
        f"{one.quantity} {one.not_run} {one.deviations.unreported} {[str(wrong) for wrong in one.deviations.failures]}"
        for one in compare(*normalized(a, b))
    ]


def _in_memory(build: Callable[[], Robot], noise: float) -> dict[str, object]:
    """Of a robot, and of what another format makes of it, with one value changed."""
    robot, random = disturbed(build(), noise), Random(1)
    found = dict[str, object]()
    for ours, theirs in _PAIRS:
        a, b = _seen(robot, ours), _seen(robot, theirs)
        cases = list(changed(b))
        some = random.sample(cases, min(_MOST, len(cases)))
        found[f"{ours}-{theirs}"] = _differences(a, b), {at: _differences(a, other) for at, other in some}
    return found


def _in_text(build: Callable[[], Robot], _noise: float) -> dict[str, object]:
    """What differs between the text of a file and a file with one other statement, one less, or one more."""
    robot, random, found = build(), Random(3), dict[str, object]()
    for written_in in ("urdf", "sdf", "mjcf"):
        with TemporaryDirectory() as folder:
            file = Path(folder) / "robot.xml"
            file.write_bytes(next(iter(render(robot, written_in, Diagnostics()).values()), b"<none/>"))
            ours = statements(file, written_in)
        cases = dict[str, object]()
        for _ in range(3 * _MOST if ours else 0):
            n = random.randrange(len(ours))
            one, flags = ours[n], [random.random() < 0.5 for _ in range(3)]
            value = random.choice((f"{one.value}1", "true", "1", "0", "0 0 1.57", f"-{one.value}"))
            other = random.choice(([replace(one, value=value)], [], [one, replace(one, place=f"{one.place}x")]))
            theirs = (*ours[:n], *(replace(part, read=flags[2] or part.read) for part in other), *ours[n + 1 :])
            result = compare_text(ours, theirs, equal=flags[0], whole=flags[1], compiled=random.random() < 0.3)
            cases[f"{one.place} {value} {len(other)} {flags}"] = result and list(map(str, result.deviations.failures))
        found[written_in] = cases
    return found


def _drawn(seed: int) -> Robot:
    random = Random(seed)
    return widened(random, drawn_robot(random))


_ROBOTS = ROBOTS | {f"drawn {seed}": partial(_drawn, seed) for seed in range(_DRAWN)}
RESULTS = {
    f"{name}, {how}": partial(judge, build)
    for name, build in _ROBOTS.items()
    if name not in _LARGE
    for how, judge in (("in memory", _in_memory), ("in text", _in_text))
    if judge is _in_memory or name in ROBOTS  # numbers of drawn ones have other last digits on other processors
}
