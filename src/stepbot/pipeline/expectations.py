"""Compares a robot with what its sidecar expects, and its limits with stops, where parts of two links meet."""

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from math import floor, inf, log10

import numpy as np

from stepbot.assemble import BuiltRobot
from stepbot.compose.parts import named
from stepbot.diagnostics import Diagnostics, cut, did_you_mean
from stepbot.draft.stops.stops import Question, Shapes, Stop, find_stops
from stepbot.draft.text.values import position
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.model import Joint, JointKind, Robot
from stepbot.robot.reach import reach
from stepbot.robot.symmetry import AXES, Part, Symmetry, mirrored, whole
from stepbot.sidecar.expected import ExpectedCom, ExpectedMass, ExpectedReach, ExpectSection
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.quantities import ToleranceValue
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import quoted

UNMET, ASYMMETRIC = "SB525", "SB526"
_DIFFERENT = 0.2
"""Share by which masses of twins may differ: beyond, one has another material or another rule."""
_OFF = 0.005
"""Share of the robot's size by which the centre of mass may be off the plane of symmetry."""
_MOST = 8
_MATCHES = Callable[[str], Sequence[str]]
"""The paths of the components that match a path or glob, each with everything below it."""


def check_expected(sidecar: Sidecar, robot: Robot, matches: _MATCHES, diagnostics: Diagnostics) -> None:
    """Report what a robot is not as expected (SB525), and asymmetry (SB526)."""
    if sidecar.document.expect is not None:
        _Comparison(sidecar, robot, matches, diagnostics).run(sidecar.document.expect)


class _Comparison:
    """One robot against the section ``expect`` of its sidecar."""

    def __init__(self, sidecar: Sidecar, robot: Robot, matches: _MATCHES, diagnostics: Diagnostics) -> None:
        self._sidecar, self._robot, self._matches, self._diagnostics = sidecar, robot, matches, diagnostics

    def run(self, section: ExpectSection) -> None:
        total, com = whole(self._robot)
        self._mass(("expect", "mass"), "the robot", section.mass, total)
        self._com(("expect", "com"), "the robot", section.com, com)
        for name, link in section.links.items():
            one = self._robot.link_by_name.get(named(self._robot, name))
            keys = ("expect", "links", name)
            if one is None:
                self._unknown(keys, f"no link '{name}'", name, self._robot.link_by_name)
                continue
            self._mass((*keys, "mass"), f"link '{name}'", link.mass, one.mass_properties.mass)
            self._com((*keys, "com"), f"link '{name}'", link.com, np.array(one.mass_properties.com))
        for path, part in section.parts.items():
            self._part(path, part.mass)
        if section.reach is not None:
            self._reach(section.reach)
        if section.symmetry is not None:
            self._symmetry(section.symmetry, mirrored(self._robot, section.symmetry))

    def _part(self, path: str, wanted: ExpectedMass) -> None:
        keys = ("expect", "parts", path)
        weights = {one.component: one.mass or 0.0 for link in self._robot.links for one in link.masses}
        names = self._matches(path)
        if not names:
            self._unknown(keys, f"no component '{path}'", path, weights)
        for name in names:
            below = [mass for part, mass in weights.items() if part == name or part.startswith(f"{name}/")]
            self._mass((*keys, "mass"), f"'{name}'", wanted, exact_sum(below))

    def _mass(self, keys: tuple[str, ...], what: str, wanted: ExpectedMass | None, mass: float) -> None:
        if wanted is not None:
            self._compare(keys, f"mass of {what}", mass, wanted.value, wanted.within, "kg")

    def _com(self, keys: tuple[str, ...], what: str, wanted: ExpectedCom | None, com: np.ndarray) -> None:
        if wanted is None:
            return
        apart = float(np.linalg.norm(com - np.array(wanted.value)))
        allowed = wanted.within.absolute or wanted.within.relative * float(np.linalg.norm(wanted.value))
        if apart > allowed:
            has, needs = (", ".join(f"{1e3 * x + 0.0:.4g}" for x in point) for point in (com, wanted.value))
            text = f"com of {what} is ({has}) mm, ({needs}) mm expected: {1e3 * apart:.3g} mm apart"
            self._report(keys, f"{text}, {1e3 * allowed:.3g} mm allowed")

    def _reach(self, wanted: ExpectedReach) -> None:
        keys, start = ("expect", "reach"), wanted.start or self._robot.root.name
        known = {*self._robot.link_by_name, *(frame.name for frame in self._robot.frames)}
        ends = {"to": wanted.to, "start": start}
        for key, name in ends.items():
            if named(self._robot, name) not in known:
                self._unknown((*keys, key), f"no link or frame '{name}'", name, known)
                return
        far = reach(self._robot, *(named(self._robot, name) for name in ends.values()))
        self._compare(keys, f"reach of '{wanted.to}' from '{start}'", far, wanted.value, wanted.within, "m")

    def _compare(
        self, keys: tuple[str, ...], what: str, has: float, wanted: float, within: ToleranceValue, unit: str
    ) -> None:
        allowed = within.absolute or within.relative * wanted
        if abs(has - wanted) > allowed:
            share = (has - wanted) / wanted
            digits = max(4, 2 - floor(log10(allowed / wanted))) if allowed else 9
            text = f"{what} is {has:.{digits}g} {unit}, {wanted:.{digits}g} {unit} expected: {100.0 * share:+.3g}%"
            self._report(keys, f"{text}, {100.0 * allowed / wanted:.2g}% allowed")

    def _symmetry(self, axis: str, symmetry: Symmetry) -> None:
        keys, k = ("expect", "symmetry"), AXES.index(axis)
        uneven = sorted(
            (twin for twin in symmetry.twins if twin.difference > _DIFFERENT), key=lambda twin: -twin.difference
        )
        for twins in uneven:
            a, b = twins.a, twins.b
            weights = f"{_named(a)} weighs {a.mass:.4g} kg, its twin {_named(b)} {b.mass:.4g} kg"
            self._report(keys, f"{weights}: {twins.difference:.0%} off", ASYMMETRIC)
        if symmetry.alone:
            notes = [
                f"{_named(one)}: {one.mass:.3g} kg at {axis} = {1e3 * float(one.center[k]):+.4g} mm"
                for one in symmetry.alone
            ]
            count = len(symmetry.alone)
            text = f"{count} part{'s' if count > 1 else ''} without a twin beyond the plane {axis} = 0"
            self._report(keys, text, ASYMMETRIC, cut(notes, _MOST))
        if symmetry.size and abs(symmetry.offset) > _OFF * symmetry.size:
            share = abs(symmetry.offset) / symmetry.size
            text = f"com is {1e3 * symmetry.offset:+.3g} mm off the plane {axis} = 0, {share:.1%} of the size"
            self._report(keys, text, ASYMMETRIC)

    def _unknown(self, keys: tuple[str, ...], text: str, name: str, known: Iterable[str]) -> None:
        help = did_you_mean(name, known)
        self._diagnostics.add(UNMET, f"expect: {text}", self._sidecar.key_span(*keys), help=help)

    def _report(self, keys: tuple[str, ...], text: str, code: str = UNMET, notes: Sequence[str] = ()) -> None:
        self._diagnostics.add(code, f"expect: {text}", self._sidecar.key_span(*keys), notes=list(notes))


