"""OpenUSD read back through USD's library, by the specification of UsdPhysics, independent of the writer.

UsdPhysics has single precision, and so have the numbers that are reported here. Poses and dynamics are computed by
stepbot's kinematics from the frames of the joints, so they confirm the file, not the behaviour of an engine.
https://openusd.org/release/api/usd_physics_page_front.html
"""

from dataclasses import replace
from math import tau
from typing import Any

import numpy as np

from stepbot.geometry.spatial import Pose, matrix3, rotation_from_quaternion, rpy_from_rotation, turn_inertia, vector3
from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.kinematics import MOVING
from stepbot.robot.model import JointKind

from ..distribution import provider
from ..observation import Observation, ObservedLink, Quantity, Request
from ..parsed_motion import with_motion
from ..shape_bounds import box_around
from . import ENGINE
from .joints import (
    Branch,
    Connection,
    actuators,
    connections,
    grown,
    observed_closure,
    observed_joint,
    position,
    without_residue,
    wxyz,
)
from .shapes import shapes
from .stage import Body, Stage, name_of, rigid

_NOTE = "read by stepbot's own parser, with stepbot's own kinematics"


def prepare() -> None:
    """Import USD's library."""
    from pxr import Usd, UsdPhysics, UsdShade  # noqa: F401


def observe(request: Request) -> Observation:
    """Open the stage and report its robot.

    Raises:
        EngineRefused: USD cannot open it, or its joints contradict UsdPhysics.
        EngineCannotRead: It has no robot, or more than a tree with loops.
    """
    from pxr import UsdUtils

    collector = UsdUtils.CoalescingDiagnosticDelegate()
    stage = Stage(request.file)
    found = connections(stage)
    branches, closing, root, fixed = grown(stage, found)
    leaders = {str(one.prim.GetPath()): (one.name, 1.0) for one in found}
    leaders |= {str(one.connection.prim.GetPath()): (one.connection.name, one.sign) for one in branches}
    joints = tuple(observed_joint(stage, branch, leaders) for branch in branches)
    links = tuple(_link(stage, body) for body in stage.bodies.values())
    observation = Observation(
        engine=ENGINE.name,
        **provider("pxr"),
        format=request.format,
        name=stage.name,
        base="fixed" if fixed else "floating",
        links=links,
        joints=joints,
        gravity=_gravity(stage),
        closures=tuple(observed_closure(one, request.closures) for one in closing),
        frames={name: (body.name, X) for body in stage.bodies.values() for name, X in _frames(stage, body)},
        actuators=tuple(actuators(stage, branches, joints)),
        sensors=(),
        initial=_initial(branches, request),
        excluded_pairs=_excluded_pairs(stage, found, {link.name for link in links if link.has_collisions}),
        not_run={Quantity.SIMULATION: "a parser cannot simulate"},
        notes=(_NOTE,),
    )
    down = vector3(root.X_W.inverse().turn(stage.up * GRAVITY[2]))
    frames = {branch.child.name: branch.frames for branch in branches}
    moved = with_motion(observation, frames, lambda _root: down, request)
    return replace(
        moved, warnings=tuple(dict.fromkeys(one.commentary for one in collector.TakeUncoalescedDiagnostics()))
    )


def _link(stage: Stage, body: Body) -> ObservedLink:
    from pxr import UsdPhysics

    visuals, collisions = shapes(stage, body)
    seen = ObservedLink(
        body.name,
        visual_bounds=box_around(visuals),
        collision_bounds=box_around(collisions),
        has_visuals=bool(visuals),
        has_collisions=bool(collisions),
        visuals=visuals,
        collisions=collisions,
        gravity_compensation=0.0,
    )
    api = UsdPhysics.MassAPI(body.prim)
    mass, com = api.GetMassAttr().Get(), api.GetCenterOfMassAttr().Get()
    moments, axes = api.GetDiagonalInertiaAttr().Get(), api.GetPrincipalAxesAttr().Get()
    # Without a value, or with the default, a simulator computes it from collision shapes.
    if mass:
        seen = replace(seen, mass=float(mass) * stage.kilograms)
    if com is not None and np.isfinite(com).all():
        seen = replace(seen, com=vector3(np.array(com) * body.scale * stage.metres))
    if moments is not None and any(moments):
        R = np.eye(3) if axes is None or not any(wxyz(axes)) else rotation_from_quaternion(wxyz(axes))
        inertia = np.diag(np.array(moments, dtype=np.float64)) * stage.kilograms * stage.metres**2
        seen = replace(seen, inertia=matrix3(turn_inertia(R, inertia)))
    return seen


def _gravity(stage: Stage) -> tuple[float, ...]:
    """Acceleration of gravity [m/s^2]; empty without a scene, or where it leaves it to the simulator."""
    from pxr import UsdPhysics

    for prim in stage.prims():
        if prim.IsA(UsdPhysics.Scene):
            scene = UsdPhysics.Scene(prim)
            direction, magnitude = (
                np.array(scene.GetGravityDirectionAttr().Get()),
                scene.GetGravityMagnitudeAttr().Get(),
            )
            if magnitude is not None and np.isfinite(magnitude):
                way = direction if direction.any() else -stage.up
                return tuple((way / np.linalg.norm(way) * float(magnitude) * stage.metres).tolist())
    return ()


def _frames(stage: Stage, body: Body) -> list[tuple[str, Pose]]:
    """Transforms without content."""
    return [
        (name_of(prim), rigid(stage.in_body(prim, body))[0])
        for prim in stage.content(body)
        if prim.GetTypeName() == "Xform" and not prim.GetChildren() and not prim.IsInstance()
    ]


def _initial(branches: list[Branch], request: Request) -> dict[str, float]:
    """Positions at which the links are in the stage; of ball joints in their coordinates, yaw, pitch and roll."""
    found = {}
    for branch in branches:
        one = branch.connection
        if one.kind in MOVING:
            # Poses do not tell full turns apart.
            turn = round((request.initial.get(one.name, 0.0) - position(branch)) / tau) * tau if one.turns else 0.0
            found[one.name] = position(branch) + turn
        elif one.kind == JointKind.BALL and one.name in request.balls:
            X_PJ, X_CJ = branch.frames
            X = X_PJ.inverse() @ branch.parent.X_W.inverse() @ branch.child.X_W @ X_CJ
            found |= dict(zip(request.balls[one.name], map(without_residue, rpy_from_rotation(X.R)[::-1]), strict=True))
    return found


def _excluded_pairs(stage: Stage, found: list[Connection], touching: set[str]) -> tuple[tuple[str, str], ...]:
    """Pairs of links whose contacts joints disable, or filters."""
    from pxr import UsdPhysics

    pairs: set[frozenset[str]] = set()
    for one in found:
        ends = [body.name for body in one.bodies if body is not None]
        if len(ends) == 2 and not UsdPhysics.Joint(one.prim).GetCollisionEnabledAttr().Get():
            pairs.add(frozenset(ends))
    for body in stage.bodies.values():
        if body.prim.HasAPI(UsdPhysics.FilteredPairsAPI):
            targets: list[Any] = UsdPhysics.FilteredPairsAPI(body.prim).GetFilteredPairsRel().GetTargets()
            others = [stage.body_of(stage.stage.GetPrimAtPath(target)) for target in targets]
            pairs |= {frozenset((body.name, other.name)) for other in others if other is not None}
    return tuple(sorted((min(pair), max(pair)) for pair in pairs if len(pair) == 2 and pair <= touching))
