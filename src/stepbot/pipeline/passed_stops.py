"""Reports limits that pass a stop: positions between which parts of a joint's two links meet."""

from functools import partial
from math import inf

import numpy as np

from stepbot.assemble import Built
from stepbot.diagnostics import Diagnostics
from stepbot.draft.stops.stops import Question, Shapes, Stop, find_stops
from stepbot.draft.text.values import position
from stepbot.robot.model import Joint, JointKind
from stepbot.sidecar.located import Sidecar
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import quoted

_SLACK = {JointKind.REVOLUTE: 0.02, JointKind.PRISMATIC: 2e-4}
"""Ways [rad], [m] by which limits may pass a stop: meshes are as far off."""


def report_passed_stops(sidecar: Sidecar, built: Built, assembly: Assembly, found: Diagnostics) -> None:
    """Report SB465 for each joint whose limits pass a position at which parts of its two links meet."""
    index = {component.path: component.index for component in assembly.components}
    parts = {link.name: [index[path] for path in link.components if path in index] for link in built.robot.links}
    rows = {row.name: row for row in built.joint_table}
    shapes, joints, questions = Shapes(assembly), [], []

    def name(part: int) -> str:
        return quoted(assembly.components[part].path)

    for joint in built.robot.joints:
        row = rows.get(joint.name)
        if joint.kind in _SLACK and _is_limited(joint) and row is not None and row.origin and row.axis:
            still, moving = (shapes.of(parts[link]) for link in (joint.parent, joint.child))
            slides = joint.kind is JointKind.PRISMATIC
            joints.append(joint)
            questions.append(Question(slides, np.array(row.origin), np.array(row.axis), still, moving))
    for joint, stops in zip(joints, find_stops(questions), strict=True):
        passed = [stop for stop in stops.found if _beyond(joint, stop) > _SLACK[joint.kind]]
        if not passed:
            continue
        words = partial(position, slides=joint.kind is JointKind.PRISMATIC)
        keys = ["upper" if stop.position > 0.0 else "lower" for stop in passed]
        places = [words(joint.drawn_position + stop.position) for stop in passed]
        limits = [f"{key} {words(getattr(joint.limit, key))}" for key in keys]
        several = "s" * (len(passed) > 1)
        found.add(
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


def _is_limited(joint: Joint) -> bool:
    return joint.limit.lower > -inf or joint.limit.upper < inf