def _named(part: Part) -> str:
    return f"'{part.name}'"


_SLACK = {JointKind.REVOLUTE: 0.02, JointKind.PRISMATIC: 2e-4}
"""Ways [rad], [m] by which limits may pass a stop: meshes are as far off."""


def report_passed_stops(sidecar: Sidecar, built: BuiltRobot, assembly: Assembly, diagnostics: Diagnostics) -> None:
    """Report SB465 for each joint whose limits pass a position at which parts of its two links meet."""
    index = {component.path: component.index for component in assembly.components}
    parts = {link.name: [index[path] for path in link.components if path in index] for link in built.robot.links}
    rows = {row.name: row for row in built.joint_table}
    shapes, joints, questions = Shapes(assembly), [], []

    def name(part: int) -> str:
        return quoted(assembly.components[part].path)

    for joint in built.robot.joints:
        row = rows.get(joint.name)
        is_limited = joint.limit.lower > -inf or joint.limit.upper < inf
        if joint.kind in _SLACK and is_limited and row is not None and row.origin and row.axis:
            still, moving = (shapes.of(parts[link]) for link in (joint.parent, joint.child))
            slides = joint.kind is JointKind.PRISMATIC
            joints.append(joint)
            questions.append(Question(slides, np.array(row.origin), np.array(row.axis), still, moving))
    for joint, stops in zip(joints, find_stops(questions), strict=True):
        passed = [stop for stop in stops.stops if _beyond(joint, stop) > _SLACK[joint.kind]]
        if not passed:
            continue
        words = partial(position, slides=joint.kind is JointKind.PRISMATIC)
        keys = ["upper" if stop.position > 0.0 else "lower" for stop in passed]
        places = [words(joint.drawn_position + stop.position) for stop in passed]
        limits = [f"{key} {words(getattr(joint.limit, key))}" for key in keys]
        several = "s" * (len(passed) > 1)
        diagnostics.add(
            "SB465",
            f"joint '{joint.name}': limit{several} {' and '.join(limits)} pass{'' if several else 'es'} "
            f"{'stops' if several else 'a stop'} at {' and '.join(places)}",
            sidecar.span("joints", joint.name, "limits"),
            help=[f"limits: {{{', '.join(f'{key}: {place}' for key, place in zip(keys, places, strict=True))}}}"],
            notes=[
                f"{name(stop.still)} and {name(stop.moving)} meet at {at}"
                for stop, at in zip(passed, places, strict=True)
            ],
        )


def _beyond(joint: Joint, stop: Stop) -> float:
    """How far a limit lies beyond a stop [rad] or [m]."""
    at = joint.drawn_position + stop.position
    return joint.limit.upper - at if stop.position > 0.0 else at - joint.limit.lower
