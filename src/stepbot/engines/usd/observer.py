"""OpenUSD read back through USD's library, by the specification of UsdPhysics, independent of the writer.

UsdPhysics has single precision, and so have the numbers that are reported here. Poses and dynamics are computed by
stepbot's kinematics from the frames of the joints, so they confirm the file, not the behaviour of an engine.
https://openusd.org/release/api/usd_physics_page_front.html
"""

from math import tau
from typing import Any

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.primitives import srgb_from_linear
from stepbot.geometry.spatial import (
    Pose,
    bounds,
    matrix3,
    rotation_from_quaternion,
    rpy_from_rotation,
    turn_inertia,
    vector3,
)
from stepbot.robot.bounding_boxes import Bounds, primitive_bounds
from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.kinematics import MOVING
from stepbot.robot.model import Box, Capsule, Cylinder, JointKind, Sphere
from stepbot.robot.surfaces import Surface

from ..distribution import provider
from ..observation import Observation, ObservedLink, ObservedShape, Quantity, Request, sorted_pairs
from ..parsed_motion import NOTE, with_motion
from ..resources import with_shapes
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
from .stage import Body, Stage, name_of, rigid


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
    all_connections = connections(stage)
    branches, closing, root, fixed = grown(stage, all_connections)
    leaders = {str(connection.prim.GetPath()): (connection.name, 1.0) for connection in all_connections}
    leaders |= {str(branch.connection.prim.GetPath()): (branch.connection.name, branch.sign) for branch in branches}
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
        excluded_pairs=_excluded_pairs(stage, all_connections, {link.name for link in links if link.has_collisions}),
        not_run={Quantity.SIMULATION: "a parser cannot simulate"},
        notes=(NOTE,),
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
    seen = with_shapes(ObservedLink(body.name, gravity_compensation=0.0), visuals, collisions)
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
    positions = {}
    for branch in branches:
        one = branch.connection
        if one.kind in MOVING:
            # Poses do not tell full turns apart.
            turn = round((request.initial.get(one.name, 0.0) - position(branch)) / tau) * tau if one.turns else 0.0
            positions[one.name] = position(branch) + turn
        elif one.kind == JointKind.BALL and one.name in request.balls:
            X_PJ, X_CJ = branch.frames
            X = X_PJ.inverse() @ branch.parent.X_W.inverse() @ branch.child.X_W @ X_CJ
            positions |= dict(
                zip(request.balls[one.name], map(without_residue, rpy_from_rotation(X.R)[::-1]), strict=True)
            )
    return positions


def _excluded_pairs(stage: Stage, connections: list[Connection], touching: set[str]) -> tuple[tuple[str, str], ...]:
    """Pairs of links whose contacts joints disable, or filters."""
    from pxr import UsdPhysics

    pairs: set[frozenset[str]] = set()
    for connection in connections:
        ends = [body.name for body in connection.bodies if body is not None]
        if len(ends) == 2 and not UsdPhysics.Joint(connection.prim).GetCollisionEnabledAttr().Get():
            pairs.add(frozenset(ends))
    for body in stage.bodies.values():
        if body.prim.HasAPI(UsdPhysics.FilteredPairsAPI):
            targets: list[Any] = UsdPhysics.FilteredPairsAPI(body.prim).GetFilteredPairsRel().GetTargets()
            others = [stage.body_of(stage.stage.GetPrimAtPath(target)) for target in targets]
            pairs |= {frozenset((body.name, other.name)) for other in others if other is not None}
    return sorted_pairs(pair for pair in pairs if len(pair) == 2 and pair <= touching)


_TO_Z = {
    "X": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
    "Y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "Z": np.eye(3),
}
"""Rotations whose z is an axis."""


