"""Robots converted from a sidecar, drafted again from the written description, and compared."""

import shutil
from pathlib import Path

import numpy as np
from msgspec import Struct

from stepbot.draft.draft import Draft
from stepbot.draft.text.sidecar_text import sidecar_text
from stepbot.pipeline.drafting import draft_step
from stepbot.pipeline.stages import Options, convert, produce
from stepbot.robot.model import JointKind, Robot
from tests.command_line import cache_of_this_run

MADE_OF_SEVERAL = ("universal", "ball", "cylindrical", "planar", "screw", "floating")
"""Joints that URDF writes as several links and joints."""


class Redrafted(Struct, frozen=True):
    """The original robot and the drafted one."""

    drawn: Robot
    """From the hand-made sidecar."""
    draft: Draft
    again: Robot
    """From the drafted sidecar, unedited."""


def redrafted(sidecar: Path, step: Path, folder: Path, suffix: str, *, meshes: bool = True) -> Redrafted:
    """Convert a sidecar, draft one from the written description, and build the robots of both.

    Args:
        sidecar: A hand-made sidecar.
        step: Its STEP.
        folder: An empty folder to work in.
        suffix: Suffix of the description: ``urdf``, ``sdf`` or ``xml``.
        meshes: Whether the description may keep its meshes.
    """
    options = Options(folder / "out", step=step, verify=False, cache=cache_of_this_run())
    converted = convert(sidecar, options)
    assert converted.robot is not None, list(converted.diagnostics)
    if not meshes:
        shutil.rmtree(folder / "out" / "meshes")
    description = folder / "out" / f"{converted.robot.name}.{suffix}"
    drafting = draft_step(step, options, description)
    assert drafting.draft is not None, list(drafting.diagnostics)
    text = sidecar_text(drafting.draft, step.as_posix(), schema="")
    (folder / "again.robot.yaml").write_text(text, encoding="utf-8")
    again = produce(folder / "again.robot.yaml", Options(folder / "again", verify=False, cache=options.cache))
    assert again.robot is not None, list(again.diagnostics)
    return Redrafted(converted.robot, drafting.draft, again.robot)


def differences(result: Redrafted, *, zero: float = 1e-6) -> list[str]:
    """Differences between the drafted and the original robot; empty if there are none.

    Args:
        result: Both robots.
        zero: Tolerance [rad] or [m] of the drawn positions of joints.
    """
    drawn, again = result.drawn, result.again
    found = []
    if list(drawn.link_by_name) != list(again.link_by_name):
        found.append(f"links {sorted(drawn.link_by_name)} and {sorted(again.link_by_name)}")
        return found
    for name, link in drawn.link_by_name.items():
        other = again.link_by_name[name]
        if set(link.components) != set(other.components):
            found.append(f"components of {name}: {sorted(set(link.components) ^ set(other.components))}")
        ours, theirs = link.mass_properties, other.mass_properties
        if not np.isclose(ours.mass, theirs.mass, rtol=1e-9):
            found.append(f"mass of {name}: {ours.mass} and {theirs.mass}")
        if not np.allclose(ours.com, theirs.com, rtol=0.0, atol=1e-6):
            found.append(f"com of {name}: {ours.com} and {theirs.com}")
        if not np.allclose(ours.inertia, theirs.inertia, rtol=1e-4, atol=1e-6 * float(np.abs(ours.inertia).max())):
            found.append(f"inertia of {name}: {ours.inertia} and {theirs.inertia}")
    for name, joint in drawn.joint_by_name.items():
        same = next((one for one in again.joints if one.child == joint.child), None)
        if same is None or (same.name != name and joint.kind is not JointKind.FIXED):
            found.append(f"no joint {name}")
            continue
        if (joint.kind, joint.parent) != (same.kind, same.parent):
            found.append(f"{name}: {joint.kind} on {joint.parent} and {same.kind} on {same.parent}")
            continue
        distance, angle = joint.X_PC.distance_to(same.X_PC)
        if distance > 1e-7 or angle > 1e-7:
            found.append(f"frame of {name}: {distance} m and {angle} rad apart")
        if joint.kind is JointKind.FIXED:
            continue
        ours = [*joint.axis, joint.limit.lower, joint.limit.upper, joint.limit.velocity, joint.limit.effort]
        theirs = [*same.axis, same.limit.lower, same.limit.upper, same.limit.velocity, same.limit.effort]
        if not np.allclose(ours, theirs, rtol=1e-8, atol=1e-8):
            found.append(f"axis and limits of {name}: {ours} and {theirs}")
        if abs(joint.dynamics.damping - same.dynamics.damping) > 1e-9:
            found.append(f"damping of {name}: {joint.dynamics.damping} and {same.dynamics.damping}")
        off = abs(joint.drawn_position - same.drawn_position)
        turn = 2.0 * np.pi if joint.kind is not JointKind.PRISMATIC else np.inf
        if min(off, abs(turn - off)) > zero:
            found.append(f"drawn position of {name}: {joint.drawn_position} and {same.drawn_position}")
    return found