def shapes(stage: Stage, body: Body) -> tuple[tuple[ObservedShape, ...], tuple[ObservedShape, ...]]:
    """Visuals and collisions of a body; a shape can be both."""
    from pxr import UsdGeom, UsdPhysics

    visuals, collisions = list[ObservedShape](), list[ObservedShape]()
    for prim in stage.content(body):
        if not prim.IsA(UsdGeom.Gprim):
            continue
        name, bounds = name_of(_named(prim)), _bounds(stage, prim, body)
        if prim.HasAPI(UsdPhysics.CollisionAPI) and UsdPhysics.CollisionAPI(prim).GetCollisionEnabledAttr().Get():
            collisions.append(ObservedShape(name, bounds=bounds, surface=_surface(prim)))
        if UsdGeom.Imageable(prim).ComputePurpose() != UsdGeom.Tokens.guide:
            visuals.append(ObservedShape(name, _color(prim), bounds=bounds))
    return tuple(visuals), tuple(collisions)


def _surface(prim: Any) -> Surface:
    """Friction and restitution of the material that physics uses, as far as they are given."""
    from pxr import UsdPhysics, UsdShade

    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")
    if not material or not material.GetPrim().HasAPI(UsdPhysics.MaterialAPI):
        return Surface()
    api = UsdPhysics.MaterialAPI(material.GetPrim())
    friction, restitution = api.GetDynamicFrictionAttr(), api.GetRestitutionAttr()
    given = (float(one.Get()) if one.HasAuthoredValue() else None for one in (friction, restitution))
    sliding, bounce = given
    return Surface(sliding, restitution=bounce)


def _named(prim: Any) -> Any:
    """The prim that a shape has its name from: the instance that it is in, or itself."""
    while prim.IsInstanceProxy():
        prim = prim.GetParent()
    return prim


def _bounds(stage: Stage, prim: Any, body: Body) -> Bounds | None:
    """Lowest and highest corner [m] in the frame of the body; None if this reader does not know the shape."""
    from pxr import UsdGeom

    M = stage.in_body(prim, body)
    if prim.IsA(UsdGeom.Mesh):
        points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get() or (), dtype=np.float64).reshape(-1, 3)
        return bounds(points @ M[:3, :3].T + M[:3, 3]) if len(points) else None
    X, scale = rigid(M)
    if prim.IsA(UsdGeom.Cube):
        x, y, z = (scale * float(UsdGeom.Cube(prim).GetSizeAttr().Get())).tolist()
        return primitive_bounds(Box((x, y, z)), X)
    if float(np.ptp(scale)) > 1e-12 * float(scale.max()):
        return None
    size = float(scale[0])
    if prim.IsA(UsdGeom.Sphere):
        return primitive_bounds(Sphere(size * float(UsdGeom.Sphere(prim).GetRadiusAttr().Get())), X)
    for type_, kind in ((UsdGeom.Cylinder, Cylinder), (UsdGeom.Capsule, Capsule)):
        if prim.IsA(type_):
            shape = type_(prim)
            turned = _TO_Z[str(shape.GetAxisAttr().Get())]
            radius, height = (size * float(a.Get()) for a in (shape.GetRadiusAttr(), shape.GetHeightAttr()))
            return primitive_bounds(kind(radius, height), type(X).of(X.R @ turned, X.p))
    return None


def _color(prim: Any) -> tuple[float, ...]:
    """Colour and opacity of the bound material, or else the display colour; sRGB; empty if there is none."""
    from pxr import UsdGeom, UsdShade

    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    surface = material.ComputeSurfaceSource()[0] if material else None
    if surface and surface.GetIdAttr().Get() == "UsdPreviewSurface":
        color, opacity = (surface.GetInput(name) for name in ("diffuseColor", "opacity"))
        seen = color.Get() if color else None
        if seen is not None:
            alpha = opacity.Get() if opacity else None
            return (*map(srgb_from_linear, seen), 1.0 if alpha is None else float(alpha))
    shown = UsdGeom.Gprim(prim).GetDisplayColorAttr().Get()
    return (*map(srgb_from_linear, shown[0]), 1.0) if shown else ()
